// Commands of the cobot's program to its gripper. These commands are not hazards, but they are
// events like the hazards.
#include "simulation/hazards/hazards.h"

namespace predictor::hazards {
namespace {

struct GraspParameters {
  double distance = 0.03, angle = 0.35, load_time = 0.5;
};

template <class V>
void Fields(V& v, GraspParameters& p) {
  v("grasp_distance", p.distance,
    Number("m",
           "largest distance between the attachment on the object and its place in the gripper at "
           "the start; beyond it, the gripper stays open",
           Above(0, 10)));
  v("grasp_angle", p.angle,
    Number("rad", "largest rotation of a fixed attachment, likewise", Above(0, 3.2)));
  v("load_time", p.load_time,
    Number("s", "time within which the cobot begins to compensate cobot.payload", From(0, 60)));
}

// Only the most recent command of each kind has an effect.
void Release(const NoParameters&, double elapsed, Disturbance* d) noexcept {
  if (elapsed < d->gripper.released) d->gripper.released = elapsed;
}

void Grasp(const GraspParameters& p, double elapsed, Disturbance* d) noexcept {
  GripperCommands& gripper = d->gripper;
  if (elapsed >= gripper.grasped) return;
  gripper.grasped = elapsed;
  gripper.distance = p.distance;
  gripper.angle = p.angle;
  gripper.load_time = p.load_time;
}

}  // namespace

const HazardKind kReleaseObject = HazardKindOf<NoParameters, Release>(
    "release_object", "the cobot's gripper opens and releases the object",
    "the cobot released the object", HazardNeeds::kRelease);

const HazardKind kGraspObject = HazardKindOf<GraspParameters, Grasp>(
    "grasp_object", "the cobot's gripper closes around the object where it is at that time",
    "the cobot's gripper closed", HazardNeeds::kGrasp);

}  // namespace predictor::hazards
