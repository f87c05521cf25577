// Hazards in the surroundings of the cobot and the object.
#include <string>

#include "simulation/hazards/hazards.h"

namespace predictor::hazards {
namespace {

struct ObstacleParameters {
  std::string fixture;
};

template <class V>
void Fields(V& v, ObstacleParameters& p) {
  v("fixture", p.fixture,
    Required(Word("name of the fixture in environment.fixtures; it is absent until the event "
                  "begins, and after it ends")));
}

// The class EventSequence determines the number of the fixture.
void Appear(const ObstacleParameters&, double, Disturbance*) noexcept {}

}  // namespace

const HazardKind kObstacleAppears = HazardKindOf<ObstacleParameters, Appear>(
    "obstacle_appears", "a fixture appears", "an obstacle appeared", HazardNeeds::kFixture);

}  // namespace predictor::hazards
