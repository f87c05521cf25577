// The keys of the console beside real arms. All code that names a key's request derives from this
// table, and so does the reference page of the console.
#pragma once

#include <array>

#include "safety/state_machine.h"

namespace predictor {

struct ConsoleKey {
  char key;
  RunEvent event;    // the event that the key requests
  const char* name;  // of the request, in messages
  bool held;         // the key acts only while it is held; otherwise, a touch makes the request
  std::array<RunState, 2> granted;  // states that show that the request was granted
  const char* meaning;
};

inline constexpr std::array<ConsoleKey, 4> kConsoleKeys = {{
    {'a',
     RunEvent::kAlignRequested,
     "align",
     true,
     {RunState::kAlign, RunState::kAlign},
     "aligns: the real handles move to the virtual ones while no one touches them"},
    {'s',
     RunEvent::kStartRequested,
     "start",
     true,
     {RunState::kRun, RunState::kRun},
     "starts and runs"},
    {'r',
     RunEvent::kRecoverRequested,
     "recover",
     true,
     {RunState::kRecovery, RunState::kRecovery},
     "recovers: joints move back within their limits, links move apart, or a handle moves away "
     "from whatever presses on it"},
    {'z', RunEvent::kReset, "reset", false, {RunState::kIdle, RunState::kSelfTest}, "resets"},
}};
inline constexpr char kCommandKey = ':';  // begins a command. Any other key stops the arms.

}  // namespace predictor
