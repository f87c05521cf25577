// The actions of the operator's script. To add one, see docs/developer/add-an-action.md.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/archive.h"
#include "scenario/actions/intent.h"
#include "scenario/scenario.h"

namespace predictor {

// One entry of the script as the virtual operator performs it. Actions that overlap in time are
// added, like the submovements of an arm (Flash & Henis 1991).
class Action {
 public:
  virtual ~Action() = default;
  // Called at its start, and when the script starts again. No heap and no exception, here and in
  // the functions below.
  virtual void Begin(Intent* intent) noexcept = 0;
  // One step of dt [s]. `pace`: speed of the operator, 1 on average. Returns false when the action
  // ends.
  virtual bool Advance(double dt, double pace, Intent* intent) noexcept = 0;
  // True if the action moves the object. It then ends as soon as no hand holds the object.
  virtual bool NeedsHold() const noexcept { return false; }
  // Saves or loads its progress.
  virtual void Archive(StateArchive& a) noexcept = 0;
};

// A key that an action uses. Every entry also has `action` and `start`.
struct ActionParameter {
  const char* key = nullptr;
  bool required = false;
};

// Two actions of the same kind of motion may not overlap in time.
enum class ActionMotion { kNone, kMoves, kTurns };

// The registry's description of an action.
struct ActionKind {
  const char* name;                           // operator.script: {action: NAME}
  std::array<ActionParameter, 6> uses = {};   // every other parameter is refused
  ActionMotion motion = ActionMotion::kNone;  // motion of the object
  // The instruction to a person. `facing`: 1 if the person's forward is +x of W, −1 if −x.
  std::string (*sentence)(const ActionSpec&, int facing);
  std::unique_ptr<Action> (*make)(const ActionSpec&);  // throws InputError
  // Time from start to end at an average pace [s]; null: `duration`.
  double (*time)(const ActionSpec&) noexcept = nullptr;

  bool Uses(const std::string& key) const;
};

// All actions, sorted by name.
std::span<const ActionKind* const> Actions();
std::vector<std::string> ActionNames();
// Returns null for an unknown name.
const ActionKind* FindAction(const std::string& name) noexcept;

// The action of entry number `index` of a script. Throws InputError that names the entry and the
// error in it.
std::unique_ptr<Action> MakeAction(const ActionSpec& spec, int index);

// The instruction to a person at the handles, for example "Grip the handles."
std::string Instruction(const ActionSpec& action, int facing);

// True if the action of the left hand, the right hand (0, 1) or both concerns this hand.
bool Concerns(const ActionSpec& spec, std::size_t hand);

}  // namespace predictor
