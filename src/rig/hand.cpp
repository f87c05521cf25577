#include "rig/hand.h"

#include <cmath>
#include <numbers>

#include "core/minimum_jerk.h"
#include "rig/arm_stiffness.h"

namespace predictor {
namespace {

constexpr double kNoiseBandwidth = 20;    // bandwidth of the force noise [Hz]
constexpr double kTremorCoherence = 0.5;  // time over which the tremor keeps its phase [s]
constexpr double kFree = 1e-3;            // a weaker grip counts as released

OrnsteinUhlenbeck Noise(std::uint64_t seed, const std::string& name, int axis) {
  const double time_constant = 1 / (2 * std::numbers::pi * kNoiseBandwidth);
  return {time_constant, RandomStream(seed, name + ".noise." + std::to_string(axis))};
}

NarrowBandNoise Tremor(const HandSpec& spec, std::uint64_t seed, const std::string& name,
                       int axis) {
  return {spec.tremor_frequency, kTremorCoherence,
          RandomStream(seed, name + ".tremor." + std::to_string(axis))};
}

Vector3 Saturate(const Vector3& x, double limit) {
  const double norm = x.norm();
  return norm > limit ? Vector3(x * (limit / norm)) : x;
}

}  // namespace

HandModel::HandModel(const HandSpec& spec, HandInertia inertia, std::uint64_t seed,
                     const std::string& name)
    : spec_(spec),
      inertia_(inertia),
      damping_(2 * spec.damping_ratio * (spec.mass * spec.stiffness).cwiseSqrt()),
      noise_{Noise(seed, name, 0), Noise(seed, name, 1), Noise(seed, name, 2),
             Noise(seed, name, 3), Noise(seed, name, 4), Noise(seed, name, 5)},
      tremor_{Tremor(spec, seed, name, 0), Tremor(spec, seed, name, 1),
              Tremor(spec, seed, name, 2)} {
  Reset(dt_);
}

void HandModel::Reset(double dt) noexcept {
  dt_ = dt;
  grip_ = grip_start_ = grip_phase_ = 0;
  keep_ = spec_.release_time > 0 ? std::exp(-dt / spec_.release_time) : 0;
  held_ = false;
  reflex_.Reset(spec_.reflex_delay / dt, Wrench::Zero());
}

void HandModel::StepGrip(bool hold, double grip_time) noexcept {
  if (hold && !held_) {
    grip_start_ = grip_;
    grip_phase_ = 0;
  }
  held_ = hold;
  if (hold) {
    grip_phase_ += dt_ / grip_time;
    grip_ = grip_start_ + (1 - grip_start_) * MinimumJerk(grip_phase_);
  } else {
    grip_ *= keep_;
    if (grip_ < kFree) grip_ = 0;
  }
}

Vector3 HandModel::Impedance(const Vector3& error, const Vector3& rate,
                             const ArmAbility* arm) const noexcept {
  if (!arm) return spec_.stiffness.cwiseProduct(error) + damping_.cwiseProduct(rate);
  const double g = spec_.reflex_gain;
  const Matrix3 stiffness = arm->stiffness / (1 + g);
  const Matrix3 damping = (HandDamping(arm->stiffness, spec_.mass, spec_.damping_ratio) +
                           g * spec_.reflex_delay * stiffness) /
                          (1 + g);
  return stiffness * error + damping * rate;
}

Wrench HandModel::Intend(const HandGoal& goal, const FrameMotion& handle,
                         const ArmAbility* arm) noexcept {
  StepGrip(goal.hold, goal.grip_time);
  // Noise samples are also drawn while the hand is free, so that later samples do not depend on the
  // grip.
  Wrench noise;
  for (int i = 0; i < 6; ++i) noise[i] = noise_[static_cast<std::size_t>(i)].Step(dt_);
  Vector3 tremor;
  for (int i = 0; i < 3; ++i) tremor[i] = tremor_[static_cast<std::size_t>(i)].Step(dt_);
  if (grip_ <= 0) {
    reflex_.Update(Wrench::Zero());
    return Wrench::Zero();
  }

  const Vector6 error = PoseError(goal.X_WH, handle.X_W);
  const Twist rate = goal.V_WH - handle.V_W;
  Wrench impedance;
  impedance << Impedance(error.head<3>(), rate.head<3>(), arm),
      spec_.rotation_stiffness * error.tail<3>() + spec_.rotation_damping * rate.tail<3>();
  Wrench F = impedance + reflex_.Update(spec_.reflex_gain * impedance);
  F.head<3>() += spec_.visual_stiffness.cwiseProduct(goal.object_error) + goal.force;

  // Each level is the root mean square of a vector, so each axis has a third of the power.
  const double axis = arm ? 1 / (std::sqrt(3.0) * arm->capacity) : 1 / std::sqrt(3.0);
  const double level = spec_.force_noise * F.head<3>().norm() + spec_.force_noise_floor;
  const double torque_level = spec_.force_noise * F.tail<3>().norm();
  F.head<3>() += axis * (level * noise.head<3>() + spec_.tremor_force * tremor);
  F.tail<3>() += axis * torque_level * noise.tail<3>();

  Wrench out;
  out << Saturate(F.head<3>(), spec_.max_force), Saturate(F.tail<3>(), spec_.max_torque);
  return out;
}

Wrench HandModel::Deliver(const Wrench& muscles, const FrameMotion& handle) const noexcept {
  if (grip_ <= 0) return Wrench::Zero();
  Wrench out = muscles;
  if (inertia_ == HandInertia::kInWrench) out.head<3>() -= spec_.mass * handle.A_W.head<3>();
  return grip_ * out;
}

}  // namespace predictor
