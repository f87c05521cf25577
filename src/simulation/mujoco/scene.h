// Composes the scene for MuJoCo, which is one tree of cobot, object, handles, surroundings and
// movable objects.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/scenario.h"
#include "simulation/engine.h"
#include "simulation/mujoco/library.h"

namespace predictor {

// The prefix of the names of the cobot's links and joints.
inline constexpr const char* kCobotPrefix = "cobot/";
// With this margin, a pair of shapes has no contact at any distance [m].
inline constexpr double kNoContact = -1e6;

// Two bodies that have contact because of cobot.touches, in the compiled model.
struct CobotPair {
  int link = -1, other = -1;  // bodies; other: another link, or the object
  bool active = true;         // false: they overlap at cobot.posture, so no contact acts
  std::vector<int> shapes;    // the engine's pairs of shapes
};

// A movable object in the compiled model.
struct MovableBody {
  int body = -1, qpos = -1, dof = -1;  // its index, and its addresses in qpos and qvel
};

struct Scene {
  ObjectModel object_model;
  SpecPtr spec;
  ModelPtr model;
  int end_effector = -1;                       // body index
  int object = -1;                             // body index; the body's frame is O
  int wrist_site = -1;                         // of the wrist sensor; −1: none
  int floor = -1;                              // shape; −1: none
  std::array<int, kHands> hand = {-1, -1};     // direct mode: point masses on the handles
  std::array<int, kMaxCobotJoints> qpos = {};  // address in qpos of RobotModel's joint j
  std::array<int, kMaxCobotJoints> dof = {};   // address in qvel of RobotModel's joint j
  std::vector<int> fixture_of;                 // geom: index in environment.fixtures; −1: another
  std::vector<Vector3> fixture_place;          // of each fixture, in W [m]
  std::vector<bool> fixture_yields;            // whether it has a stiffness
  std::vector<bool> fixture_keeps_out;         // whether it is a keep-out volume
  int object_qpos = -1, object_dof = -1;       // of a free object; −1: the cobot carries it
  std::vector<MovableBody> movables;           // environment.objects
  std::vector<int> movable_of;                 // body: index in environment.objects; −1: another
  std::vector<int> movable_pairs;              // pairs of shapes with which movable objects touch
  std::vector<CobotPair> cobot_pairs;          // of cobot.touches
  std::vector<ContactPair> excluded_pairs;     // pairs of cobot.touches that always touch
  // Numbers of coordinates, excluding those of the movable objects. The coordinates of the movable
  // objects come last.
  int own_positions = 0, own_dof = 0;
};

// Composes and compiles the scene. The attachment's joint connects the object's body to the body of
// the end-effector, so that only contacts need the constraint solver. The object collides with
// floor, table and fixtures. The cobot's links collide with the fixtures that touch them, and with
// what cobot.touches contains. The movable objects are free bodies that come after all other
// bodies. In direct mode, each handle has a body without weight whose mass is set at run time.
// Throws InputError. `wrist_sensor` states whether a sensor measures the wrench between the
// end-effector and the carried object.
Scene ComposeScene(const Scenario& scenario, const RobotModel& cobot, bool wrist_sensor = false,
                   Holding holding = Holding::kJoint);

// Returns the text of the scene (MJCF). Throws InputError if the engine cannot write the text.
std::string SceneText(const Scene& scene);

// Sets the mass [kg] of the body that represents a hand, or does nothing if there is no such body.
// Returns whether the mass changed. If the mass changed, all quantities that depend on the state
// must be computed again.
bool SetHandMass(const Scene& scene, int hand, double mass) noexcept;

// Moves the given fixtures far away, and all other fixtures to their places. The number of a
// fixture is the number of its bit.
void RemoveFixtures(const Scene& scene, std::uint64_t which) noexcept;

// Returns the friction of a joint of the cobot in the engine's model.
DofFriction FrictionOf(const Scene& scene, int joint) noexcept;
// Sets the friction. If the brakes are closed, the joint also creeps a hundred times less.
void SetFriction(const Scene& scene, int joint, const DofFriction& friction) noexcept;

}  // namespace predictor
