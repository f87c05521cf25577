// The table of every key of a machine file with its unit, meaning and range. Loading, saving and
// the schema use this table.
#pragma once

#include <string>
#include <vector>

#include "scenario/fields.h"
#include "scenario/machine.h"

namespace predictor {

inline std::vector<std::string> NamesOf(ArmMake) { return {"ur", "franka"}; }
inline std::vector<std::string> NamesOf(SensorMake) { return {"own", "net_ft", "onrobot"}; }

// The largest handle speed that any machine may allow, because hands must be able to follow [m/s].
inline constexpr double kMaxHandleSpeed = 0.5;

template <class V>
void Fields(V& v, CollisionThresholds& s) {
  v("force", s.force, Number("N", "external force at the stiffness frame", Above(0, 200)));
  v("torque", s.torque, Number("N·m", "external torque at the stiffness frame", Above(0, 50)));
  v("joint_torque", s.joint_torque, Number("N·m", "external torque at each joint", Above(0, 100)));
}

template <class V>
void Fields(V& v, EnablingInput& s) {
  v("arm", s.arm, Required(Word("arm whose controller it is wired to", {"left", "right"})));
  v("digital_input", s.digital_input,
    Required(Number(
        "", "number of the input. UR: 0 … 7 standard, 8 … 15 configurable, 16 and 17 on the tool",
        From(0, 17))));
}

template <class V>
void Fields(V& v, ArmConnection& s) {
  v("make", s.make, Required(Word("make of the arm")));
  v("host", s.host, Required(Word("address of its controller, for example 192.0.2.10")));
  v("first_register", s.first_register,
    Number(
        "",
        "UR: first RTDE register used by this program: 0, or 24 if a fieldbus uses the lower ones",
        From(0, 24)));
  v("collision", s.collision,
    Part("Franka: thresholds of its own reflex; null: as set in the robot"));
}

template <class V>
void Fields(V& v, SensorConnection& s) {
  v("make", s.make, Word("make of the sensor; own: the arm measures the wrench itself"));
  v("host", s.host, Word("address of the sensor; none if make is own"));
  v("counts_per_force", s.counts_per_force,
    Number("1/N", "counts per force in the sensor's configuration (ATI: cfgcpf; OnRobot: 10000)",
           Above(0, 1e9)));
  v("counts_per_torque", s.counts_per_torque,
    Number("1/(N·m)",
           "counts per torque in the sensor's configuration (ATI: cfgcpt; OnRobot: 100000)",
           Above(0, 1e9)));
}

template <class V>
void Fields(V& v, Commissioned& s) {
  v("push_test", s.push_test, Word("date of the successful push test"));
  v("of", s.of, Word("hash of the arm's settings at that time; after a change, repeat the test"));
  v("loop", s.loop, Word("date when arm.loop was measured"));
  v("loop_of", s.loop_of, Word("hash of arm.loop at that time; after a change, measure again"));
}

template <class V>
void Fields(V& v, MachineArm& s) {
  v("connection", s.connection, Part("how the arm is reached"));
  v("sensor", s.sensor, Part("how its force/torque sensor is reached"));
  v("arm", s.arm, Part("properties of arm, sensor and handle, like device.arms.* of a scenario"));
  v("commissioned", s.commissioned,
    Part("written by `predictor calibrate push` and `calibrate loop`; null: never"));
}

template <class V>
void Fields(V& v, MachineLimits& s) {
  v("force", s.force, Number("N", "force of a hand", Above(0, 200)));
  v("torque", s.torque, Number("N·m", "torque of a hand", Above(0, 50)));
  v("handle_speed", s.handle_speed, Number("m/s", "speed of a handle", Above(0, kMaxHandleSpeed)));
  v("handle_rotation_speed", s.handle_rotation_speed,
    Number("rad/s", "rotation speed of a handle", Above(0, 3)));
  v("stop_acceleration", s.stop_acceleration,
    Number("m/s²", "minimum deceleration of the handles in a stop", Above(0, 10)));
  v("stop_jerk", s.stop_jerk,
    Number("m/s³", "minimum jerk of the handles in a stop", Above(0, 1000)));
  v("align_speed", s.align_speed, Number("m/s", "speed of the handles in ALIGN", Above(0, 0.1)));
  v("align_tolerance", s.align_tolerance,
    Number("m", "largest distance between real and virtual handle to become ARMED",
           Above(0, 0.01)));
  v("align_tolerance_rotation", s.align_tolerance_rotation,
    Number("rad", "largest angle between real and virtual handle to become ARMED", Above(0, 0.1)));
  v("tracking", s.tracking, Number("m", "distance between real and virtual handle", Above(0, 0.1)));
  v("tracking_rotation", s.tracking_rotation,
    Number("rad", "angle between real and virtual handle", Above(0, 0.7)));
  v("relative_slack", s.relative_slack,
    Number("m/s", "slack of the rigid constraint", Above(0, 0.02)));
  v("relative_slack_rotation", s.relative_slack_rotation,
    Number("rad/s", "slack of the rigid constraint", Above(0, 0.1)));
  v("relative_slack_time", s.relative_slack_time,
    Number("s", "time for which the slack may exceed its limit", From(0, 0.2)));
  v("coupling", s.coupling, Number("N", "force on a virtual handle", Above(0, 200)));
  v("coupling_torque", s.coupling_torque,
    Number("N·m", "torque on a virtual handle", Above(0, 50)));
  v("max_age", s.max_age, Number("s", "age of a sample", Above(0, 0.01)));
  v("frozen_samples", s.frozen_samples,
    Number("", "number of identical readings of a sensor that has noise", From(2, 500)));
  v("relative_kp", s.relative_kp, Number("1/s", "gain of the rigid constraint", From(0, 5)));
  v("relative_ko", s.relative_ko,
    Number("1/s", "rotational gain of the rigid constraint", From(0, 5)));
  v("security_distance", s.security_distance,
    Number("m", "minimum distance at which link pairs stop", From(0.05, 10)));
  v("joint_security", s.joint_security,
    Number("rad", "minimum distance from a limit at which joints stop", From(0.005, 1)));
}

template <class V>
void Fields(V& v, Machine& s) {
  Rule version = Required(Number("", "version of this format", From(1, 1)));
  version.steps = {1};
  v("predictor_machine", s.predictor_machine, version);
  v("name", s.name, Word("name of the machine, for people"));
  v.Group("arms", "the arms that hold the real handles", [&](V& g) {
    g("left", s.left, Part("left arm; null: absent"));
    g("right", s.right, Part("right arm; null: absent"));
  });
  v("limits", s.limits, Part("limits that no scenario may exceed"));
  v("ground", s.ground,
    Number("m",
           "height of the ground under the person, in the frame R of the bases; null: not measured",
           Within(10)));
  v("enabling", s.enabling,
    Part("device that a person holds while the arms may move; null: a key at the console"));
}

}  // namespace predictor
