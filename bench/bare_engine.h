// The physics engine without the rest of the program, for comparison.
#pragma once

#include <vector>

#include "simulation/equilibrium.h"
#include "simulation/mujoco/scene.h"

namespace predictor::bench {

// The scene at its equilibrium, with the torques that keep it there.
struct Still {
  explicit Still(const Scenario& scenario) : scene(scenario, EventSequence(scenario)) {
    FindEquilibrium(scenario.environment, &scene);
    scene.Update(&scene.engine());
    scene.ApplyController(0, &scene.engine());
    start.resize(scene.engine().state_size());
    scene.engine().Save(start);
  }
  ControlledScene scene;
  std::vector<double> start;
};

// MuJoCo without the rest of the program, with its own model and state.
struct Bare {
  explicit Bare(const Scenario& scenario)
      : still(scenario),
        scene(ComposeScene(scenario, still.scene.robot(), still.scene.has_wrist_sensor())),
        data(mj_makeData(scene.model.get())) {
    mj_setState(scene.model.get(), data.get(), still.start.data(), mjSTATE_INTEGRATION);
  }
  // Constant torques hold an arm only for a short time, so the scene is reset every 100 steps.
  void Step() {
    if (++steps % 100 == 0)
      mj_setState(scene.model.get(), data.get(), still.start.data(), mjSTATE_INTEGRATION);
    mj_step(scene.model.get(), data.get());
  }
  Still still;
  Scene scene;
  DataPtr data;
  int steps = 0;
};

}  // namespace predictor::bench
