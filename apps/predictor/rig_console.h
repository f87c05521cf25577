// The keyboard of the person beside real arms: what only somebody at the rig may do.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "raw_keys.h"
#include "safety/state_machine.h"
#include "screen.h"

namespace predictor {

// Keys that are held move the arms, as long as they are held: a key that repeats is a hand on it.
// The terminal sends a held key's letter again and again; its second letter within kFirstRepeat
// asks for what the key stands for, and each one keeps enabling.
//   a (held)  align        s (held)  start and run        r (held)  recover
// Where an enabling device is held instead, a touch of the key asks.
//   z         reset        : LINE    a command, as without real arms
//   any other key: stop; while a command is typed, any that is no part of it (Esc)
class RigConsole {
 public:
  static constexpr double kFirstRepeat = 0.8;  // before a terminal repeats a key [s]

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
  void Listen();
  void Key(char key, double now);
  void Held(char key, RunEvent event, double now);
  void Type(char key);
  void TellTouch(double now);

  std::function<void(RunEvent)> request_;
  std::function<void(const std::string&)> line_;
  bool enabling_device_;
  RawKeys keys_;
  std::atomic<std::uint32_t> enabling_{0};
  std::atomic<bool> done_{false};
  char held_ = 0;         // the key whose letter came last
  double since_ = 0;      // of that letter [s]
  bool repeats_ = false;  // it has come at least twice
  bool told_ = false;     // that it was touched only
  bool typing_ = false;   // after a colon
  TypedLine typed_;
  std::thread thread_;
};

}  // namespace predictor
