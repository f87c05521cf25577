#include "simulation/event_checks.h"

#include <string>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

void CheckGripper(const EventSequence& events, std::size_t i, JointType joint) {
  const std::string path = "events." + std::to_string(i);
  const std::string is = path + ".event is " + events.kind(i).name;
  const bool grasps = events.kind(i).needs == HazardNeeds::kGrasp;
  if (events.duration(i) > 0)
    throw InputError::At(
        path + ".duration",
        is + " with a duration, but a gripper " +
            (grasps ? "stays closed until an event opens it. Remove the duration, and add an event "
                      "release_object."
                    : "stays open until an event closes it. Remove the duration, and add an event "
                      "grasp_object."));
  if (!grasps) return;
  if (joint != JointType::kFixed && joint != JointType::kSpherical)
    throw InputError::At(path + ".event",
                         is +
                             ", but only a fixed or a spherical attachment can close again. Change "
                             "object.attachment.joint, or remove the event.");
  if (!events.releases_object())
    throw InputError::At(path + ".event", is + ", but the gripper is closed from the start. Add an "
                                               "event release_object before this event.");
}

void CheckPickUp(const EventSequence& events, std::size_t i) {
  const std::string path = "events." + std::to_string(i);
  const std::string is = path + ".event is " + events.kind(i).name;
  if (events.duration(i) > 0)
    throw InputError::At(path + ".duration", is + " with a duration, but this gripper stays as it "
                                                  "is until the next command. Remove the duration, "
                                                  "and use pick_up and let_go.");
  if (!events.picks_up())
    throw InputError::At(
        path + ".event",
        is + ", but no event picks anything up. Add an event pick_up, or use release_object to let "
             "go of the object itself.");
  if (events.loosens_attachment())
    throw InputError::At(path + ".event",
                         is + ", but another event lets the object itself slip, break loose or be "
                              "released. Remove one of them.");
}

void CheckAttachmentEvent(const EventSequence& events, std::size_t i, JointType joint) {
  const HazardKind& kind = events.kind(i);
  const std::string path = "events." + std::to_string(i);
  const std::string is = path + ".event is " + kind.name;
  const bool can_slip = joint == JointType::kFixed || joint == JointType::kSpherical;
  if (kind.needs == HazardNeeds::kRelease || kind.needs == HazardNeeds::kGrasp)
    return CheckGripper(events, i, joint);
  if (kind.needs == HazardNeeds::kMovable || kind.needs == HazardNeeds::kPickUp)
    return CheckPickUp(events, i);
  if (kind.needs == HazardNeeds::kSlipping && !can_slip)
    throw InputError::At(path + ".event",
                         is + ", but only a fixed or a spherical attachment can slip. Change "
                              "object.attachment.joint, or use object_breaks_loose.");
  if (kind.needs == HazardNeeds::kNoEnd && events.duration(i) > 0)
    throw InputError::At(path + ".duration",
                         is + " with a duration, but an object that broke loose does not return to "
                              "the cobot. Remove the duration, or use object_slips.");
}

// Returns why no spring of the controller responds to a shift of the set-point, or "" if one does.
std::string MissingForShift(const Vector6& shift, const std::string& type,
                            const Controller& controller) {
  const Vector6 axes = controller.set_point_axes();
  if (!shift.cwiseProduct(axes).isZero(0)) return "";
  return "the controller " + type + " has no spring that pulls the end-effector " +
         (axes.isZero(0) ? "to a set-point in space" : "along or about an axis of this jump");
}

// Returns the part that an event needs and this cobot lacks, or "" if it lacks nothing.
std::string MissingPart(HazardNeeds needs, const Controller& controller,
                        const Controller* standby) {
  switch (needs) {
    case HazardNeeds::kWristSensor:
      if (controller.uses_wrist_sensor() || (standby != nullptr && standby->uses_wrist_sensor()))
        break;
      return "cobot.controller does not use a wrist sensor";
    case HazardNeeds::kSprings:
      if (controller.has_springs()) break;
      return "cobot.controller has no springs and dampers";
    case HazardNeeds::kStandby:
      if (standby != nullptr) break;
      return "cobot.standby_controller is missing";
    default:
      break;
  }
  return "";
}

}  // namespace

void CheckEvents(const EventSequence& events, JointType joint, const std::string& type,
                 const Controller& controller, const Controller* standby) {
  for (std::size_t i = 0; i < events.size(); ++i) {
    const std::string path = "events." + std::to_string(i) + ".event";
    CheckAttachmentEvent(events, i, joint);
    const HazardNeeds needs = events.kind(i).needs;
    const std::string missing = needs == HazardNeeds::kSetPoint
                                    ? MissingForShift(events.set_point_shift(i), type, controller)
                                    : MissingPart(needs, controller, standby);
    if (missing.empty()) continue;
    throw InputError::At(
        path, Join({path, " is ", events.kind(i).name, ", which would have no effect, because ",
                    missing, ". Remove the event, or change the cobot."},
                   ""));
  }
}

}  // namespace predictor
