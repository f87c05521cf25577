// The operator's script during a run. The script keeps account of the actions that have begun and
// of the active actions.
#pragma once

#include <memory>
#include <vector>

#include "scenario/actions/action.h"
#include "scenario/scenario.h"

namespace predictor {

class Script {
 public:
  // Throws InputError that names the entry and describes its error.
  explicit Script(const std::vector<ActionSpec>& specs);

  void Reset() noexcept;
  // Begins all actions that are due at `run_time` [s] and have not begun yet.
  void Begin(double run_time, Intent* intent) noexcept;
  // Advances all active actions by dt [s]. `pace` has the same meaning as in Action::Advance.
  // Actions that move the object are abandoned when no hand holds the object.
  void Advance(double dt, double pace, Intent* intent) noexcept;
  // Returns the index in the scenario's script of the active action that began last, or -1 for
  // none.
  int current() const noexcept;
  void Archive(StateArchive& a) noexcept { a(entries_); }

 private:
  struct Entry {
    double start;
    int index;  // index in the scenario's script
    std::unique_ptr<Action> action;
    bool begun = false;
    bool active = false;

    void Archive(StateArchive& a) noexcept { a(begun, active, action); }
  };
  std::vector<Entry> entries_;  // entries in the order of their start times
};

}  // namespace predictor
