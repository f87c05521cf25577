// The memory that the emulator shares with the program predictor-dart, which simulates a DART world
// step by step. This memory contains only plain numbers, because the two programs are built with
// different libraries.
//
// Poses are a position [m] and a unit quaternion (w, x, y, z). Axes and wrenches are given in W
// unless stated otherwise. Between two requests, the program keeps the scene but no other state.
#pragma once

#include <cstdint>

namespace predictor::dart_engine {

inline constexpr std::uint32_t kVersion = 2;
inline constexpr int kDescriptor = 3;                       // of the memory, in the program
inline constexpr const char* kVersionOption = "--version";  // lets the program say that of DART

inline constexpr int kMaxJoints = 16;           // of the cobot
inline constexpr int kMaxDof = kMaxJoints + 6;  // and of the attachment, or of a free object
inline constexpr int kMaxPositions = kMaxJoints + 7;
inline constexpr int kMaxShapes = 64;
inline constexpr int kMaxObstacles = 66;  // floor, table and fixtures
inline constexpr int kMaxContacts = 192;  // a cylinder may touch a box at nine points
inline constexpr int kHandCount = 2;
inline constexpr int kTextSize = 256;

struct FramePose {
  double p[3], q[4];
};

// Mass [kg], centre of mass [m] in a frame, and inertia about the centre of mass in the frame's
// axes [kg·m²].
struct Inertia {
  double mass, com[3], inertia[9];
};

// ---- the scene, written once ---------------------------------------------------------------

struct CobotJoint {
  std::int32_t parent;  // joint that carries it; −1: the world
  std::int32_t prismatic;
  FramePose at;                // in the frame of the joint that carries it, at position 0
  double axis[3];              // unit, in its own frame
  Inertia body;                // that it moves, in its own frame
  double damping;              // [N·m·s/rad] or [N·s/m]
  double lower, upper, speed;  // limits; infinite: none
};

// kFree: the object is a free body, whose coordinates are its place in W and then those of a ball.
enum class Attachment : std::int32_t { kWeld, kBall, kRevolute, kPrismatic, kFree };
enum class ShapeKind : std::int32_t { kBox, kCylinder, kSphere, kCapsule, kPlane };

struct CollisionShape {
  ShapeKind kind;
  // The sizes are the edges of a box, the radius and the length without caps of a cylinder or
  // capsule, or the radius of a sphere [m]. The axis of a cylinder or capsule and the normal of a
  // plane are z.
  double size[3];
  FramePose at;  // in O, or in W
};

// A body of the surroundings that never moves.
struct Obstacle {
  CollisionShape shape;
  double friction;
  double restitution;    // share of the speed that an impact returns
  std::int32_t fixture;  // its number; −1: floor or table
};

struct SceneData {
  std::int32_t joints;
  CobotJoint joint[kMaxJoints];
  std::int32_t carrier;    // joint that moves the end-effector; −1: the world
  FramePose end_effector;  // E in the carrier's frame
  Attachment attachment;
  FramePose object_at;  // O in E, at position 0
  double pivot[3];      // of the attachment, in O [m]
  double axis[3];       // of a revolute or prismatic attachment, unit, in O
  double damping;       // of the attachment
  double lower, upper;  // its limits; infinite: none
  Inertia object;       // in O
  std::int32_t has_hand_masses;
  double handle[kHandCount][3];  // in O [m]
  double hand_radius;            // of the ball that defines a hand's inertia [m]
  std::int32_t shapes;
  CollisionShape shape[kMaxShapes];
  std::int32_t obstacles;
  Obstacle obstacle[kMaxObstacles];
  double gravity;  // along −z [m/s²]
  double step;     // [s]
};

// ---- a request -----------------------------------------------------------------------------

enum class Request : std::int32_t {
  kBuild,          // reads the scene
  kPrepare,        // computes what depends on positions and velocities
  kAccelerations,  // the same, and the accelerations at the given forces, without contacts
  kAdvance,        // a step; then what follows from the new positions and velocities
  kEnd,
};

enum class Result : std::int32_t {
  kDone,
  kNotFinite,  // before or after the step
  kTooManyContacts,
  kFailed,  // `text` says why
};

// The positions of a ball joint are a quaternion. Its velocities are its angular velocity in axes
// of O.
struct StateData {
  double q[kMaxPositions], v[kMaxDof];
  double hand_mass[kHandCount];  // [kg]
  std::uint64_t removed;         // fixtures that are not there; bit: number of the fixture
};

struct ForceData {
  double joint[kMaxDof];       // applied to the joints [N·m, N]
  double object[6];            // force and torque on the object, about its centre of mass
  double coulomb[kMaxJoints];  // friction of the cobot's joints [N·m, N]
};

// ---- the answer ----------------------------------------------------------------------------

// The rows are those of the linear velocity of the body's origin, and then those of the angular
// velocity, in axes of W.
struct BodyMotion {
  FramePose pose;
  double twist[6];
  double jacobian[6 * kMaxDof];  // row by row, kMaxDof numbers each
  double jacobian_rate[6 * kMaxDof];
};

struct ContactData {
  double p[3], normal[3], force[3];  // on the object; the normal points out of the surroundings
  double depth;
  std::int32_t fixture;  // its number; −1: floor or table
};

struct MotionData {
  StateData at;        // the state to which the following belongs
  BodyMotion body[2];  // E, O
  double com[3];       // of the object
  double kinetic_energy;
  double mass_matrix[kMaxDof * kMaxDof];  // column by column, kMaxDof numbers each
  double bias[kMaxDof];                   // Coriolis, centrifugal and gravity forces
  std::int32_t contacts;
  ContactData contact[kMaxContacts];
};

struct AccelerationData {
  double a[kMaxDof];
  double load[6];  // wrench of the load on E, about the attachment
  double load_at[3];
};

struct Memory {
  std::uint32_t version, size;
  std::uint32_t request, answer;  // counters; if they are equal, it is the run's turn
  Request kind;
  Result result;
  SceneData scene;
  StateData state;
  ForceData forces;
  MotionData motion;
  AccelerationData acceleration;
  char text[kTextSize];
};

}  // namespace predictor::dart_engine
