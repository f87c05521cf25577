#include "simulation/attachment.h"

#include <string>

#include "core/error.h"

namespace predictor {
namespace {

constexpr int kMaxDof = kMaxCobotJoints + 6;

int DofOf(const Engine& engine) {
  if (engine.dof() <= kMaxDof) return engine.dof();
  throw InputError::At("cobot.model", "cobot.model has " + std::to_string(engine.dof() - 6) +
                                          " movable joints; an event of the attachment needs " +
                                          "at most " + std::to_string(kMaxCobotJoints) +
                                          ". Remove links with cobot.remove_links.");
}

}  // namespace

Attachment::Attachment(const AttachmentSpec& spec, Engine* engine)
    : p_OA_(spec.on_object.xyz),
      is_fixed_(spec.joint == JointType::kFixed),
      grip_(SceneBody::kEndEffector,
            {is_fixed_, spec.joint == JointType::kSpherical ? spec.damping : 0}, engine,
            DofOf(*engine)),
      start_(spec.on_end_effector.xyz,
             (spec.on_end_effector.ToPose() * spec.on_object.ToPose().Inverse()).q) {}

void Attachment::Close() noexcept {
  grip_.Close(SceneBody::kObject, p_OA_, true);
  missed_ = false;
  tried_ = HUGE_VAL;
}

void Attachment::Command(const GripperCommands& commands) noexcept {
  if (commands.is_open()) {
    grip_.Open();
    missed_ = false;
    tried_ = HUGE_VAL;
    return;
  }
  const bool is_new = commands.grasped < tried_;
  tried_ = commands.grasped;
  if (!grip_.is_released() || !is_new) return;
  missed_ = !IsNear(commands);
  if (!missed_) grip_.Close(SceneBody::kObject, p_OA_, false);
}

bool Attachment::IsNear(const GripperCommands& commands) const noexcept {
  const Pose now = grip_.Place();
  return (now.p - start_.p).norm() <= commands.distance &&
         (!is_fixed_ || RotationError(now.q, start_.q).norm() <= commands.angle);
}

}  // namespace predictor
