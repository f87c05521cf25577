// Deliberate hazards. The page docs/how-to/hazards.md explains how scenarios use them. To add a
// hazard, write a struct of parameters, a function that writes a Disturbance, and a line in
// hazards.h.
#pragma once

#include "scenario/own_parameters.h"
#include "simulation/disturbance.h"

namespace predictor {

// The requirement of a hazard. It is a part of the cobot without which the hazard would have no
// effect, an attachment that can slip (kSlipping), or an effect that lasts until the end of the run
// (kNoEnd). Commands to the gripper have no end either (kRelease), and a command to grasp needs
// another event that releases the object (kGrasp). With kFixture, the hazard's parameter `fixture`
// names one of environment.fixtures. With kMovable, the hazard's parameter `object` names one of
// environment.objects. With kPickUp, another event must pick up a movable object. Hazards with
// kMovable or kPickUp have no end either.
enum class HazardNeeds {
  kNothing,
  kWristSensor,
  kSetPoint,
  kSprings,
  kStandby,
  kSlipping,
  kNoEnd,
  kRelease,
  kGrasp,
  kFixture,
  kMovable,
  kPickUp
};

// The registry's description of a hazard. The sentence states what happens, for use in a report
// ("the brakes close").
struct HazardKind : ParameterKind {
  const char* sentence;
  HazardNeeds needs;
  // Adds the effect of the hazard to the disturbance, at the time `elapsed` [s] after the hazard
  // began. Does not use the heap or throw.
  void (*disturb)(const OwnParameters&, double elapsed, Disturbance*) noexcept;
};

// Returns the kind of a hazard with parameters P. `name` is the NAME that a scenario uses in
// events: {event: NAME}.
template <class P, void (*disturb)(const P&, double, Disturbance*) noexcept>
constexpr HazardKind HazardKindOf(const char* name, const char* doc, const char* sentence,
                                  HazardNeeds needs = HazardNeeds::kNothing) {
  return {{name, doc, NewParameters<P>},
          sentence,
          needs,
          [](const OwnParameters& own, double elapsed, Disturbance* d) noexcept {
            disturb(ValueOf<P>(own), elapsed, d);
          }};
}

// Returns null for an unknown name.
const HazardKind* FindHazard(const std::string& name) noexcept;

}  // namespace predictor
