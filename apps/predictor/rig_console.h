// The keyboard of the person beside real arms: what only somebody at the rig may do.
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

// Keys that are held move the arms, as long as they are held: a key that repeats is a hand on it.
// Once it is held it asks for what it stands for, and each letter keeps enabling.
//   a (held)  align        s (held)  start and run        r (held)  recover
// Where an enabling device is held instead, a touch of the key asks.
//   z (touched) reset      : LINE    a command, as without real arms
// What a touch asks for it asks for once: a key that is jammed asks no more.
//   any other key: stop; while a command is typed, any that is no part of it (Esc)
class RigConsole {
 public:
  // request: asks the run for an event, from this object's thread. line: a command was typed.
  // Standard input must be a terminal; it is put back at the end.
  // enabling_device: what a person holds is not a key.
  RigConsole(std::function<void(RunEvent)> request, std::function<void(const std::string&)> line,
             bool enabling_device);
  ~RigConsole();
  RigConsole(const RigConsole&) = delete;
  RigConsole& operator=(const RigConsole&) = delete;

  // Counts the signs that a key is held.
  const std::atomic<std::uint32_t>& enabling() const { return enabling_; }

  const char* Help() const;

 private:
  // A key, and what it asks for when it is held or touched.
  struct Asking {
    HeldKey key;
    RunEvent event;
    bool by_touch;
  };

  void Listen();
  void Key(char key, double now);
  void Type(char key);
  void Hear(Asking* asking, char key, double now);  // key: 0 for none
  static void Tell(const Asking& asking, KeySign sign);

  std::function<void(RunEvent)> request_;
  std::function<void(const std::string&)> line_;
  bool enabling_device_;
  RawKeys keys_{true};
  std::atomic<std::uint32_t> enabling_{0};
  std::atomic<bool> done_{false};
  std::array<Asking, 4> askings_;
  bool typing_ = false;  // after a colon
  TypedLine typed_;
  std::thread thread_;
};

}  // namespace predictor
