// Commands to a gripper that the cobot carries as its object. They are no hazards, but events like
// them.
#include <string>

#include "simulation/hazards/hazards.h"

namespace predictor::hazards {
namespace {

struct PickUpParameters {
  std::string object;
  double gap = 0.01, force = 200, torque = 20, distance = 0.1, load = 0, load_time = 0.5;
};

template <class V>
void Fields(V& v, PickUpParameters& p) {
  v("object", p.object,
    Required(Word("name of the movable object in environment.objects that is picked up")));
  v("grasp_gap", p.gap,
    Number("m",
           "largest distance between the shapes of the carried object and of the movable one; "
           "beyond it, the gripper stays open",
           Above(0, 1)));
  v("slip_force", p.force,
    Number("N", "largest force that the grip holds; above it, the movable object slides",
           Above(0, 1e4)));
  v("slip_torque", p.torque,
    Number("N·m",
           "largest torque about the movable object's centre of mass that this grip holds; above "
           "it, the movable object turns",
           Above(0, 1e4)));
  v("slip_distance", p.distance,
    Number("m", "distance after which the sliding object leaves the grip", Above(0, 10)));
  v("load", p.load,
    Number("kg",
           "mass at the movable object's centre of mass that the cobot compensates while the "
           "gripper is closed",
           From(0, 1000)));
  v("load_time", p.load_time,
    Number("s", "time within which the cobot begins to compensate it", From(0, 60)));
}

// The most recent command of each kind counts.
void PickUp(const PickUpParameters& p, double elapsed, Disturbance* d) noexcept {
  PickUpCommands& commands = d->pick_up;
  if (elapsed >= commands.picked) return;
  commands.picked = elapsed;
  commands.gap = p.gap;
  commands.grip = {p.force, p.torque, p.distance};
  commands.mass = p.load;
  commands.load_time = p.load_time;
}

void LetGo(const NoParameters&, double elapsed, Disturbance* d) noexcept {
  if (elapsed < d->pick_up.let_go) d->pick_up.let_go = elapsed;
}

}  // namespace

const HazardKind kPickUp =
    HazardKindOf<PickUpParameters, PickUp>("pick_up",
                                           "the object, which is a gripper, closes around a "
                                           "movable object and holds it where it is",
                                           "the object picked something up", HazardNeeds::kMovable);

const HazardKind kLetGo = HazardKindOf<NoParameters, LetGo>(
    "let_go", "the object, which is a gripper, opens and releases the movable object",
    "the object let go of what it held", HazardNeeds::kPickUp);

}  // namespace predictor::hazards
