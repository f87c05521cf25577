// Describes the faults of the fault model. For each fault, the description contains the way in
// which the bench injects the fault, the expected result, and the time limit.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/random.h"
#include "fakes/bench.h"

namespace predictor {

// The arms and sensors of both hands.
struct FaultRig {
  const char* name;
  const char* scenario;
  std::array<const char*, kHands> arms, sensors;  // kinds of fakes; sensor "": the arm's
};
const std::vector<FaultRig>& FaultRigs();

// The expected result of a fault.
enum class Expect {
  kContinues,
  kWarned,
  kHold,
  kPowerOff,
  kRefused,
  kArmsThemselves,  // the arms stop on their own
  kAnyEnd,          // any orderly end, with or without a run
};

// The device to which a fault applies. A rig without the device skips the fault.
enum class Carrier { kLoop, kArm, kUr, kFranka, kNetFt, kUrWrench, kFrankaWrench };
// Returns the hands of a rig that have this device.
std::vector<int> HandsWith(Carrier carrier, const FaultRig& rig);

// The result of a run with a fault. The struct is trivially copyable, because a child process sends
// it.
struct FaultOutcome {
  bool well = true;  // the expected result in the expected time
  bool ran = false;  // for kAnyEnd: whether RUN was reached
  RunState end = RunState::kInit;
  StopCause cause = StopCause::kNone;
  int ticks = -1;                   // from the fault to the decision
  int off = -1;                     // from the fault to the power-off request
  double speed = 0;                 // speed of the faster handle at the fault [m/s]
  double time = 0;                  // from the decision until the handles rest [s]
  double distance = 0;              // [m]
  double drift = 0, turn = 0;       // change of the handles' relative pose until rest [m], [rad]
  double apart = 0;                 // largest change of their distance during the stop [m]
  std::array<char, 600> message{};  // the message to a person
  std::array<char, 600> why{};      // the deviation from the expected result

  void SetMessage(const std::string& text);
  // Records a failure. If several failures occur, only the first reason is kept.
  void Fail(const std::string& text);
  void Require(bool good, const std::string& text) {
    if (!good) Fail(text);
  }
};

struct Fault {
  int number;  // in the fault model
  const char* name;
  Carrier carrier;
  Expect expect;
  // maximum number of ticks from the fault to the decision, including the device's cycle
  int bound;
  // Injects the fault into a run.
  std::function<void(Bench&, int hand)> inject;
  // Whether the handles must keep their relative pose. The value is false if an arm no longer
  // receives commands or stops in its own way.
  bool together = true;
  // Creates a condition that lasts for a while before the fault is injected.
  std::function<void(Bench&, int hand)> before = nullptr;
  // This function replaces both the injection and the judgement.
  std::function<void(Bench&, int hand, FaultOutcome*)> upon = nullptr;
  // Performs everything for a fault that shares no run with others. `audit` is the file for the
  // commands.
  std::function<void(const FaultRig&, std::uint64_t seed, const std::string& audit, FaultOutcome*)>
      alone = nullptr;
  // The maximum number of ticks from the fault to the power-off request, if that comes later than
  // the decision to stop.
  int off = 0;
  // Additional lag of an arm beyond its loop's model [s].
  double lag = 0;

  // The following members define how the fault takes part in pairs if `inject` is not enough.
  // If a run begins with the fault, `options` changes the options, and `begin` changes the bench
  // before the start.
  std::function<void(const FaultRig&, std::uint64_t seed, BenchOptions*)> options = nullptr;
  std::function<void(Bench&, std::uint64_t seed)> begin = nullptr;
  // If true, the arms are still recovering from this fault when the other fault occurs, so there is
  // no run.
  bool recovers = false;
  // Is set if the loop no longer exists after this fault. Returns a function that runs every
  // millisecond instead of the loop.
  std::function<std::function<void()>(Bench&)> gone = nullptr;

  bool Begins() const { return options != nullptr || begin != nullptr; }
  // Returns whether this fault can be combined with another.
  bool Pairs() const { return inject != nullptr || Begins() || gone != nullptr; }

  std::string ToString() const { return std::to_string(number) + " " + name; }
};
const std::vector<Fault>& Faults();
// Returns the first fault with this number whose name starts with `beginning`. Throws
// std::logic_error if no fault matches.
Fault* FindFault(std::vector<Fault>* all, int number, const char* beginning);

// One of these texts must appear after a fault that causes a warning or a stop. The texts describe
// the cause of the fault, and the message must also name the hand.
struct FaultWords {
  int number;
  const char* fault;  // beginning of its name
  std::vector<std::string> any;
  bool names_hand = true;
};
const std::vector<FaultWords>& AllFaultWords();
// Returns nullptr if no text is required.
const FaultWords* WordsOf(const Fault& fault);

// Returns whether the Frankas are as slow as in the scenario. Pairs of seeds alternate between slow
// and quick Frankas.
bool HasSlowFranka(const FaultRig& rig, std::uint64_t seed);

// Returns the options for the rig. With even seeds, the handles move almost at their speed limit.
BenchOptions OptionsOf(const FaultRig& rig, std::uint64_t seed);

}  // namespace predictor
