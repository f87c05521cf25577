// The actions of the operator's script. docs/developer/add-an-action.md explains how to add an
// action.
#pragma once

#include <memory>
#include <string>

#include "core/archive.h"
#include "scenario/actions/intent.h"
#include "scenario/own_parameters.h"
#include "scenario/scenario.h"

namespace predictor {

// An entry of the script that the virtual operator performs. The motions of actions that overlap in
// time are added, like the submovements of an arm (Flash & Henis 1991).
class Action {
 public:
  virtual ~Action() = default;
  // The operator calls this function when the action starts, and when the script starts again. This
  // function and the following ones do not use the heap and do not throw.
  virtual void Begin(Intent* intent) noexcept = 0;
  // Advances by dt [s]. `pace` is the speed of the operator, where 1 is the average. Returns false
  // when the action ends.
  virtual bool Advance(double dt, double pace, Intent* intent) noexcept = 0;
  // Returns whether the action moves the object. An action that moves the object ends as soon as no
  // hand holds the object.
  virtual bool NeedsHold() const noexcept { return false; }
  // Saves or loads the progress of the action.
  virtual void Archive(StateArchive& a) noexcept = 0;
};

// The kind of the motion that an action performs. Two actions with the same kind of motion may not
// overlap in time.
enum class ActionMotion { kNone, kMoves, kTurns };

// The registry's description of an action.
struct ActionKind : ParameterKind {
  ActionMotion motion;  // motion of the object
  // Returns the instruction to a person. `facing` is the direction of view, about z of W from x
  // [rad].
  std::string (*sentence)(const OwnParameters&, double facing);
  double (*time)(const OwnParameters&);                   // duration at an average pace [s]
  std::unique_ptr<Action> (*make)(const OwnParameters&);  // throws InputError
};

// Returns the kind of an action A whose constructor takes its parameters P. `name` is the word in
// operator.script: {action: NAME}. A::Sentence(P, facing) returns the action's instruction to the
// person. A::Time(P) returns the time that the action takes. For an action without this function,
// this time is P::duration.
template <class A, class P>
constexpr ActionKind ActionKindOf(const char* name, const char* doc,
                                  ActionMotion motion = ActionMotion::kNone) {
  return {{name, doc, NewParameters<P>},
          motion,
          [](const OwnParameters& own, double facing) -> std::string {
            return A::Sentence(ValueOf<P>(own), facing);
          },
          [](const OwnParameters& own) -> double {
            const P& parameters = ValueOf<P>(own);
            if constexpr (requires { A::Time(parameters); }) {
              return A::Time(parameters);
            } else {
              return parameters.duration;
            }
          },
          [](const OwnParameters& own) -> std::unique_ptr<Action> {
            return std::make_unique<A>(ValueOf<P>(own));
          }};
}

// The rules for parameters that several actions share.
inline Rule DurationRule(const char* doc = "duration of the action") {
  return Number("s", doc, Above(0, 86400));
}
inline Rule HandRule() { return Word("hand or hands that act", {"left", "right", "both"}); }
// Returns a parameter that must not be zero, because the action would do nothing without it. Throws
// InputError if the parameter is zero.
Vector3 NotZero(const char* key, const Vector3& value);
// Returns whether the word ("left", "right" or "both") includes this hand.
bool Concerns(const std::string& which, std::size_t hand);

// Returns all actions, sorted by name.
ParameterKinds Actions() noexcept;
// Returns null for an unknown name.
const ActionKind* FindAction(const std::string& name) noexcept;

// Returns the action of entry number `index` of a script. Throws InputError that names the entry
// and the error in it.
std::unique_ptr<Action> MakeAction(const ActionSpec& spec, int index);

// Returns the parameters of an entry of this kind. A parameter with an invalid value gets its
// default value.
std::unique_ptr<OwnParameters> ParametersIn(const ActionSpec& spec, const ActionKind& kind);

// Returns the instruction to a person at the handles, for example "Grip the handles."
std::string Instruction(const ActionSpec& spec, double facing);

}  // namespace predictor
