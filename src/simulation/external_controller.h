// The part that all controllers outside the program have in common. These controllers are plug-ins
// and separate processes.
#pragma once

#include <predictor/controller.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "simulation/controller.h"

namespace predictor {

// Provides the values of the interface at an input of the program.
class InterfaceInput {
 public:
  // `dt` is the period of the controller [s].
  InterfaceInput(double dt, int dof);
  // Writes all values. The result is valid until the next call. Does not use the heap or throw.
  const PredictorControllerInput& Fill(const ControllerInput& input) noexcept;
  // Restricts h, J and M to those that the controller reads: a sum of PREDICTOR_READS_*. The others
  // are 0.
  void Restrict(std::uint32_t reads) noexcept { reads_ = reads; }

 private:
  PredictorControllerInput to_{};
  std::uint32_t reads_ = PREDICTOR_READS_ALL;
  bool is_filled_ = false;
  Jacobian J_;
};

// A word of cobot.controller.parameters.
struct InterfaceParameter {
  std::string key, value;
};
// Throws InputError if a word is not "key=value".
std::vector<InterfaceParameter> InterfaceParameters(const std::string& text);

// Returns whether a saved state can contain this number. Larger numbers are refused, because no
// controller needs them.
inline bool IsUsable(double x) noexcept { return std::abs(x) < 1e12; }

void FillPose(const Pose& X, double* to) noexcept;

// A controller whose torques must be checked, because they may be late, absent or not finite.
class ExternalController : public Controller {
 public:
  explicit ExternalController(const ControllerContext& context);

  void Compute(const ControllerInput& input, JointVector* torque) noexcept final;
  ControllerOutcome outcome() const noexcept final { return outcome_; }
  Status failure() const noexcept final { return failure_; }

 protected:
  // Requests the torques. The answer states whether torques arrived and, if not, for how long none
  // have arrived [s]. `allocations` is the number of calls since the last answer with which the
  // controller allocated or freed heap memory in the control loop.
  struct Answer {
    bool came = true;
    double silence = 0;
    std::int64_t allocations = 0;
  };
  virtual Answer Ask(const PredictorControllerInput& input, double* torque) noexcept = 0;
  const PredictorControllerInput& Fill(const ControllerInput& input) const noexcept {
    return input_.Fill(input);
  }
  void RestrictInput(std::uint32_t reads) noexcept { input_.Restrict(reads); }
  // Returns the silence after which the run stops [s].
  virtual double longest_silence() const noexcept { return 0; }

 private:
  void Fail(double value, double limit, Quantity quantity) noexcept;

  mutable InterfaceInput input_;  // workspace
  ControllerOutcome outcome_ = ControllerOutcome::kComputed;
  Status failure_{StopCause::kPhysics};
};

}  // namespace predictor
