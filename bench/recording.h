// A run in virtual time, and the input of each module in each of its ticks.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/record.h"
#include "emulator/arm_side.h"
#include "emulator/emulator.h"
#include "haptics/renderer.h"
#include "scenario/scenario.h"

namespace predictor::bench {

Scenario LoadNamed(const std::string& name);  // scenarios/NAME.yaml

struct Recording {
  Scenario scenario;
  std::array<JointVector, kHands> start;  // initial joints of the arms, without the offset
  double lead = 0;                        // [s]
  double dt = 0;                          // [s]
  std::vector<TickRecord> ticks;          // in state RUN, without gaps
};
Recording Record(const std::string& name);

// Returns the inputs of the modules in tick k, from the records of ticks k − 1, k and k + 1.
WorldInput WorldInputAt(const Recording& recording, std::size_t k);
ArmSample ArmSampleAt(const Recording& recording, std::size_t k, int hand);
DeviceCommand CommandAt(const Recording& recording, std::size_t k);

// Reconstructs all inputs of rendering from joints and targets.
class RenderInput {
 public:
  explicit RenderInput(const Recording& recording);

  // Loads the inputs of tick k, with 1 ≤ k < ticks.size() − 1.
  void Load(const Recording& recording, std::size_t k) noexcept;
  // Sets the inputs of rendering for the given joint positions. `last` [rad/s] is the previous
  // command.
  void Place(const std::array<JointVector, kHands>& q,
             const std::array<JointVector, kHands>& last) noexcept;

  std::array<RenderArm, kHands> arms() const;
  std::array<std::shared_ptr<const RobotModel>, kHands> models() const;
  Pose Handle(int hand) const { return sides_[static_cast<std::size_t>(hand)].handle().X_W; }

  RenderTarget target;
  std::array<JointVector, kHands> last;

 private:
  std::vector<ArmSide> sides_;  // both arms are present
};

}  // namespace predictor::bench
