// The formulation of haptic rendering: equations (3) to (15) of the paper as printed, or with our
// repairs. Each repair can be added to the paper's formulation or removed from ours, in virtual
// time, to measure its effect (`predictor reproduce ablation`, docs/paper.md).
#pragma once

#include <bitset>
#include <span>
#include <string>
#include <vector>

namespace predictor {

struct RenderingSpec;
struct Scenario;

enum class Repair : unsigned char {
  kPredictedJacobian,
  kRelativeTarget,
  kLead,
  kSoftRows,
  kCoupling,
  kRotationWeight,
  kNearerHemisphere,
  kDamperEnd,
  kApproachParabola,
  kSpeedReserve,
  kAccelerationLimit,
  kSingularityDamping,
  kHandleSpeedCap,
  kCount,
};
inline constexpr std::size_t kRepairs = static_cast<std::size_t>(Repair::kCount);

struct RepairEntry {
  Repair repair;
  const char* name;       // name in scenarios: "relative_target"
  const char* equations;  // equations that the repair changes
  const char* ours;       // what rendering does with the repair
  const char* papers;     // what rendering does without the repair
};

std::span<const RepairEntry> RepairTable();  // entries in the order of Repair
std::vector<std::string> RepairNames();

class RepairSet {
 public:
  bool Has(Repair repair) const noexcept { return set_[static_cast<std::size_t>(repair)]; }
  bool HasAll() const noexcept { return set_.all(); }

 private:
  friend RepairSet RepairsOf(const RenderingSpec& rendering);
  std::bitset<kRepairs> set_;
};

// Returns the repairs that `rendering.formulation` and `rendering.formulation_except` select.
RepairSet RepairsOf(const RenderingSpec& rendering);

// Sets the lead and the coupling to zero if their repairs are not selected.
void ApplyFormulation(Scenario* scenario);

}  // namespace predictor
