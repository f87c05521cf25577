// Hazards of the cobot's drives, which are closing brakes and a loss of power.
#include "simulation/hazards/hazards.h"

namespace predictor::hazards {
namespace {

struct PowerLossParameters {
  double brake_delay = 0.1;  // [s]
  bool brakes = true;
};

template <class V>
void Fields(V& v, PowerLossParameters& p) {
  v("brake_delay", p.brake_delay,
    Number("s", "time until the brakes close; until then, the cobot sinks", From(0, 10)));
  v("brakes", p.brakes, Flag("whether the cobot has brakes; without them, it falls"));
}

void CloseBrakes(const NoParameters&, double, Disturbance* d) noexcept { d->brakes = true; }

void LosePower(const PowerLossParameters& p, double elapsed, Disturbance* d) noexcept {
  d->powerless = true;
  if (p.brakes && elapsed >= p.brake_delay) d->brakes = true;
}

}  // namespace

const HazardKind kBrakesClose = HazardKindOf<NoParameters, CloseBrakes>(
    "brakes_close", "the cobot's brakes close in motion", "the cobot's brakes closed");

const HazardKind kPowerLoss = HazardKindOf<PowerLossParameters, LosePower>(
    "power_loss", "the cobot's motors lose their power, and then its brakes close",
    "the cobot lost its power");

}  // namespace predictor::hazards
