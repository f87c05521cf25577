// What the person at the console of real arms is told of a run, record by record. Not for the tick.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/record.h"
#include "safety/state_machine.h"

namespace predictor {

class ConsoleWords {
 public:
  // What a person asks for: by which key, and the states that say that it was granted.
  struct Request {
    RunEvent event;
    char key;
    const char* name;
    std::array<RunState, 2> granted;
  };

  // enabling_device: what a person holds is not a key. rate: of ticks [Hz].
  ConsoleWords(bool enabling_device, double rate)
      : enabling_device_(enabling_device), again_(static_cast<std::uint64_t>(0.6 * rate)) {}

  // Of each record, in order: sentences, a line each; mostly none. trouble: what the devices
  // themselves say is wrong now, "" if nothing; asked only where it is told.
  std::vector<std::string> See(const TickRecord& record,
                               const std::function<std::string()>& trouble);

 private:
  void TellRefusal(const TickRecord& record, const std::function<std::string()>& trouble);
  void TellWrongTime(const TickRecord& record);
  void TellState(const TickRecord& record, const std::function<std::string()>& trouble);
  void TellFaults(const TickRecord& record, const std::function<std::string()>& trouble);
  bool Granted(const Request& request, RunState now) const;
  bool Again(RunEvent event, std::uint64_t tick);
  std::string Possible(const TickRecord& record) const;

  bool enabling_device_;
  std::uint64_t again_;  // in which a key that is held has sent its next letter [ticks]
  RunState state_ = RunState::kInit;
  std::array<bool, kHands> faults_ = {};             // of the record before
  std::array<std::uint64_t, kRunEvents> told_ = {};  // tick after the last one with that request
  std::vector<std::string> lines_;
};

}  // namespace predictor
