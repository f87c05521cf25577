// Hazards of what surrounds the cobot and the object.
#include <cstdint>

#include "simulation/hazards/hazards.h"

namespace predictor::hazards {
namespace {

struct ObstacleParameters {
  int fixture = 0;
};

template <class V>
void Fields(V& v, ObstacleParameters& p) {
  v("fixture", p.fixture,
    Required(Number("",
                    "index of the fixture in environment.fixtures, from 0; the fixture exists only "
                    "during the event",
                    From(0, kMaxFixtures - 1))));
}

void Appear(const ObstacleParameters& p, double, Disturbance* d) noexcept {
  d->obstacles |= std::uint64_t{1} << p.fixture;
}

}  // namespace

const HazardKind kObstacleAppears = HazardKindOf<ObstacleParameters, Appear>(
    "obstacle_appears", "a fixture that was absent is there", "an obstacle appeared");

}  // namespace predictor::hazards
