// The interface through which the rest of this module uses a physics engine. An engine is a scene
// in one state.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/archive.h"
#include "core/messages.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/scenario.h"
#include "simulation/contact_pair.h"

namespace predictor {

// The way in which the object is part of the scene. Either the attachment's joint connects it to
// the end-effector, or it is a free body.
enum class Holding { kJoint, kFree };

// Bodies with the frames E, O and M. kMovable is the first movable object, and others follow it.
enum class SceneBody { kEndEffector, kObject, kMovable };
constexpr SceneBody BodyOfMovable(int i) {
  return static_cast<SceneBody>(static_cast<int>(SceneBody::kMovable) + i);
}
constexpr int NumberOfMovable(SceneBody body) {  // negative: another body
  return static_cast<int>(body) - static_cast<int>(SceneBody::kMovable);
}

// The Coulomb friction of a joint of the cobot, and a measure of how little this friction creeps (1
// means no creep).
struct DofFriction {
  double torque, impedance;  // [N·m] or [N], [1]
};
inline constexpr double kBrakeImpedance = 0.9999;  // of a closed brake

// A point at which a body touches another body. If the object takes part in the contact, it is the
// body. Otherwise, a link of the cobot is the body if one takes part, or else a movable object.
struct Contact {
  Vector3 p_W = Vector3::Zero();       // [m]
  Vector3 normal_W = Vector3::Zero();  // unit vector, out of the other one
  Vector3 force_W = Vector3::Zero();   // on the body [N]
  double depth = 0;                    // of the penetration; negative: a gap [m]
  int fixture = -1;                    // the other's index in environment.fixtures; −1: none
  bool yields = false;                 // the fixture has a stiffness [N/m]
  bool keep_out = false;               // the fixture is a keep-out volume
  bool floor = false;                  // the other one is the floor
  int movable = -1;                    // the other's index in environment.objects; −1: none
  std::string_view other_link;  // the other one if it is a link of the cobot, or empty. If both
                                // indices are −1 and this is empty, it is the floor or the table
  int body = -1;          // the body's index in environment.objects; −1: the object or the cobot
  std::string_view link;  // of the cobot; empty: the object or a movable object
};

// The positions and velocities are those of the cobot's joints and of the attachment's joint or the
// free object, in the engine's order (Layout). The positions and velocities of the movable objects
// are separate, so that equilibrium, linearisation and attachment deal only with the cobot and its
// object. A rotation may have more position coordinates than velocity coordinates. A change of the
// positions is a vector as long as the velocities (tangent space).
//
// A step has two stages. In the first stage, Prepare computes the quantities that follow from
// positions and velocities. The caller then sets forces. In the second stage, Advance computes the
// accelerations and integrates. Some functions use the state of the last Prepare, as their comments
// state.
//
// Functions that are noexcept use neither the heap nor locks.
class Engine {
 public:
  using Values = Eigen::Map<Eigen::VectorXd>;
  using ConstValues = Eigen::Map<const Eigen::VectorXd>;
  using Jacobian6 = Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>>;

  struct Layout {
    int positions = 0, dof = 0;               // their numbers
    std::array<int, kMaxCobotJoints> q = {};  // index of a joint of RobotModel in positions
    std::array<int, kMaxCobotJoints> v = {};  // and in velocities
    int object_q = -1, object_v = -1;         // of a free object's first; −1: it is carried
    double step = 0;                          // [s]
  };

  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  const Layout& layout() const noexcept { return layout_; }
  virtual const ObjectModel& object_model() const noexcept = 0;
  int dof() const noexcept { return layout_.dof; }
  double step() const noexcept { return layout_.step; }

  // Returns another state of the same scene. Both states share the masses of hands, the friction,
  // the fixtures and the options.
  virtual std::unique_ptr<Engine> Copy() const = 0;

  // ---- the state -------------------------------------------------------------------------------

  virtual double time() const noexcept = 0;  // [s]
  virtual void SetTime(double time) noexcept = 0;
  virtual Values positions() noexcept = 0;
  virtual Values velocities() noexcept = 0;
  virtual Values joint_forces() noexcept = 0;  // applied, one for each velocity [N·m, N]
  // Sets the wrench on the object, about its centre of mass, in axes of W [N, N·m].
  virtual void SetObjectWrench(const Wrench& wrench) noexcept = 0;
  virtual ConstValues accelerations() const noexcept = 0;  // of the last step
  // Clears the initial values of the iterative contact solver, on which the last digits of the
  // results depend.
  virtual void ForgetSolution() noexcept = 0;

  // The following functions archive all of the above data as numbers. The steps after a restored
  // state are identical, bit for bit, to those of the original run.
  virtual std::size_t state_size() const noexcept = 0;
  virtual void Save(std::span<double> to) const noexcept = 0;
  virtual void Restore(std::span<const double> from) noexcept = 0;  // to be followed by Prepare
  // With Holding::kFree, sets the object's pose and twist to the given ones, but not its
  // acceleration.
  virtual void MoveObject(const FrameMotion& O) noexcept = 0;
  // The following data concern all movable objects (environment.objects). They are the positions
  // and velocities in the engine's order, the motions, and the potential energy of the weights,
  // which is 0 at z = 0 [J].
  virtual Values movable_positions() noexcept { return {nullptr, 0}; }
  virtual Values movable_velocities() noexcept { return {nullptr, 0}; }
  virtual Values movable_forces() noexcept { return {nullptr, 0}; }  // one for each velocity
  virtual Values all_velocities() noexcept { return velocities(); }  // and those of movable objects
  virtual Movables movables() const noexcept { return {}; }
  virtual Vector3 movable_com(int) const noexcept { return Vector3::Zero(); }  // in W [m]
  virtual double MovablePotential() const noexcept { return 0; }
  // Puts everything at rest at the model's zero, and the movable objects in the places where they
  // start. This function also repairs the state after an error.
  virtual void Clear() noexcept = 0;

  // ---- a step ----------------------------------------------------------------------------------

  // These functions return false on an error of the engine, or if there are more contacts than it
  // can handle. After an error, the state is unusable until Clear or Restore.
  virtual bool Prepare() noexcept = 0;
  virtual bool Advance() noexcept = 0;  // by layout().step
  // Computes only the accelerations at the present forces, and the load's wrench if `load` is true.
  virtual bool ComputeAccelerations(bool load) noexcept = 0;

  // ---- kinematics and forces, at the last Prepare ----------------------------------------------
  // Jacobian, JacobianRate, StepMatrix, Forces and AddReactions write values for all_velocities()
  // if their result is as large. AddReactions otherwise eliminates the movable objects.

  virtual Pose PoseOf(SceneBody body) const noexcept = 0;           // in W
  virtual FrameMotion MotionOf(SceneBody body) const noexcept = 0;  // A_W is zero
  virtual Vector3 object_com() const noexcept = 0;                  // in W [m]
  virtual double KineticEnergy() noexcept = 0;  // with that of movable objects [J]
  // Writes the Jacobian of the point p_W of a body: the rows of the point's velocity, and then
  // those of the body's angular velocity.
  virtual void Jacobian(SceneBody body, const Vector3& p_W, Jacobian6 J) noexcept = 0;
  virtual void JacobianRate(SceneBody body, const Vector3& p_W, Jacobian6 J) noexcept = 0;
  virtual void MassMatrix(Eigen::Ref<Eigen::MatrixXd> M) const noexcept = 0;
  virtual void TimesMass(const double* a, double* force) const noexcept = 0;  // M a
  // Writes the matrix of a step. The change of the velocities in a step is the inverse of this
  // matrix times step · forces. It is the mass matrix plus the terms that the integrator treats
  // implicitly.
  virtual void StepMatrix(Eigen::Ref<Eigen::MatrixXd> M) const noexcept = 0;
  // Writes all forces of the last ComputeAccelerations except those that StepMatrix contains [N·m,
  // N].
  virtual void Forces(Eigen::Ref<Eigen::VectorXd> forces) noexcept = 0;
  // Returns whether contacts, limits or friction react to applied forces. AddReactions adds the
  // contribution of the active contacts, limits and friction to the StepMatrix.
  virtual bool has_reactions() const noexcept = 0;
  virtual void AddReactions(Eigen::Ref<Eigen::MatrixXd> M) const noexcept = 0;
  // Sets positions ⊕ scale · change.
  virtual void Displace(const double* change, double scale) noexcept = 0;

  // Returns the wrench of the load on the end-effector, about the attachment, in axes of W. This
  // function requires Holding::kJoint, a wrist sensor, and a preceding ComputeAccelerations(true)
  // or Advance. Sets the attachment's place.
  virtual Wrench LoadWrench(Vector3* p_WA) const noexcept = 0;

  // Returns the contacts of the last Prepare. The forces of these contacts belong to the
  // accelerations that were computed last.
  virtual int contact_count() const noexcept = 0;
  virtual Contact contact(int i) const noexcept = 0;
  // Returns the pairs that cobot.touches concerns, with their distances at the present positions.
  // Empty without cobot.touches. Not for the tick.
  virtual std::vector<ContactPair> contact_pairs() const { return {}; }
  // Returns whether ComputeAccelerations includes contacts. If so, an object may rest on a body at
  // the start.
  virtual bool has_contacts_at_rest() const noexcept { return true; }

  // ---- the scene -------------------------------------------------------------------------------

  // Returns the friction of joint j of the cobot.
  virtual DofFriction JointFriction(int j) const noexcept = 0;
  virtual void SetJointFriction(int j, const DofFriction& friction) noexcept = 0;

  // Removes the given fixtures, and returns all other fixtures to their places. The number of a
  // fixture is the number of its bit. Prepare must follow this call.
  virtual void RemoveFixtures(std::uint64_t which) noexcept = 0;

  // Returns the distance [m] between the shapes of the object and of movable object i, or `most` if
  // it is larger.
  virtual double GapTo(int, double most) noexcept { return most; }
  // Lets the object and movable object i pass through each other, because the object holds it. −1
  // means none. Prepare must follow this call.
  virtual void SetHeldMovable(int) noexcept {}

  // In direct mode, the mass of a hand [kg]. The hand moves with its handle and has no weight.
  // SetHandMass returns whether the mass changed; if so, Prepare must follow. Other modes: 0.
  virtual double HandMass(int hand) const noexcept = 0;
  virtual bool SetHandMass(int hand, double mass) noexcept = 0;
  // Archives the sums of masses, including the rounding errors from changes of the hands' masses.
  virtual void ArchiveMasses(StateArchive& a) noexcept = 0;

  // Options for searches outside the tick. They determine whether the joints have Coulomb friction,
  // the relative accuracy with which contacts are solved, whether the movable objects touch
  // anything, whether the contacts of cobot.touches act, and whether any contacts act.
  struct Options {
    bool coulomb_friction = true;
    double tolerance = 0;
    bool movables_touch = true;
    bool cobot_touches = true;
    bool contacts = true;
  };
  virtual Options options() const noexcept = 0;
  virtual void SetOptions(const Options& options) noexcept = 0;

  virtual std::string SceneText() const = 0;  // for inspection, in the language of MuJoCo
  // Returns a sentence that states why the engine no longer computes, or "" if the engine still
  // computes.
  virtual std::string Failure() const { return ""; }

 protected:
  Layout layout_;
};

// Returns the fixtures that something touches at the last Prepare. The number of a fixture is the
// number of its bit.
std::uint64_t TouchedFixtures(const Engine& engine) noexcept;

// Composes the scene of a scenario (cobot, object, handles, floor and table) for the engine that
// simulation.engine selects. The object collides with floor and table. `wrist_sensor` states
// whether LoadWrench will be used. Throws InputError if the scene is invalid, or if it needs a
// property that this engine lacks.
std::unique_ptr<Engine> MakeEngine(const Scenario& scenario, const RobotModel& cobot,
                                   bool wrist_sensor, Holding holding);

}  // namespace predictor
