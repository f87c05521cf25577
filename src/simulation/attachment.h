// The attachment of an object that is a separate body. The attachment is the end-effector's grip on
// the object. It opens and closes on command.
#pragma once

#include <cmath>

#include "core/archive.h"
#include "core/types.h"
#include "scenario/scenario.h"
#include "simulation/disturbance.h"
#include "simulation/engine.h"
#include "simulation/limited_grip.h"

namespace predictor {

class Attachment {
 public:
  // `engine` must have a free object (Holding::kFree) and must outlive this attachment. Throws
  // InputError if the engine's cobot has too many joints.
  Attachment(const AttachmentSpec& spec, Engine* engine);

  // Grips the object at its present place.
  void Close() noexcept;
  // Sets the limits that the grip should reach.
  void SetLimits(const GripLimits& limits) noexcept { grip_.SetLimits(limits); }
  // Opens the grip, or closes it at the object's present place if the object is near enough. A
  // closing grip tightens. Uses the state of the last Prepare.
  void Command(const GripperCommands& commands) noexcept;
  AttachmentState state() const noexcept {
    return missed_ ? AttachmentState::kMissed : grip_.state();
  }
  // Whether the last command to grasp found the object too far away.
  bool missed() const noexcept { return missed_; }

  // See LimitedGrip.
  bool Hold(const Wrench& object_wrench) noexcept { return grip_.Hold(object_wrench); }
  void Follow() noexcept { grip_.Follow(); }
  const Wrench& load() const noexcept { return grip_.load(); }

  void Archive(StateArchive& a) noexcept { a(grip_, missed_, tried_); }

 private:
  bool IsNear(const GripperCommands& commands) const noexcept;

  Vector3 p_OA_;
  bool is_fixed_;
  LimitedGrip grip_;
  Pose start_;               // place of the grip at the start of the run
  bool missed_ = false;      // the last grasp found nothing
  double tried_ = HUGE_VAL;  // how long ago that grasp was commanded [s]
};

}  // namespace predictor
