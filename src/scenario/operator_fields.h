// The field tables of the operator: hands, body, stance and script (see fields.h).
#pragma once

#include "scenario/actions/action.h"
#include "scenario/field_rules.h"
#include "scenario/own_parameters.h"
#include "scenario/scenario.h"

namespace predictor {

inline std::vector<std::string> NamesOf(Sex) { return {"female", "male"}; }

template <class V>
void Fields(V& v, HandSpec& s) {
  v("stiffness", s.stiffness, Number("N/m", "stiffness along W's axes", From(0, 1e5)));
  v("rotation_stiffness", s.rotation_stiffness,
    Number("N·m/rad", "stiffness about every axis", From(0, 1e4)));
  v("damping_ratio", s.damping_ratio, Number("", "ζ of D = 2 ζ √(mass · stiffness)", From(0, 5)));
  v("rotation_damping", s.rotation_damping,
    Number("N·m·s/rad", "damping about every axis", From(0, 1e3)));
  v("mass", s.mass, Number("kg", "effective mass that moves with the handle", From(0, 20)));
  v("reflex_gain", s.reflex_gain,
    Number("", "share of stiffness and damping that acts with the reflex's delay", From(0, 10)));
  v("reflex_delay", s.reflex_delay, Number("s", "delay of the reflex", From(0, 0.5)));
  v("visual_stiffness", s.visual_stiffness,
    Number("N/m", "stiffness of each hand's visual correction, along W's axes", From(0, 1e4)));
  v("visual_delay", s.visual_delay, Number("s", "delay of the visual correction", From(0, 0.5)));
  v("tremor_force", s.tremor_force, Number("N", "rms force of the tremor", From(0, 100)));
  v("tremor_frequency", s.tremor_frequency, Number("Hz", "frequency of the tremor", Above(0, 100)));
  v("force_noise", s.force_noise, Number("", "coefficient of variation of the force", From(0, 1)));
  v("force_noise_floor", s.force_noise_floor,
    Number("N", "rms force noise at zero force", From(0, 100)));
  v("speed_drift", s.speed_drift, Number("", "standard deviation of the pace", From(0, 1)));
  v("speed_drift_time", s.speed_drift_time,
    Number("s", "time constant of speed_drift", Above(0, 1000)));
  v("max_force", s.max_force, Number("N", "largest force that the hand can exert", Above(0, 1000)));
  v("max_torque", s.max_torque,
    Number("N·m", "largest torque that the hand can exert", Above(0, 100)));
  v("release_time", s.release_time,
    Number("s", "time constant with which the hand lets go", Above(0, 10)));
  v("internal_force", s.internal_force,
    Number("N", "internal force along the line between the hands", Within(200)));
}

template <class V>
void Fields(V& v, ActionSpec& s) {
  v.Own("action", s.action, s.parameters,
        Required(Word("what the operator does", NamesOf(Actions()))), Actions(), [&](auto& common) {
          common("start", s.start, Number("s", "time at which the action begins", From(0, 86400)));
        });
}

template <class V>
void Fields(V& v, BodySpec& s) {
  v("height", s.height, Required(Number("m", "height without shoes", From(1.2, 2.3))));
  v("mass", s.mass, Required(Number("kg", "mass of the body", From(30, 250))));
  v("sex", s.sex, Required(Word("sex, which selects the tables of body parts and strength")));
  const auto length = [&](const char* key, std::optional<double>& member, const char* doc) {
    v(key, member, Number("m", doc, From(0.05, 1.2)));
  };
  length("upper_arm", s.upper_arm, "shoulder to elbow joint; null: from the height");
  length("forearm", s.forearm, "elbow to wrist joint; null: from the height");
  length("hand", s.hand, "wrist joint to the third knuckle; null: from the height");
  length("shoulder_distance", s.shoulder_distance,
         "distance between the shoulder joints; null: from the height");
  length("trunk", s.trunk, "middle of the hip joints to the vertebra C7; null: from the height");
  length("thigh", s.thigh, "hip to knee joint; null: from the height");
  length("shank", s.shank, "knee to ankle joint; null: from the height");
  v("strength", s.strength,
    Number("",
           "as a multiple of the mean for the sex: elbow flexion, elbow extension, shoulder "
           "flexion, shoulder extension",
           From(0.1, 5)));
  v("stiffness", s.stiffness,
    Number("",
           "stiffness of the arm's joints, as a multiple of the published mean (operator.embodied)",
           From(0.1, 10)));
  v("fatigue", s.fatigue,
    Number("", "share of the arm's muscles that is fatigued at the start (operator.embodied)",
           From(0, 0.9)));
}

template <class V>
void Fields(V& v, StanceSpec& s) {
  v("ground", s.ground,
    Required(Number("m", "point on the ground midway between the feet, in W", Within(100))));
  v("facing", s.facing,
    Required(Number("rad", "direction of view: angle about W's z axis from its x axis",
                    Within(kFullTurn))));
  v("feet_apart", s.feet_apart, Number("m", "distance between the feet", From(0, 1)));
}

template <class V>
void Fields(V& v, OperatorSpec& s) {
  v("type", s.type, Word("who holds the handles", {"virtual", "browser", "person"}));
  v("embodied", s.embodied,
    Flag("whether the virtual operator's reach, stiffness, strength, balance and fatigue follow "
         "from the body and its posture"));
  v("hand", s.hand, Part("model of a hand as a delayed impedance"));
  v("body", s.body, Part("the operator's body; null: not known"));
  v("stance", s.stance, Part("where the operator stands; null: not known"));
  v("script", s.script,
    List(Part("what the virtual operator does, in chronological order"), 0, 1000));
}

}  // namespace predictor
