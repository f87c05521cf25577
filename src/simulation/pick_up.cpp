#include "simulation/pick_up.h"

#include <algorithm>

namespace predictor {

PickUp::PickUp(Engine* engine)
    : engine_(*engine), grip_(SceneBody::kObject, {}, engine, engine->all_velocities().size()) {
  grip_.SetHeld(SceneBody::kMovable);
  grip_.Open();
}

void PickUp::Reset() noexcept {
  Release();
  missed_ = ignored_ = false;
  tried_ = HUGE_VAL;
  load_ = 0;
}

void PickUp::Resume() noexcept {
  grip_.SetLimits(limits_);
  if (held_ >= 0) grip_.SetHeld(BodyOfMovable(held_));
  engine_.SetHeldMovable(held_);
}

bool PickUp::Release() noexcept {
  if (held_ < 0) return false;
  held_ = -1;
  grip_.Open();
  engine_.SetHeldMovable(-1);
  engine_.movable_forces().setZero();
  return true;
}

bool PickUp::Command(const PickUpCommands& commands) noexcept {
  if (commands.is_open()) {
    missed_ = ignored_ = false;
    tried_ = HUGE_VAL;
    load_ = 0;
    return Release();
  }
  const bool is_new = commands.picked < tried_;
  tried_ = commands.picked;
  if (is_new) ignored_ = held_ >= 0;
  bool closes = false;
  if (is_new && held_ < 0) {
    missed_ = engine_.GapTo(commands.movable, 2 * commands.gap) > commands.gap;
    if (!missed_) {
      closes = true;
      held_ = commands.movable;
      const SceneBody body = BodyOfMovable(held_);
      limits_ = commands.grip;
      grip_.SetLimits(limits_);
      const Vector3 com = engine_.movable_com(held_);
      grip_.Close(body, engine_.PoseOf(body).Inverse() * com, false);
      engine_.SetHeldMovable(held_);
      p_OL_ = engine_.PoseOf(SceneBody::kObject).Inverse() * com;
    }
  }
  const double share =
      commands.picked < commands.load_time ? commands.picked / commands.load_time : 1;
  if (!ignored_) load_ = missed_ ? 0 : share * commands.mass;
  return closes;
}

bool PickUp::Hold(const Wrench& object_wrench) noexcept {
  return held_ < 0 || grip_.Hold(object_wrench);
}

bool PickUp::Follow() noexcept {
  if (held_ < 0) return false;
  grip_.Follow();
  return grip_.is_lost() && Release();
}

void PickUp::Archive(StateArchive& a) noexcept {
  a(grip_, held_, missed_, ignored_, tried_, load_, p_OL_);
  a(limits_.force, limits_.torque, limits_.reach);
  if (held_ < -1 || held_ >= engine_.movables().count) {
    held_ = -1;
    a.Fail();
  }
}

}  // namespace predictor
