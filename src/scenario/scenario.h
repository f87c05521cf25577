// Defines a scenario, which contains all data of an emulation, as plain structs. One YAML file
// contains one scenario; scenario_io.h reads and writes it. Every member has a default and a unit
// (SI).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/hands.h"
#include "core/sex.h"
#include "core/types.h"
#include "scenario/event_spec.h"
#include "scenario/fixture_spec.h"
#include "scenario/movable_spec.h"
#include "scenario/perturbation_spec.h"
#include "scenario/yaml_tree.h"

namespace predictor {

// A pose as written in a file: position [m], then roll, pitch, yaw [rad] about fixed x, y, z.
struct PoseSpec {
  Vector3 xyz = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
  Pose ToPose() const { return PoseFromXyzRpy(xyz, rpy); }
};

// Pose of a haptic arm's base in the rig's frame R, as a file gives it and `calibrate bases`
// measures it. This type is deliberately not a PoseSpec, because the pose of the base in W also
// depends on environment.shift (see Scenario::X_WB).
struct BaseSpec {
  Vector3 xyz = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
  Pose X_RB() const { return PoseFromXyzRpy(xyz, rpy); }  // NOLINT(readability-identifier-naming)
};

enum class Mode { kEmulate, kDirect };

// ---- the virtual cobot -----------------------------------------------------------------------

// Friction of the cobot's joints, with one value for all joints or one value per joint.
struct JointFriction {
  std::vector<double> viscous = {1.0};  // [N·m·s/rad]
  std::vector<double> coulomb = {0.0};  // [N·m]
};

// A point of a set-point trajectory and the time at which the set-point is there. The set-point
// moves from point to point with minimum jerk, from rest to rest.
struct Waypoint {
  double time = 0;                // [s]
  Vector3 xyz = Vector3::Zero();  // offset of the end-effector's set-point from its start, in W [m]
  Vector3 rpy = Vector3::Zero();  // rotation of the set-point from its start, about W's axes [rad]
};

struct ControllerSpec {
  std::string type = "cartesian_impedance";  // a name in the controller registry
  // The parameters of this controller (own_parameters.h). Missing parameters have their defaults.
  YamlNode parameters;

  // Sets one parameter to a value in YAML, as in "stiffness.translation=[5, 5, 500]".
  void Set(const std::string& assignment) { ApplyOverride(assignment, &parameters); }
};

// The times at which the controller computes and at which its torques act.
struct ControlSpec {
  double rate = 1000;  // rate of the controller [Hz]
  double delay = 0;    // delay from the state that the controller sees to its torque [s]
};

// Force/torque sensor in the cobot's wrist, for controllers that use such a sensor.
struct WristSensorSpec {
  double noise_force = 0;           // standard deviation [N]
  double noise_torque = 0;          // [N·m]
  std::array<double, 6> bias = {};  // [N], [N·m]
  double cutoff_frequency = 150;    // cutoff of the first-order filter [Hz]
};

// The load in the gripper, as assumed by the cobot's program.
struct PayloadSpec {
  double mass = 1;                           // [kg]
  Vector3 center_of_mass = Vector3::Zero();  // in E [m]
};

// The cobot's own safety functions, as its vendor provides them. Absent ones are off.
struct CobotSafetySpec {
  std::optional<double> force;         // limit of the force estimated at the end-effector [N]
  std::optional<double> speed;         // limit of the end-effector's speed [m/s]
  std::optional<double> momentum;      // limit of the arm's momentum at the end-effector [kg·m/s]
  std::optional<double> joint_torque;  // limit of the external torque estimated in a joint [N·m]
  std::optional<double> joint_force;   // the same in a prismatic joint [N]
  double stop_deceleration = 5;        // deceleration of each joint in a protective stop [rad/s²]
  std::optional<double> force_cap;     // limit of the controller's force at the end-effector [N]
  std::optional<double> speed_cap;     // speed above which the cobot brakes [m/s]
  double observer_rate = 30;           // bandwidth of the estimates [Hz]
};

struct CobotSpec {
  std::string model;                      // URDF: package:// or relative to the scenario
  std::vector<std::string> remove_links;  // links that are removed with all their descendants
  PoseSpec base;                          // X_WB
  std::string end_effector;               // link E
  std::vector<double> posture;  // joint positions at the start, before the cobot sags [rad]
  JointFriction joint_friction;
  std::vector<double> effort_limit;  // [N·m]; one for all, or per joint; empty: those of the URDF
  ControllerSpec controller;
  ControlSpec control;
  WristSensorSpec wrist_sensor;
  std::optional<ControllerSpec> standby_controller;  // second controller, for the event `takeover`
  CobotSafetySpec safety;
  std::optional<PayloadSpec> payload;  // that the cobot compensates while it holds the object
  std::vector<std::string> touches;    // that its links collide with: object, cobot

  bool Touches(const char* what) const {
    return std::find(touches.begin(), touches.end(), what) != touches.end();
  }
};

// ---- what is carried -------------------------------------------------------------------------

enum class JointType { kSpherical, kFixed, kRevolute, kPrismatic };

struct AttachmentSpec {
  JointType joint = JointType::kSpherical;
  PoseSpec on_end_effector;                    // X_EA: pose of the joint on the cobot
  PoseSpec on_object;                          // X_OA: pose of the joint on the object
  Vector3 axis = {0, 0, 1};                    // axis of a revolute or prismatic joint, in A
  double damping = 0;                          // damping of the joint [N·m·s/rad] or [N·s/m]
  std::optional<std::array<double, 2>> range;  // revolute [rad], prismatic [m]
};

struct ObjectSpec {
  std::string model;  // URDF; empty: the primitive
  std::optional<PrimitiveSpec> primitive;
  AttachmentSpec attachment;
};

enum class GripKind {
  kPower,  // fingers and palm close around the bar
  kHook,   // the bar hangs in the bent fingers
};

// The grip of a hand on its handle, for the evaluation of the person.
struct GripSpec {
  GripKind kind = GripKind::kPower;
  Vector3 bar = {0, 0, 1};  // direction of the bar towards the thumb, in D
};

struct HandleSpec {
  PoseSpec pose;     // on the object; HandlePose (models/object_model.h) returns X_OD
  std::string link;  // of the object's URDF, in whose frame the pose is; empty: O
  GripSpec grip;
};

struct TableSpec {
  Vector3 size = {0.8, 1.2, 0.05};  // [m]
  Vector3 top = {0.5, 0, 0.2};      // centre of the top face, in W [m]
};

struct EnvironmentSpec {
  double gravity = 9.81;  // [m/s²]
  bool floor = true;      // plane z = 0 with contact
  std::optional<TableSpec> table;
  std::vector<FixtureSpec> fixtures;
  std::vector<MovableSpec> objects;  // movable objects; at most kMaxMovables
  double friction = 0.8;             // coefficient of sliding friction in contacts
  // X_RW, pose of the virtual world in the frame of the arms' bases. Roll and pitch are 0, so
  // gravity points down in both frames. If `shift` is absent, W is R and the arms' bases may be
  // chosen freely.
  std::optional<PoseSpec> shift;
};

enum class EngineKind { kMujoco, kDart };
enum class JointLimits { kSoft, kHard, kNone };
enum class VelocityLimits { kOff, kHard };

// The physics engine of the virtual world.
struct SimulationSpec {
  EngineKind engine = EngineKind::kMujoco;
  // How the engine enforces the position limits of the cobot's joints and the attachment. If the
  // value is absent, the limits are soft in MuJoCo and hard in DART.
  std::optional<JointLimits> joint_limits;
  VelocityLimits velocity_limits = VelocityLimits::kOff;  // of the cobot's joints
};

// The distance by which a real handle may deviate from its virtual handle before the coupling acts
// between them (DESIGN: coupling).
struct CouplingSpec {
  double deadband = 0.004;          // [m]
  double stiffness = 2000;          // [N/m]
  double damping = 40;              // [N·s/m]
  double rotation_deadband = 0.05;  // [rad]
  double rotation_stiffness = 40;   // [N·m/rad]
  double rotation_damping = 0.8;    // [N·m·s/rad]
  double speed_damping = 600;       // damping of handle speeds above safety.handle_speed [N·s/m]
};

// ---- the device --------------------------------------------------------------------------------

// Calibrated properties of an arm's velocity loop: second order with a pure delay.
struct VelocityLoopSpec {
  double bandwidth = 15;  // natural frequency [Hz]
  double damping_ratio = 0.9;
  double delay = 0.004;  // [s]
};

// The properties of the real handle between sensor and hand, as calibrated.
struct HandlePayloadSpec {
  double mass = 0.4;                      // [kg]
  Vector3 center_of_mass = {0, 0, 0.05};  // centre of mass in S [m]
  Vector3 inertia = {4e-4, 4e-4, 2e-4};   // inertia about the centre of mass, axes of S [kg·m²]
};

// Properties of a force/torque sensor.
struct SensorSpec {
  PoseSpec pose;                     // X_ES
  double noise_force = 0.05;         // standard deviation [N]
  double noise_torque = 0.002;       // [N·m]
  double force_resolution = 0.02;    // [N]
  double torque_resolution = 0.001;  // [N·m]
  double range_force = 200;          // a reading beyond this value is saturated [N]
  double range_torque = 10;          // [N·m]
  double cutoff_frequency = 150;     // first-order, inside the sensor [Hz]; 0: none
  double delay = 0.001;              // delay from measurement to reading [s]
  double sample_rate = 1000;         // rate of the device's readings [Hz]
};

struct ArmSpec {
  std::string model;
  std::vector<std::string> remove_links;
  BaseSpec base;                       // X_RB
  std::string end_effector;            // link E
  PoseSpec handle;                     // X_EH
  std::vector<double> posture;         // initial joints for the inverse kinematics [rad]
  std::string elbow;                   // link whose origin is kept away from the other arm's
  std::vector<double> velocity_limit;  // one per joint; empty: 80 % of the URDF's [rad/s]
  std::vector<double> acceleration_limit = {10};  // one for all, or one per joint [rad/s²]
  double sample_rate = 1000;  // rate at which the device reports its joints [Hz]
  VelocityLoopSpec loop;
  // A real arm that follows positions also corrects position errors: its joints reach the positions
  // to which the commanded velocities lead. A Franka arm of a machine always corrects position
  // errors, whatever this value is.
  bool follows_position = false;
  HandlePayloadSpec payload;
  SensorSpec sensor;
};

struct DeviceSpec {
  std::string type = "simulated";
  std::optional<ArmSpec> left, right;
};

// The differences between the simulated rig and the program's model of this rig. Only the rig reads
// these values.
struct RigSpec {
  std::optional<VelocityLoopSpec> loop;  // true loop of both arms; if absent, device.arms.*.loop
  double computation_delay = 0;          // delay from reading to command of a tick [s]
  double encoder_resolution = 1e-5;      // [rad]
  double velocity_noise = 1e-4;          // standard deviation of measured joint velocity [rad/s]
  std::array<double, 6> sensor_bias = {1.5, -2.0, 3.0, 0.05, -0.08, 0.04};  // [N], [N·m]
  double start_offset = 0.01;  // distance from the virtual handles at which the arms are parked [m]
};

// ---- the operator ------------------------------------------------------------------------------

// A hand as a delayed impedance (sources: docs/concepts/operator.md).
struct HandSpec {
  Vector3 stiffness = {250, 100, 100};     // along W's axes [N/m]
  double rotation_stiffness = 4;           // [N·m/rad]
  double damping_ratio = 0.3;              // D = 2 ζ √(mass · stiffness)
  double rotation_damping = 0.1;           // [N·m·s/rad]
  double mass = 1.5;                       // effective mass that moves with the handle [kg]
  double reflex_gain = 0.4;                // share of stiffness and damping that acts with a delay
  double reflex_delay = 0.060;             // [s]
  Vector3 visual_stiffness = {0, 0, 200};  // correction by sight, per hand [N/m]
  double visual_delay = 0.200;             // [s]
  double tremor_force = 0.1;               // rms [N]
  double tremor_frequency = 10;            // [Hz]
  double force_noise = 0.03;               // coefficient of variation of the force
  double force_noise_floor = 0.1;          // rms [N]
  double speed_drift = 0.06;               // standard deviation of the pace (Ornstein-Uhlenbeck)
  double speed_drift_time = 1.0;           // time constant of the drift [s]
  double max_force = 60;                   // [N]
  double max_torque = 8;                   // [N·m]
  double release_time = 0.040;             // time constant of releasing [s]
  double internal_force = 0;               // internal force along the line between the hands [N]
};

// One entry of the operator's script, which begins at `start`.
struct ActionSpec {
  std::string action = "hold";  // a name in the registry of actions
  double start = 0;             // [s]
  // The parameters of this action (own_parameters.h). Missing parameters have their defaults.
  YamlNode parameters;

  // Sets one parameter to a value in YAML, as in "by=[0, 0, 0.1]".
  void Set(const std::string& assignment) { ApplyOverride(assignment, &parameters); }
};

// An example is MakeActionSpec("move", 1, {"duration=4", "by=[0, 0, 0.1]"}).
inline ActionSpec MakeActionSpec(const std::string& action, double start,
                                 const std::vector<std::string>& assignments = {}) {
  ActionSpec spec = {action, start, {}};
  for (const std::string& assignment : assignments) spec.Set(assignment);
  return spec;
}

// The operator's body, from which the sizes and masses of its parts follow. A measured length
// replaces the estimate from the height.
struct BodySpec {
  double height = 1.75;  // standing, without shoes [m]
  double mass = 75;      // [kg]
  Sex sex = Sex::kMale;
  std::optional<double> upper_arm;          // shoulder to elbow joint [m]
  std::optional<double> forearm;            // elbow to wrist joint [m]
  std::optional<double> hand;               // wrist joint to the third knuckle [m]
  std::optional<double> shoulder_distance;  // distance between the shoulder joints [m]
  std::optional<double> trunk;              // middle of the hip joints to the vertebra C7 [m]
  std::optional<double> thigh;              // hip to knee joint [m]
  std::optional<double> shank;              // knee to ankle joint [m]
  // Strength in elbow flexion, elbow extension, shoulder flexion and shoulder extension, each as a
  // multiple of the mean for the sex.
  std::array<double, 4> strength = {1, 1, 1, 1};
  double stiffness = 1;  // stiffness of the arm's joints, as a multiple of the published mean
  double fatigue = 0;    // share of the arm's muscles that is fatigued at the start of a run
};

// Where the operator stands. The ground under the feet is not the virtual floor, because the haptic
// arms may stand anywhere in a laboratory.
struct StanceSpec {
  Vector3 ground = Vector3::Zero();  // point midway between the feet, in W [m]
  double facing = 0;                 // direction of view, about z of W from its x axis [rad]
  double feet_apart = 0.3;           // [m]
};

struct OperatorSpec {
  std::string type = "virtual";  // virtual | browser | person
  // Whether the virtual operator's reach, stiffness, strength, balance and fatigue follow from the
  // body and its posture (docs/concepts/operator.md).
  bool embodied = false;
  HandSpec hand;
  std::optional<BodySpec> body;      // absent: not known
  std::optional<StanceSpec> stance;  // absent: not known
  std::vector<ActionSpec> script;
};

// ---- haptic rendering --------------------------------------------------------------------------

// The members of this struct are parameters that several tasks and limits, or other modules, use.
struct RenderingSpec {
  std::string formulation = "repaired";         // repaired | paper
  std::vector<std::string> formulation_except;  // repairs that deviate from it (formulation.h)
  double kp = 2.0;                              // K_p of (9) [1/s]
  double ko = 0.4;  // K_o of (9): acts on the quaternion's vector part, half the angle [1/s]
  double relative_kp = 1.0;    // K'_p of (10) [1/s]
  double relative_ko = 0.9;    // K'_o of (10) [1/s]
  std::optional<double> lead;  // lead of the reference [s]; absent ("auto"): chosen automatically
  double lead_cutoff = 20;     // low-pass of the lead's acceleration [Hz]
  double manipulability = 0;   // α, weight of the manipulability gradient
  double characteristic_length = 0.2;  // weight of rotation relative to translation [m]
  double influence_distance = 0.7;     // d_i [m]
  double security_distance = 0.3;      // d_s [m]
  double collision_gain = 1.0;         // ξ [m/s]
  double joint_influence = 0.3;        // q_i [rad]
  double joint_security = 0.02;        // q_s [rad]
  double joint_gain = 1.0;             // ξ_q [rad/s]
  // Pairs of links that are kept apart. Each pair has a link of the left arm and one of the right
  // arm. The name left:LINK or right:LINK refers to a link of a specific arm. If the list is empty,
  // the two elbows are kept apart.
  std::vector<std::array<std::string, 2>> link_pairs;
  // The own parameters of tasks and limits. The parameters of each part are in a group with the
  // name of this part (own_parameters.h). Missing parameters have their defaults.
  YamlNode parts;
};

// ---- safety ------------------------------------------------------------------------------------

struct OscillationSpec {
  bool enabled = true;
  double low = 0.4;      // [Hz]
  double high = 10;      // [Hz]
  int cycles = 3;        // successive cycles, each larger than the previous one
  double amplitude = 2;  // minimum amplitude of the last cycle [N]
};

struct SafetySpec {
  double force = 30;                          // limit per hand [N]
  double torque = 5;                          // limit per hand [N·m]
  double tracking = 0.05;                     // distance of the real from the virtual handle [m]
  double tracking_rotation = 0.35;            // [rad]
  double relative_slack = 0.002;              // [m/s], for longer than relative_slack_time
  double relative_slack_rotation = 0.00873;   // [rad/s]
  double relative_slack_time = 0.050;         // [s]
  double coupling = 80;                       // [N]
  double coupling_torque = 15;                // [N·m]
  double max_age = 0.005;                     // age of a sample; for slower devices 2.5 periods [s]
  int frozen_samples = 50;                    // identical readings of a sensor with noise
  double handle_speed = 0.25;                 // cap [m/s]
  double handle_rotation_speed = 1.5;         // cap [rad/s]
  double stop_acceleration = 5;               // deceleration of the handles [m/s²]
  double stop_jerk = 250;                     // jerk of the handles [m/s³]
  double align_speed = 0.05;                  // [m/s]
  double align_tolerance = 0.002;             // [m]
  double align_tolerance_rotation = 0.01745;  // [rad]
  OscillationSpec oscillation;
};

// ---- guidance ----------------------------------------------------------------------------------

struct GuidanceSpec {
  std::string type = "none";         // none | circle
  Vector3 center = Vector3::Zero();  // offset from the object's start, in W [m]
  double radius = 0.15;              // [m]
};

struct Scenario {
  int predictor = 1;  // version of the file format
  std::string name;
  Mode mode = Mode::kEmulate;
  double duration = 30;  // [s]; 0: until the run is ended
  std::uint64_t seed = 1;
  double rate = 1000;  // ticks per second [Hz]; physics and rig run at 1 kHz internally
  CobotSpec cobot;
  ObjectSpec object;
  std::optional<HandleSpec> left_handle, right_handle;
  EnvironmentSpec environment;
  SimulationSpec simulation;
  CouplingSpec coupling;
  DeviceSpec device;
  RigSpec rig;
  OperatorSpec operator_;
  RenderingSpec rendering;
  SafetySpec safety;
  GuidanceSpec guidance;
  std::vector<EventSpec> events;
  std::optional<PerturbationSpec> perturbation;

  std::filesystem::path file;  // the file from which it was read; relative model paths start at its
                               // folder
  std::shared_ptr<const YamlNode> tree;  // the tree that was read, for the places of errors;
                                         // otherwise null
  // The answers that a controller outside the program gave while a recorded run was set up
  // (simulation/taped_controller.h). If there are such answers, the controller is not used. For a
  // scenario that is not from a recording, the pointer is null.
  std::shared_ptr<const std::vector<double>> controller_tape;

  std::filesystem::path folder() const {
    return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  }
  bool Has(int hand) const {
    return hand == 0 ? left_handle.has_value() : right_handle.has_value();
  }
  Hands hands() const { return {left_handle.has_value(), right_handle.has_value()}; }
  // Returns whether a person holds arms that can cause injury.
  bool HasRealArms() const { return mode == Mode::kEmulate && device.type != "simulated"; }
  const HandleSpec& handle(int hand) const { return hand == 0 ? *left_handle : *right_handle; }
  const ArmSpec& arm(int hand) const { return hand == 0 ? *device.left : *device.right; }
  // Returns the pose of an arm's base in the virtual world W.
  Pose X_WB(int hand) const {  // NOLINT(readability-identifier-naming)
    const Pose X_RB = arm(hand).base.X_RB();
    return environment.shift ? environment.shift->ToPose().Inverse() * X_RB : X_RB;
  }
  // Returns whether the arms' bases are given and the virtual world is placed around them.
  bool HasFixedArms() const { return device.type != "simulated" || environment.shift.has_value(); }
};

// Returns element `i` of `values`, or the only element if `values` has only one.
inline double OneOrEach(const std::vector<double>& values, int i) {
  return values.size() == 1 ? values[0] : values[static_cast<std::size_t>(i)];
}

}  // namespace predictor
