// The field tables of a scenario, one for each struct. The field tables are the only place that
// defines keys, units, meanings and permitted values. Loading, saving, the schema and overrides all
// use these tables.
//
// A visitor V offers three functions:
//   v(key, member, rule)      visits a member,
//   v.Group(key, doc, walk)   visits, by walk(V&), a group of keys that has no struct of its own,
//   v.Own(key, type, parameters, rule, kinds, common)
//                             visits a word that names a kind, the keys that all kinds have
//                             (common(auto& v)), and that kind's own parameters in the same group.
#pragma once

#include "scenario/actions/action.h"
#include "scenario/environment_fields.h"
#include "scenario/field_rules.h"
#include "scenario/formulation.h"
#include "scenario/operator_fields.h"
#include "scenario/own_parameters.h"
#include "scenario/perturbation_fields.h"
#include "scenario/scenario.h"

namespace predictor {

inline std::vector<std::string> NamesOf(Mode) { return {"emulate", "direct"}; }
inline std::vector<std::string> NamesOf(Shape) { return {"box", "cylinder", "sphere"}; }
inline std::vector<std::string> NamesOf(GripKind) { return {"power", "hook"}; }
inline std::vector<std::string> NamesOf(JointType) {
  return {"spherical", "fixed", "revolute", "prismatic"};
}

inline std::vector<std::string> NamesOf(EngineKind) { return {"mujoco", "dart"}; }
inline std::vector<std::string> NamesOf(JointLimits) { return {"soft", "hard", "none"}; }
inline std::vector<std::string> NamesOf(VelocityLimits) { return {"off", "hard"}; }

template <class V, class Spec>
void PoseFields(V& v, Spec& s) {
  v("xyz", s.xyz, Number("m", "position", Within(100)));
  v("rpy", s.rpy,
    Number("rad", "roll, pitch, yaw about the fixed axes x, y, z", Within(kFullTurn)));
}

template <class V>
void Fields(V& v, PoseSpec& s) {
  PoseFields(v, s);
}

template <class V>
void Fields(V& v, BaseSpec& s) {
  PoseFields(v, s);
}

template <class V>
void Fields(V& v, JointFriction& s) {
  v("viscous", s.viscous,
    OneOrList(Number("N·m·s/rad or N·s/m",
                     "viscous friction, one value for all joints or one per joint", From(0, 1e4)),
              1, kMaxCobotJoints));
  v("coulomb", s.coulomb,
    OneOrList(Number("N·m or N", "Coulomb friction, one value for all joints or one per joint",
                     From(0, 1e3)),
              1, kMaxCobotJoints));
}

template <class V>
void Fields(V& v, Waypoint& s) {
  v("time", s.time,
    Required(Number("s", "time at which the set-point passes it, at rest", From(0, 86400))));
  v("xyz", s.xyz, Number("m", "offset of the set-point from its start, in W", Within(10)));
  v("rpy", s.rpy,
    Number("rad", "rotation of the set-point from its start, about W's axes", Within(kFullTurn)));
}

template <class V>
void Fields(V& v, ControllerSpec& s) {
  v.Own("type", s.type, s.parameters, Word("name of the controller", NamesOf(Controllers())),
        Controllers(), [](auto&) {});
}

template <class V>
void Fields(V& v, ControlSpec& s) {
  v("rate", s.rate,
    Number("Hz", "rate at which the controller computes: 1000 divided by a whole number",
           From(1, 1000)));
  v("delay", s.delay,
    Number("s", "delay from the state that the controller sees to its torque; whole milliseconds",
           From(0, 0.1)));
}

template <class V>
void Fields(V& v, WristSensorSpec& s) {
  v("noise_force", s.noise_force, Number("N", "standard deviation", From(0, 100)));
  v("noise_torque", s.noise_torque, Number("N·m", "standard deviation", From(0, 10)));
  v("bias", s.bias, Number("", "bias [N, N, N, N·m, N·m, N·m], in axes of W", Within(1000)));
  v("cutoff_frequency", s.cutoff_frequency,
    Number("Hz", "cutoff of the first-order filter", Above(0, 500)));
}

template <class V>
void Fields(V& v, CobotSafetySpec& s) {
  v("force", s.force,
    Number("N", "limit of the force estimated at the end-effector; null: off", Above(0, 1e4)));
  v("speed", s.speed, Number("m/s", "limit of the end-effector's speed; null: off", Above(0, 100)));
  v("momentum", s.momentum,
    Number("kg·m/s", "limit of the arm's momentum at the end-effector; null: off", Above(0, 1000)));
  v("joint_torque", s.joint_torque,
    Number("N·m", "limit of the external torque estimated in a revolute joint; null: off",
           Above(0, 1e4)));
  v("joint_force", s.joint_force,
    Number("N", "limit of the external force estimated in a prismatic joint; null: off",
           Above(0, 1e4)));
  v("stop_deceleration", s.stop_deceleration,
    Number("rad/s² or m/s²", "deceleration of each joint in a protective stop", Above(0, 1000)));
  v("force_cap", s.force_cap,
    Number("N", "limit of the controller's force at the end-effector; null: off", Above(0, 1e4)));
  v("speed_cap", s.speed_cap,
    Number("m/s", "speed of the end-effector above which the cobot brakes; null: off",
           Above(0, 100)));
  v("observer_rate", s.observer_rate, Number("Hz", "bandwidth of the estimates", Above(0, 200)));
}

template <class V>
void Fields(V& v, PayloadSpec& s) {
  v("mass", s.mass, Required(Number("kg", "mass of the load", From(0, 1000))));
  v("center_of_mass", s.center_of_mass,
    Number("m", "where its weight acts, in the end-effector's frame", Within(10)));
}

template <class V>
void Fields(V& v, CobotSpec& s) {
  v("model", s.model, Required(Word("URDF: package://..., or relative to this file")));
  v("remove_links", s.remove_links, Word("links to remove, with everything attached to them"));
  v("base", s.base, Part("pose of the base in W"));
  v("end_effector", s.end_effector, Required(Word("link that carries the object")));
  v("posture", s.posture,
    List(Number(kAngleOrLength, "joint positions at the start, before the cobot sags", Within(100)),
         0, kMaxCobotJoints));
  v("joint_friction", s.joint_friction, Part("friction of the joints"));
  v("effort_limit", s.effort_limit,
    OneOrList(
        Number("N·m or N", "effort limit, one for all joints or one per joint; none: the model's",
               Above(0, 1e6)),
        0, kMaxCobotJoints));
  v("controller", s.controller, Part("controller that drives the joints"));
  v("control", s.control, Part("rate and delay of the controller"));
  v("wrist_sensor", s.wrist_sensor, Part("force sensor of controllers that use one"));
  v("standby_controller", s.standby_controller,
    Part("a second controller, for the event takeover; null: none"));
  v("safety", s.safety, Part("the cobot's own safety functions"));
  v("payload", s.payload,
    Part("load whose weight the cobot compensates while it holds the object; null: none"));
  v("touches", s.touches,
    List(Word("what the links collide with, apart from fixtures and movable objects: the carried "
              "object, the other links",
              {"object", "cobot"}),
         0, 2));
}

template <class V>
void Fields(V& v, EventPlaceSpec& s) {
  v("center", s.center, Number("m", "offset from the object's start, in W", Within(100)));
  v("radius", s.radius, Number("m", "radius around the centre", Above(0, 100)));
}

template <class V>
void Fields(V& v, TriggerSpec& s) {
  v("after", s.after, Number("s", "simulated time from which the event may begin", From(0, 86400)));
  v("window", s.window,
    Number("s", "a random share of this time, drawn from the seed, is added to `after`",
           From(0, 86400)));
  v("place", s.place, Part("where the object must be; null: anywhere"));
  v("force", s.force, Number("N", "force that a hand must exceed; null: any", From(0, 1000)));
  v("gripping", s.gripping, Flag("whether every hand must exert a force"));
}

template <class V>
void Fields(V& v, EventSpec& s) {
  v.Own("event", s.event, s.parameters, Required(Word("name of the hazard", NamesOf(Hazards()))),
        Hazards(), [&](auto& common) {
          common("trigger", s.trigger, Part("the event begins when all given conditions hold"));
          common("duration", s.duration,
                 Number("s", "duration of the event; 0: until the end of the run", From(0, 86400)));
        });
}

template <class V>
void Fields(V& v, PrimitiveSpec& s) {
  v("shape", s.shape, Word("shape of the body"));
  v("size", s.size,
    Number("m", "box: x, y, z; cylinder: radius, length, 0; sphere: radius, 0, 0", From(0, 10)));
  v("mass", s.mass, Number("kg", "mass", Above(0, 1000)));
  v("center_of_mass", s.center_of_mass, Number("m", "centre of mass in O", Within(10)));
  v("inertia", s.inertia,
    Number("kg·m²", "principal moments about the centre of mass; null: uniform density",
           Above(0, 1e4)));
}

template <class V>
void Fields(V& v, AttachmentSpec& s) {
  v("joint", s.joint, Word("how the object is attached to the cobot"));
  v("on_end_effector", s.on_end_effector, Part("pose of the joint on the end-effector"));
  v("on_object", s.on_object, Part("pose of the joint on the object"));
  v("axis", s.axis,
    Number("", "axis of a revolute or prismatic joint, in the joint's frame", Within(1)));
  v("damping", s.damping, Number("N·m·s/rad or N·s/m", "damping of the joint", From(0, 1e4)));
  v("range", s.range,
    Number(kAngleOrLength, "lowest and highest position of the joint", Within(100)));
}

template <class V>
void Fields(V& v, ObjectSpec& s) {
  v("model", s.model, Word("URDF: package://..., or relative to this file; empty: the primitive"));
  v("primitive", s.primitive, Part("a simple body, instead of a model"));
  v("attachment", s.attachment, Part("how the object is attached to the cobot"));
}

template <class V>
void Fields(V& v, GripSpec& s) {
  v("kind", s.kind, Word("whether the hand closes around the bar or the bar hangs in the fingers"));
  v("bar", s.bar, Number("", "direction of the bar towards the thumb, in D", Within(1)));
}

template <class V>
void Fields(V& v, HandleSpec& s) {
  Fields(v, s.pose);
  v("link", s.link,
    Word("link of the object's URDF in whose frame the pose is; empty: the object's frame"));
  v("grip", s.grip, Part("how the hand holds it"));
}

template <class V>
void Fields(V& v, SimulationSpec& s) {
  v("engine", s.engine,
    Word("physics engine; dart is the engine of Gazebo's dartsim, in virtual time only"));
  v("joint_limits", s.joint_limits,
    AbsentAs("auto", Word("limits of positions, of the cobot's joints and the attachment; auto: "
                          "soft with mujoco, hard with dart")));
  v("velocity_limits", s.velocity_limits,
    Word("limits of the velocities of the cobot's joints; hard: only with dart"));
}

template <class V>
void Fields(V& v, CouplingSpec& s) {
  v("deadband", s.deadband,
    Number("m", "distance between real and virtual handle that causes no force", From(0, 1)));
  v("stiffness", s.stiffness, Number("N/m", "stiffness beyond the deadband", From(0, 1e6)));
  v("damping", s.damping, Number("N·s/m", "damping beyond the deadband", From(0, 1e5)));
  v("rotation_deadband", s.rotation_deadband,
    Number("rad", "angle between real and virtual handle that causes no torque", From(0, 3)));
  v("rotation_stiffness", s.rotation_stiffness,
    Number("N·m/rad", "stiffness beyond rotation_deadband", From(0, 1e5)));
  v("rotation_damping", s.rotation_damping,
    Number("N·m·s/rad", "damping beyond rotation_deadband", From(0, 1e4)));
  v("speed_damping", s.speed_damping,
    Number("N·s/m", "damping of handle speeds above safety.handle_speed", From(0, 1e5)));
}

template <class V>
void Fields(V& v, VelocityLoopSpec& s) {
  v("bandwidth", s.bandwidth,
    Number("Hz", "natural frequency of the velocity loop", Above(0, 1000)));
  v("damping_ratio", s.damping_ratio,
    Number("", "damping ratio of the velocity loop", Above(0, 5)));
  v("delay", s.delay, Number("s", "pure delay of the velocity loop", From(0, 0.1)));
}

template <class V>
void Fields(V& v, HandlePayloadSpec& s) {
  v("mass", s.mass, Number("kg", "mass of the handle beyond the sensor", From(0, 20)));
  v("center_of_mass", s.center_of_mass,
    Number("m", "centre of mass in the sensor's frame", Within(1)));
  v("inertia", s.inertia,
    Number("kg·m²", "principal moments about the centre of mass, axes of S", From(0, 10)));
}

template <class V>
void Fields(V& v, SensorSpec& s) {
  v("pose", s.pose, Part("pose of the sensor on the end-effector"));
  v("noise_force", s.noise_force, Number("N", "standard deviation", From(0, 100)));
  v("noise_torque", s.noise_torque, Number("N·m", "standard deviation", From(0, 10)));
  v("force_resolution", s.force_resolution, Number("N", "step of the reading", From(0, 10)));
  v("torque_resolution", s.torque_resolution, Number("N·m", "step of the reading", From(0, 1)));
  v("range_force", s.range_force, Number("N", "readings beyond it are saturated", Above(0, 1e5)));
  v("range_torque", s.range_torque,
    Number("N·m", "readings beyond it are saturated", Above(0, 1e4)));
  v("cutoff_frequency", s.cutoff_frequency,
    Number("Hz", "first-order filter in the sensor; 0: none", From(0, 1e4)));
  v("delay", s.delay, Number("s", "delay from measurement to reading", From(0, 0.05)));
  v("sample_rate", s.sample_rate,
    Number("Hz", "readings per second of a real sensor; see safety.max_age", From(20, 1e4)));
}

template <class V>
void Fields(V& v, ArmSpec& s) {
  v("model", s.model,
    Required(Word("URDF: package://..., or, in a scenario, relative to its file")));
  v("remove_links", s.remove_links, Word("links to remove, with everything attached to them"));
  v("base", s.base, Part("pose of the base in W, if environment.shift is null"));
  v("end_effector", s.end_effector, Required(Word("link that carries sensor and handle")));
  v("handle", s.handle, Part("pose of the handle on the end-effector"));
  v("posture", s.posture,
    List(Number("rad", "joint positions from which inverse kinematics starts", Within(100)), 0,
         kMaxArmJoints));
  v("elbow", s.elbow, Word("link whose origin is kept away from the other arm's"));
  v("velocity_limit", s.velocity_limit,
    List(Number("rad/s", "one limit per joint; none: 80 % of the model's", Above(0, 100)), 0,
         kMaxArmJoints));
  v("acceleration_limit", s.acceleration_limit,
    OneOrList(Number("rad/s²", "one limit for all joints, or one per joint", Above(0, 1000)), 1,
              kMaxArmJoints));
  v("sample_rate", s.sample_rate,
    Number("Hz", "joint samples per second of a real arm; see safety.max_age", From(20, 1e4)));
  v("loop", s.loop, Part("properties of the arm's velocity loop"));
  v("follows_position", s.follows_position,
    Flag("whether a real arm's joints reach the positions to which the commanded velocities lead, "
         "as every Franka's do: it coasts less when it stops"));
  v("payload", s.payload, Part("the handle between sensor and hand"));
  v("sensor", s.sensor, Part("properties of the force/torque sensor"));
}

template <class V>
void Fields(V& v, DeviceSpec& s) {
  v("type", s.type, Word("simulated; --machine makes it real"));
  v.Group("arms", "the arms that hold the real handles", [&](V& g) {
    g("left", s.left, Part("left arm; null: absent"));
    g("right", s.right, Part("right arm; null: absent"));
  });
}

template <class V>
void Fields(V& v, RigSpec& s) {
  v("loop", s.loop, Part("true velocity loop of both arms; null: as device.arms.*.loop"));
  v("computation_delay", s.computation_delay,
    Number("s", "delay from a tick's reading to its command", From(0, 0.1)));
  v("encoder_resolution", s.encoder_resolution,
    Number("rad", "step of a joint's reading", From(0, 0.1)));
  v("velocity_noise", s.velocity_noise, Number("rad/s", "standard deviation", From(0, 1)));
  v("sensor_bias", s.sensor_bias,
    Number("N, N·m", "bias of force x y z and torque x y z", Within(1000)));
  v("start_offset", s.start_offset,
    Number("m", "distance from the virtual handles at which the arms are parked", From(0, 0.5)));
}

template <class V>
void Fields(V& v, RenderingSpec& s) {
  v("formulation", s.formulation,
    Word("the paper's equations (3) to (15) as printed, or with our repairs; real arms: repaired",
         {"repaired", "paper"}));
  v("formulation_except", s.formulation_except,
    List(Word("repairs that deviate from the formulation: added to paper, removed from repaired",
              RepairNames()),
         0, kRepairs));
  v("kp", s.kp, Number("1/s", "gain of position tracking, K_p of (9)", From(0, 1000)));
  v("ko", s.ko, Number("1/s", "gain of orientation tracking, K_o of (9)", From(0, 1000)));
  v("relative_kp", s.relative_kp,
    Number("1/s", "K'_p of the rigid constraint (10)", From(0, 1000)));
  v("relative_ko", s.relative_ko,
    Number("1/s", "K'_o of the rigid constraint (10)", From(0, 1000)));
  v("lead", s.lead,
    AbsentAs(
        "auto",
        Number("s",
               "time by which the reference runs ahead; auto: chosen from the stability margin",
               From(0, 0.2))));
  v("lead_cutoff", s.lead_cutoff,
    Number("Hz", "cutoff of the low-pass filter of the lead's acceleration; 0: no filter",
           From(0, 1000)));
  v("manipulability", s.manipulability,
    Number("", "α, weight of the manipulability gradient", From(0, 1000)));
  v("characteristic_length", s.characteristic_length,
    Number("m", "length by which rotation is weighed against translation", Above(0, 10)));
  v("influence_distance", s.influence_distance,
    Number("m", "d_i, distance below which link pairs are slowed", Above(0, 10)));
  v("security_distance", s.security_distance,
    Number("m", "d_s, distance at which link pairs stop", From(0, 10)));
  v("collision_gain", s.collision_gain,
    Number("m/s", "ξ, speed of approach permitted at d_i", Above(0, 100)));
  v("joint_influence", s.joint_influence,
    Number("rad", "q_i, distance from a limit below which joints are slowed", Above(0, 3.2)));
  v("joint_security", s.joint_security,
    Number("rad", "q_s, distance from a limit at which joints stop", From(0, 3.2)));
  v("joint_gain", s.joint_gain,
    Number("rad/s", "ξ_q, speed of approach permitted at q_i", Above(0, 100)));
  v("link_pairs", s.link_pairs,
    Word("pairs kept apart, [left link, right link], or left:LINK and right:LINK of either arm; "
         "none: the two elbows"));
  WalkParts(v, RenderingParts(), &s.parts);
}

template <class V>
void Fields(V& v, OscillationSpec& s) {
  v("enabled", s.enabled,
    Flag("whether a growing oscillation of a hand's force, or a vibration above 12 Hz, stops the "
         "run; may be off only in virtual time"));
  v("low", s.low, Number("Hz", "lowest frequency", Above(0, 100)));
  v("high", s.high, Number("Hz", "highest frequency", Above(0, 500)));
  v("cycles", s.cycles,
    Number("", "number of successive cycles, each larger than the one before", From(2, 20)));
  v("amplitude", s.amplitude, Number("N", "minimum amplitude of the last cycle", From(0, 1000)));
}

template <class V>
void Fields(V& v, SafetySpec& s) {
  v("force", s.force, Number("N", "force of a hand", Above(0, 1000)));
  v("torque", s.torque, Number("N·m", "torque of a hand", Above(0, 100)));
  v("tracking", s.tracking, Number("m", "distance between real and virtual handle", Above(0, 10)));
  v("tracking_rotation", s.tracking_rotation,
    Number("rad", "angle between real and virtual handle", Above(0, 3.2)));
  v("relative_slack", s.relative_slack,
    Number("m/s", "slack of the rigid constraint, for longer than relative_slack_time",
           Above(0, 10)));
  v("relative_slack_rotation", s.relative_slack_rotation,
    Number("rad/s", "slack of the rigid constraint, for longer than relative_slack_time",
           Above(0, 100)));
  v("relative_slack_time", s.relative_slack_time,
    Number("s", "time for which the slack may exceed its limit", From(0, 10)));
  v("coupling", s.coupling, Number("N", "coupling force on a virtual handle", Above(0, 1e4)));
  v("coupling_torque", s.coupling_torque,
    Number("N·m", "coupling torque on a virtual handle", Above(0, 1e4)));
  v("max_age", s.max_age,
    Number(
        "s",
        "age of a sample, or 2.5 sample periods if that is longer; must not exceed 20 ms or these",
        Above(0, 1)));
  v("frozen_samples", s.frozen_samples,
    Number("", "number of identical readings of a sensor that has noise", From(2, 100000)));
  v("handle_speed", s.handle_speed,
    Number("m/s", "cap of the handles' speed; real arms: at most 0.5", Above(0, 5)));
  v("handle_rotation_speed", s.handle_rotation_speed,
    Number("rad/s", "cap of the handles' rotation speed", Above(0, 20)));
  v("stop_acceleration", s.stop_acceleration,
    Number("m/s²", "deceleration of the handles in a stop", Above(0, 100)));
  v("stop_jerk", s.stop_jerk, Number("m/s³", "jerk of the handles in a stop", Above(0, 1e5)));
  v("align_speed", s.align_speed, Number("m/s", "speed of the handles in ALIGN", Above(0, 0.25)));
  v("align_tolerance", s.align_tolerance,
    Number("m", "largest distance between real and virtual handle to become ARMED", Above(0, 0.1)));
  v("align_tolerance_rotation", s.align_tolerance_rotation,
    Number("rad", "largest angle between real and virtual handle to become ARMED", Above(0, 1)));
  v("oscillation", s.oscillation,
    Part("detection of a growing oscillation or a vibration of a hand's force"));
}

template <class V>
void Fields(V& v, GuidanceSpec& s) {
  v("type", s.type, Word("what is drawn for the person to follow", {"none", "circle"}));
  v("center", s.center, Number("m", "offset from the object's start, in W", Within(10)));
  v("radius", s.radius, Number("m", "radius of the circle", Above(0, 10)));
}

template <class V>
void Fields(V& v, Scenario& s) {
  v("predictor", s.predictor, Number("", "version of the format", From(1, 1)));
  v("name", s.name, Word("name of the scenario, for people"));
  v("mode", s.mode, Word("emulate: through arms; direct: hands act on the virtual object itself"));
  v("duration", s.duration,
    Number("s", "duration of the run; 0: until a person ends it (operator.type browser)",
           From(0, 86400)));
  v("seed", s.seed, Number("", "seed of all random numbers", From(0, 18446744073709551615.0)));
  Rule rate = Number("Hz", "ticks per second", From(25, 1000));
  rate.steps = {25, 40, 50, 100, 125, 200, 250, 500, 1000};  // whole milliseconds
  v("rate", s.rate, rate);
  v("cobot", s.cobot, Part("the virtual cobot"));
  v("object", s.object, Part("the object that the cobot carries"));
  v.Group("handles", "pose of each handle on the object; at least one", [&](V& g) {
    g("left", s.left_handle, Part("left handle; null: absent"));
    g("right", s.right_handle, Part("right handle; null: absent"));
  });
  v("environment", s.environment, Part("surroundings of the cobot and the object"));
  v("simulation", s.simulation, Part("physics engine, and how it treats limits"));
  v("coupling", s.coupling, Part("force on the virtual handle when the arms cannot follow"));
  v("device", s.device, Part("the arms that a person holds"));
  v("rig", s.rig, Part("how the simulated arms differ from their description"));
  v("operator", s.operator_, Part("who holds the handles"));
  v("rendering", s.rendering, Part("how the arms follow the virtual handles"));
  v("safety", s.safety, Part("limits at which the run stops"));
  v("guidance", s.guidance, Part("what the person is asked to do"));
  v("events", s.events, List(Part("hazards that occur on purpose"), 0, kMaxEvents));
  v("perturbation", s.perturbation,
    Part("small displacements of the handles that identify the operator's arm; null: none"));
}

}  // namespace predictor
