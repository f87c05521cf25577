// What a virtual operator can do. To add an action, see docs/add-an-action.md.
#pragma once

#include <memory>

#include "core/archive.h"
#include "rig/intent.h"
#include "scenario/scenario.h"

namespace predictor {

// One entry of the script. Actions that overlap in time add up, as submovements of an arm do
// (Flash & Henis 1991).
class Action {
 public:
  virtual ~Action() = default;
  // At its start; also when the script starts anew.
  virtual void Begin(Intent* intent) noexcept = 0;
  // One step of dt [s]. `pace`: how fast the person is now, 1 on average. False: it is over.
  virtual bool Advance(double dt, double pace, Intent* intent) noexcept = 0;
  // Moves the object, so it is given up when no hand holds any more.
  virtual bool NeedsHold() const noexcept { return false; }
  // How far it has come.
  virtual void Archive(StateArchive& a) noexcept = 0;
};

// The action of a script's entry number `index`. Throws InputError that names the entry and what
// is wrong with it.
std::unique_ptr<Action> MakeAction(const ActionSpec& spec, int index);

// Minimum jerk (Flash & Hogan 1985): way s(x) = 10x³ − 15x⁴ + 6x⁵ from 0 to 1 over x in [0, 1],
// constant outside, and ds/dx, at most 1.875.
double MinimumJerk(double x);
double MinimumJerkRate(double x);

}  // namespace predictor
