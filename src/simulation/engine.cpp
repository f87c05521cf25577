#include "simulation/engine.h"

#include "simulation/dart/dart_engine.h"
#include "simulation/mujoco/mujoco_engine.h"

namespace predictor {

std::unique_ptr<Engine> MakeEngine(const Scenario& scenario, const RobotModel& cobot,
                                   bool wrist_sensor, Holding holding) {
  switch (scenario.simulation.engine) {
    case EngineKind::kMujoco:
      return MakeMujocoEngine(scenario, cobot, wrist_sensor, holding);
    case EngineKind::kDart:
      return MakeDartEngine(scenario, cobot, holding);
  }
  return nullptr;
}

}  // namespace predictor
