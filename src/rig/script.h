// The operator's script as it runs: which actions have begun, which go on.
#pragma once

#include <memory>
#include <vector>

#include "rig/actions.h"
#include "rig/intent.h"
#include "scenario/scenario.h"

namespace predictor {

class Script {
 public:
  // Throws InputError that names the entry and what is wrong with it.
  explicit Script(const std::vector<ActionSpec>& specs);

  void Reset() noexcept;
  // Begins what starts at `run_time` [s] or before and has not begun.
  void Begin(double run_time, Intent* intent) noexcept;
  // One step of dt [s] of all that goes on; pace as in Action::Advance. What needs a hold is given
  // up when no hand holds.
  void Advance(double dt, double pace, Intent* intent) noexcept;
  // Index in the scenario's script of the action that goes on, the last one begun; -1: none.
  int current() const noexcept;
  void Archive(StateArchive& a) noexcept { a(entries_); }

 private:
  struct Entry {
    double start;
    int index;  // in the scenario's script
    std::unique_ptr<Action> action;
    bool begun = false;
    bool active = false;

    void Archive(StateArchive& a) noexcept { a(begun, active, action); }
  };
  std::vector<Entry> entries_;  // in the order of their starts
};

}  // namespace predictor
