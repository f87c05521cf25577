#include "simulation/engine.h"

#include "core/error.h"
#include "simulation/dart/dart_engine.h"
#include "simulation/mujoco/mujoco_engine.h"

namespace predictor {

std::uint64_t TouchedFixtures(const Engine& engine) noexcept {
  std::uint64_t touched = 0;
  for (int i = 0; i < engine.contact_count(); ++i) {
    const int fixture = engine.contact(i).fixture;
    if (fixture >= 0) touched |= std::uint64_t{1} << fixture;
  }
  return touched;
}

std::unique_ptr<Engine> MakeEngine(const Scenario& scenario, const RobotModel& cobot,
                                   bool wrist_sensor, Holding holding) {
  switch (scenario.simulation.engine) {
    case EngineKind::kMujoco:
      return MakeMujocoEngine(scenario, cobot, wrist_sensor, holding);
    case EngineKind::kDart:
      if (holding == Holding::kFree)
        throw InputError::At("simulation.engine",
                             "simulation.engine is dart, in which the object cannot slip, break "
                             "loose or be put down. Remove the events object_slips, "
                             "object_breaks_loose and release_object, or set simulation.engine: "
                             "mujoco.");
      return MakeDartEngine(scenario, cobot, holding);
  }
  return nullptr;
}

}  // namespace predictor
