// Computes the commanded speeds of the handles from a record and the models of the arms.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "core/record.h"
#include "emulator/placement.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

struct Speeds {
  double translation = 0, rotation = 0;  // speeds of the faster handle [m/s], [rad/s]
  void See(const Twist& V) {
    translation = std::max(translation, V.head<3>().norm());
    rotation = std::max(rotation, V.tail<3>().norm());
  }
  void See(const Speeds& other) {
    translation = std::max(translation, other.translation);
    rotation = std::max(rotation, other.rotation);
  }
};

class HandleSpeeds {
 public:
  explicit HandleSpeeds(const Scenario& s) {
    for (int i = 0; i < kHands; ++i) {
      models_.push_back(LoadArm(s, i));
      data_.emplace_back(*models_.back());
      frames_[static_cast<std::size_t>(i)] =
          models_.back()->Frame(s.arm(i).end_effector, s.arm(i).handle.ToPose());
    }
  }

  // Returns the commanded speeds at the measured joint angles.
  Speeds Commanded(const TickRecord& record) {
    Speeds speeds;
    for (std::size_t i = 0; i < kHands; ++i) {
      const HandRecord& h = record.hands[i];
      const JointVector q = Eigen::Map<const JointVector>(h.q.data(), h.arm_dof),
                        v = Eigen::Map<const JointVector>(h.command.data(), h.arm_dof);
      data_[i].UpdateKinematics(*models_[i], q, v);
      speeds.See(data_[i].FrameTwist(*models_[i], frames_[i]));
    }
    return speeds;
  }

 private:
  std::vector<std::shared_ptr<const RobotModel>> models_;
  std::vector<RobotData> data_;
  std::array<FrameId, kHands> frames_;
};

}  // namespace predictor
