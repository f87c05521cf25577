// Derives messages for the operator at the console of real arms from the records. The functions of
// this file must not be called in the control loop.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/record.h"
#include "safety/console_keys.h"
#include "safety/state_machine.h"

namespace predictor {

class ConsoleWords {
 public:
  // `enabling_device` states whether the operator holds a device instead of a key. `rate` is the
  // tick rate [Hz].
  ConsoleWords(bool enabling_device, double rate)
      : enabling_device_(enabling_device), again_(static_cast<std::uint64_t>(0.6 * rate)) {}

  // Call this once per record, in order. Returns the lines to print (usually none). `trouble`
  // returns the devices' own description of their present fault, or "" if there is none. The
  // function calls `trouble` only if it prints the description.
  std::vector<std::string> See(const TickRecord& record,
                               const std::function<std::string()>& trouble);

 private:
  void AddRefusal(const TickRecord& record, const std::function<std::string()>& trouble);
  void AddWrongTime(const TickRecord& record);
  void AddState(const TickRecord& record, const std::function<std::string()>& trouble);
  void AddFaults(const TickRecord& record, const std::function<std::string()>& trouble);
  bool Granted(const ConsoleKey& key, RunState now) const;
  bool Again(RunEvent event, std::uint64_t tick);
  std::string Possible(const TickRecord& record) const;

  bool enabling_device_;
  std::uint64_t again_;  // maximum time between repeated letters of a held key [ticks]
  RunState state_ = RunState::kInit;
  std::array<bool, kHands> faults_ = {};  // faults in the previous record
  std::array<std::uint64_t, kRunEvents> reported_ =
      {};  // tick after the latest one with that request
  std::vector<std::string> lines_;
};

}  // namespace predictor
