// Hazards of the cobot's controller.
#include "simulation/hazards/hazards.h"

namespace predictor::hazards {
namespace {

struct SetPointJumpParameters {
  Vector3 xyz = {0, 0, 0.05};  // [m]
  Vector3 rpy = {0, 0, 0};     // rotation vector [rad]
};

template <class V>
void Fields(V& v, SetPointJumpParameters& p) {
  v("xyz", p.xyz, Number("m", "displacement by which the set-point jumps, in W", Within(10)));
  v("rotation", p.rpy,
    Number("rad", "rotation vector by which the set-point turns, in W", Within(3.2)));
}

struct StiffnessStepParameters {
  double translation = 3, rotation = 3;
};

template <class V>
void Fields(V& v, StiffnessStepParameters& p) {
  v("translation_factor", p.translation,
    Number("", "factor of the translational stiffness", From(0, 100)));
  v("rotation_factor", p.rotation, Number("", "factor of the rotational stiffness", From(0, 100)));
}

struct DampingStepParameters {
  double factor = 0.1;
};

template <class V>
void Fields(V& v, DampingStepParameters& p) {
  v("damping_factor", p.factor, Number("", "factor of the damping ratio", From(0, 100)));
}

struct ControlDelayParameters {
  double delay = 0.03;  // [s]
};

template <class V>
void Fields(V& v, ControlDelayParameters& p) {
  v("added_delay", p.delay,
    Number("s", "delay that is added to cobot.control.delay", Above(0, 0.5)));
}

void JumpSetPoint(const SetPointJumpParameters& p, double, Disturbance* d) noexcept {
  d->set_point.head<3>() += p.xyz;
  d->set_point.tail<3>() += p.rpy;
}

void StepStiffness(const StiffnessStepParameters& p, double, Disturbance* d) noexcept {
  d->gains.stiffness_translation *= p.translation;
  d->gains.stiffness_rotation *= p.rotation;
}

void StepDamping(const DampingStepParameters& p, double, Disturbance* d) noexcept {
  d->gains.damping_ratio *= p.factor;
}

void DelayControl(const ControlDelayParameters& p, double, Disturbance* d) noexcept {
  d->delay += p.delay;
}

void FreezeControl(const NoParameters&, double, Disturbance* d) noexcept { d->frozen = true; }

void TakeOver(const NoParameters&, double, Disturbance* d) noexcept { d->standby = true; }

}  // namespace

const HazardKind kSetPointJump = HazardKindOf<SetPointJumpParameters, JumpSetPoint>(
    "set_point_jump", "the controller's set-point jumps", "the set-point jumped",
    HazardNeeds::kSetPoint);

const HazardKind kStiffnessStep = HazardKindOf<StiffnessStepParameters, StepStiffness>(
    "stiffness_step", "the controller's stiffness changes at once", "the stiffness changed",
    HazardNeeds::kSprings);

const HazardKind kDampingStep = HazardKindOf<DampingStepParameters, StepDamping>(
    "damping_step", "the controller's damping changes at once", "the damping changed",
    HazardNeeds::kSprings);

const HazardKind kControlDelay = HazardKindOf<ControlDelayParameters, DelayControl>(
    "control_delay", "the controller's torques act with a longer delay",
    "the controller became slow");

const HazardKind kControlFreeze = HazardKindOf<NoParameters, FreezeControl>(
    "control_freeze", "the controller stops computing, and its last torques continue to act",
    "the controller froze");

const HazardKind kTakeover =
    HazardKindOf<NoParameters, TakeOver>("takeover", "cobot.standby_controller takes over",
                                         "another controller took over", HazardNeeds::kStandby);

}  // namespace predictor::hazards
