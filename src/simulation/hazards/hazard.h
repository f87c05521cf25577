// Deliberate hazards. docs/how-to/hazards.md explains how scenarios use them. To add one, write a
// struct of parameters, a function that writes a Disturbance, and a line in hazards.h.
#pragma once

#include "scenario/own_parameters.h"
#include "simulation/disturbance.h"

namespace predictor {

// What a hazard needs: a part of the cobot without which it would have no effect, an attachment
// that can slip (kSlipping), or that it lasts until the end (kNoEnd). Commands to the gripper have
// no end either (kRelease), and one to grasp needs another event that releases the object (kGrasp).
// kFixture: its parameter `fixture` names one of environment.fixtures.
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
  kFixture
};

// The registry's description of a hazard. The sentence states what happens, for a report ("the
// brakes close").
struct HazardKind : ParameterKind {
  const char* sentence;
  HazardNeeds needs;
  // Adds the hazard to the disturbance, `elapsed` [s] after it began. Does not use the heap or
  // throw.
  void (*disturb)(const OwnParameters&, double elapsed, Disturbance*) noexcept;
};

// Returns the kind of a hazard with parameters P. `name` is that of events: {event: NAME}.
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
