// Records how the cobot's grip on the object changes.
#include <array>
#include <utility>

#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

constexpr std::array<const char*, 4> kStates = {"holding", "slipping", "open", "too far to grasp"};
static_assert(static_cast<std::size_t>(AttachmentState::kMissed) + 1 == kStates.size());

class Grip final : public Metric {
 public:
  explicit Grip(const Scenario& scenario) : dt_(1 / scenario.rate) {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran || record.attachment >= kStates.size()) return;
    state_ = record.attachment;
    ++ticks_[state_];
  }

  void AppendTo(std::vector<Result>* results) const override {
    const std::uint64_t slipping = ticks_[1], open = ticks_[2] + ticks_[3];
    const bool changed = slipping + open > 0;
    const auto add = [&](const char* key, const char* label, Unit unit, const char* meaning,
                         ResultValue value, bool shown = true) {
      results->push_back({.path = std::string("gripper.") + key,
                          .group = "Gripper",
                          .label = label,
                          .unit = unit,
                          .meaning = meaning,
                          .value = std::move(value),
                          .shown = changed && shown,
                          .compared = false});
    };
    add("at_end", "at the end", units::kNone,
        "state of the cobot's grip on the object at the end: holding, slipping, open, or too far "
        "to grasp (open, because the object was too far away to be grasped)",
        std::string(kStates[state_]));
    add("slipped", "slipped", units::kNone, "the grip slipped at some time", slipping > 0, false);
    add("slipping_s", "slipping", units::kSecond, "time during which the grip slipped",
        dt_ * static_cast<double>(slipping));
    add("open_s", "open", units::kSecond, "time during which the grip was open",
        dt_ * static_cast<double>(open));
  }

 private:
  double dt_;  // [s]
  std::size_t state_ = 0;
  std::array<std::uint64_t, kStates.size()> ticks_ = {};
};

}  // namespace

const MetricKind kGrip = {.make = MakeMetric<Grip>};

}  // namespace predictor::metrics
