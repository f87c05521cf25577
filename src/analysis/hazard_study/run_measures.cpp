#include "analysis/hazard_study/run_measures.h"

#include <algorithm>
#include <cmath>

#include "core/norm.h"
#include "emulator/placement.h"
#include "haptics/stability.h"

namespace predictor {

double ResolvedForce(const SensorSpec& sensor) {
  return 3 * std::sqrt(sensor.noise_force * sensor.noise_force +
                       sensor.force_resolution * sensor.force_resolution / 12);
}

void ClearCrossing::Add(const TickRecord& record) {
  run_time_ = record.run_time;
  for (std::size_t h = 0; h < kHands; ++h) {
    if (Norm(record.hands[h].true_wrench.data()) <= threshold_ + resolved_[h])
      crossed_[h] = -1;
    else if (crossed_[h] < 0)
      crossed_[h] = run_time_;
  }
}

double ClearCrossing::duration(int hand) const {
  const double crossed = crossed_[static_cast<std::size_t>(hand)];
  return crossed < 0 ? -1 : run_time_ - crossed;
}

CommandedSpeeds::CommandedSpeeds(const Scenario& s)
    : speed_cap_(s.safety.handle_speed), rotation_cap_(s.safety.handle_rotation_speed) {
  for (const int i : s.hands()) {
    if (s.mode == Mode::kDirect) return;
    const ArmSpec& spec = s.arm(i);
    const auto model = LoadArm(s, i);
    arms_[static_cast<std::size_t>(i)] =
        Arm{model, std::make_shared<RobotData>(*model),
            model->Frame(spec.end_effector, spec.handle.ToPose()),
            HapticLoop::Lag(spec.loop, 1 / s.rate), JointVector::Zero(model->dof())};
  }
}

void CommandedSpeeds::Add(const TickRecord& record) {
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms_[i]) continue;
    Arm& arm = *arms_[i];
    const HandRecord& hand = record.hands[i];
    const JointVector q = Eigen::Map<const JointVector>(hand.q.data(), arm.model->dof()),
                      v = Eigen::Map<const JointVector>(hand.command.data(), arm.model->dof());
    if (record.state == RunState::kRun) {
      arm.data->UpdateKinematics(*arm.model, q + arm.lag * arm.last, v);
      const Twist V = arm.data->FrameTwist(*arm.model, arm.handle);
      share_ =
          std::max({share_, V.head<3>().norm() / speed_cap_, V.tail<3>().norm() / rotation_cap_});
    }
    arm.last = v;
  }
}

}  // namespace predictor
