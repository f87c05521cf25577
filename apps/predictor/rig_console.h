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
#include "safety/state_machine.h"
#include "screen.h"

namespace predictor {

// The arms move only while a key is held. A repeating key proves that a hand presses it. Once it
// counts as held, it makes its request, and each repetition keeps motion enabled.
//   a (held)  align        s (held)  start and run        r (held)  recover
// If the operator holds an enabling device, touching the key makes the request.
//   z (touched) reset      : LINE    a command, as without real arms
// A touch makes its request only once, so a jammed key makes no further requests.
//   any other key: stop; while a command is typed, any key that is not text (Esc)
class RigConsole {
 public:
  // This object's thread calls `request` to request an event of the run, and `line` with each typed
  // command. With an `enabling_device`, the operator holds this device instead of a key. Standard
  // input must be a terminal; the destructor restores its settings.
  RigConsole(std::function<void(RunEvent)> request, std::function<void(const std::string&)> line,
             bool enabling_device);
  ~RigConsole();
  RigConsole(const RigConsole&) = delete;
  RigConsole& operator=(const RigConsole&) = delete;

  // Returns how many signs of a held key this object has received so far.
  const std::atomic<std::uint32_t>& enabling() const { return enabling_; }

  const char* Help() const;

 private:
  // A key, and the event that this key requests when it is held or touched.
  struct Asking {
    HeldKey key;
    RunEvent event;
    bool by_touch;
  };

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
  std::array<Asking, 4> askings_;
  bool typing_ = false;  // a command after a colon
  TypedLine typed_;
  std::thread thread_;
};

}  // namespace predictor
