// The scene for the physics engine: cobot, object, handles, floor and table, composed into one
// tree.
#pragma once

#include <array>
#include <string>

#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/scenario.h"
#include "simulation/engine.h"

namespace predictor {

struct Scene {
  ObjectModel object_model;
  SpecPtr spec;
  ModelPtr model;
  int end_effector = -1;                       // bodies
  int object = -1;                             // its frame is O
  std::array<int, kHands> hand = {-1, -1};     // direct mode: point masses on the handles
  std::array<int, kMaxCobotJoints> qpos = {};  // address in qpos of RobotModel's joint j
  std::array<int, kMaxCobotJoints> dof = {};   // and in qvel
};

// Composes and compiles. The object's body hangs from the end-effector's by the attachment's joint,
// so that nothing but contacts needs the constraint solver. Object, floor and table collide with
// one another as far as one of them moves; the cobot's links collide with nothing.
// In direct mode each handle carries a body without weight whose mass is set at run time.
// Throws InputError.
Scene ComposeScene(const Scenario& scenario, const RobotModel& cobot);

// Text of the scene (MJCF). Throws InputError if the engine cannot write it.
std::string SceneText(const Scene& scene);

// Sets the mass [kg] of the body that stands for a hand; nothing happens where there is none.
// Returns whether it changed: then all that follows from the state must be computed anew.
bool SetHandMass(const Scene& scene, int hand, double mass) noexcept;

}  // namespace predictor
