// The keyboard of the operator beside real arms, for the actions that only a person at the rig may
// perform.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "core/held_key.h"
#include "raw_keys.h"
#include "safety/console_keys.h"
#include "safety/state_machine.h"
#include "screen.h"

namespace predictor {

// The arms move only while a key is held. The repeated characters of a held key prove that a hand
// still presses this key. Once it counts as held, it makes its request, and each repetition keeps
// motion enabled.
//   a (held)  align        s (held)  start and run        r (held)  recover
// If the operator holds an enabling device, touching the key makes the request.
//   z (touched) reset      : LINE    a command, as without real arms
// A touch makes its request only once, so a jammed key makes no further requests.
//   any other key: stop; while a command is typed, any key that is not text (Esc)
class RigConsole {
 public:
  // The thread of this object calls `request` to request an event of the run, and calls `line` with
  // each command that the operator typed. If the machine has an `enabling_device`, the operator
  // holds this device instead of a key. Standard input must be a terminal. The destructor restores
  // the settings of this terminal.
  RigConsole(std::function<void(RunEvent)> request, std::function<void(const std::string&)> line,
             bool enabling_device);
  ~RigConsole();
  RigConsole(const RigConsole&) = delete;
  RigConsole& operator=(const RigConsole&) = delete;

  // Returns the number of signs, received so far, that the operator holds a key.
  const std::atomic<std::uint32_t>& enabling() const { return enabling_; }

  const char* Help() const;

 private:
  // A key, and the event that this key requests when it is held or touched.
  struct Asking {
    HeldKey key;
    RunEvent event;
    bool by_touch;
  };
  Asking AskingOf(const ConsoleKey& key) const {
    return {HeldKey(key.key), key.event, enabling_device_ || !key.held};
  }

  void Listen();
  void Key(char key, double now);
  void Type(char key);
  void Hear(Asking* asking, char key, double now);  // key: 0 if no key was pressed
  static void ReportIgnored(const Asking& asking, KeySign sign);

  std::function<void(RunEvent)> request_;
  std::function<void(const std::string&)> line_;
  bool enabling_device_;
  RawKeys keys_{true};
  std::atomic<std::uint32_t> enabling_{0};
  std::atomic<bool> done_{false};
  std::array<Asking, kConsoleKeys.size()> askings_;
  bool typing_ = false;  // a command after a colon
  TypedLine typed_;
  std::thread thread_;
};

}  // namespace predictor
