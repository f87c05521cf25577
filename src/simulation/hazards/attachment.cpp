// Hazards of the attachment between the cobot and the object.
#include <algorithm>

#include "simulation/hazards/hazards.h"

namespace predictor::hazards {
namespace {

struct SlipParameters {
  double force = 20, torque = 2, distance = 0.1;
};

template <class V>
void Fields(V& v, SlipParameters& p) {
  v("slip_force", p.force,
    Number("N", "largest force that the grip holds; above it, the object slides", From(0, 1e4)));
  v("slip_torque", p.torque,
    Number("N·m",
           "largest torque that the grip of a fixed attachment holds; above it, the object turns",
           From(0, 1e4)));
  v("slip_distance", p.distance,
    Number("m", "distance after which the sliding object leaves the grip", Above(0, 10)));
}

void Open(const NoParameters&, double, Disturbance* d) noexcept {
  d->grip.force = d->grip.torque = 0;
}

void Slip(const SlipParameters& p, double, Disturbance* d) noexcept {
  d->grip.force = std::min(d->grip.force, p.force);
  d->grip.torque = std::min(d->grip.torque, p.torque);
  d->grip.reach = std::min(d->grip.reach, p.distance);
}

}  // namespace

const HazardKind kObjectBreaksLoose = HazardKindOf<NoParameters, Open>(
    "object_breaks_loose", "the attachment opens, and only the hands hold the object",
    "the object broke loose", HazardNeeds::kNoEnd);

const HazardKind kObjectSlips = HazardKindOf<SlipParameters, Slip>(
    "object_slips", "the object slips in the cobot's grip when the load on the grip is too large",
    "the object slipped", HazardNeeds::kSlipping);

}  // namespace predictor::hazards
