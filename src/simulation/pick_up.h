// The object as a gripper: it picks up movable objects, carries them and lets go of them on
// command.
#pragma once

#include <cmath>

#include "core/archive.h"
#include "core/types.h"
#include "simulation/disturbance.h"
#include "simulation/engine.h"
#include "simulation/limited_grip.h"

namespace predictor {

class PickUp {
 public:
  // `engine` must outlive this.
  explicit PickUp(Engine* engine);

  // Holds nothing, as at the start of a run. To be followed by Prepare of the engine.
  void Reset() noexcept;
  // Call it before the engine's state is restored that belongs to the loaded state.
  void Resume() noexcept;
  // Opens the grip, or closes it around a movable object where this one is, if it is near enough.
  // While the gripper holds something, it cannot close around something else. Uses the state of the
  // last Prepare. Returns whether Prepare must follow.
  bool Command(const PickUpCommands& commands) noexcept;

  // Returns the number of the movable object that it holds, or −1 for none.
  int held() const noexcept { return held_; }
  // kOpen also before the first command.
  AttachmentState state() const noexcept {
    if (missed_) return AttachmentState::kMissed;
    return held_ < 0 ? AttachmentState::kOpen : grip_.state();
  }

  // See LimitedGrip. Follow returns whether Prepare must follow, because the movable object left
  // the grip.
  bool Hold(const Wrench& object_wrench) noexcept;
  bool Follow() noexcept;

  // Returns the mass that the cobot compensates at present [kg], and its place in O [m]. The cobot
  // does not notice that the object slips or leaves the grip.
  double load() const noexcept { return load_; }
  const Vector3& p_OL() const noexcept { return p_OL_; }  // NOLINT(readability-identifier-naming)

  void Archive(StateArchive& a) noexcept;

 private:
  bool Release() noexcept;

  Engine& engine_;
  LimitedGrip grip_;
  int held_ = -1;
  bool missed_ = false;      // the last command found nothing
  bool ignored_ = false;     // the last command came while it held something
  GripLimits limits_;        // of the command that it follows
  double tried_ = HUGE_VAL;  // how long ago that command was given [s]
  double load_ = 0;          // [kg]
  Vector3 p_OL_ = Vector3::Zero();
};

}  // namespace predictor
