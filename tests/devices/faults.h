// The faults of the fault model as the bench brings them about: where they go in, what must follow,
// and within which time.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/random.h"
#include "fakes/bench.h"

namespace predictor {

// Two hands' arms and sensors.
struct FaultRig {
  const char* name;
  const char* scenario;
  std::array<const char*, kHands> arms, sensors;  // kinds of fakes; sensor "": the arm's own
};
const std::vector<FaultRig>& FaultRigs();

// What a person must find after a fault.
enum class Expect {
  kGoesOn,
  kWarned,
  kHold,
  kPowerOff,
  kRefused,
  kArmsThemselves,  // they stop without us
  kAnyEnd,          // of a run, or none: as long as it ends well
};

// What carries a fault: a rig without it is passed over.
enum class Carrier { kLoop, kArm, kUr, kFranka, kNetFt, kUrWrench, kFrankaWrench };
// The hands of a rig that have it.
std::vector<int> HandsWith(Carrier carrier, const FaultRig& rig);

// How a run with a fault went. Plain: it comes out of a process of its own.
struct FaultOutcome {
  bool well = true;  // what was expected, and when
  bool ran = false;  // of what may end as it likes: whether it came to RUN
  RunState end = RunState::kInit;
  StopCause cause = StopCause::kNone;
  int ticks = -1;                // from the fault to the decision
  int off = -1;                  // from the fault until power was asked to be cut
  double speed = 0;              // of the faster handle at the fault [m/s]
  double time = 0;               // from the decision until the handles rest [s]
  double distance = 0;           // [m]
  double drift = 0, turn = 0;    // of the handles' relative pose, from then to rest [m], [rad]
  double apart = 0;              // the most that they were apart on the way [m]
  std::array<char, 600> told{};  // what a person is told
  std::array<char, 600> why{};   // what is not as expected

  void Tell(const std::string& text);
  // Not as expected: the first reason counts.
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
  int bound;  // ticks from the fault to the decision, the device's own cycle in it
  // While the run goes on.
  std::function<void(Bench&, int hand)> inject;
  // The handles' relative pose must survive; false where an arm no longer hears us, or stops as it
  // likes.
  bool together = true;
  // What is the matter for a while before that.
  std::function<void(Bench&, int hand)> before = nullptr;
  // Instead of injecting and judging what follows.
  std::function<void(Bench&, int hand, FaultOutcome*)> upon = nullptr;
  // A fault that does not come upon a run: the whole of it. audit: file for what was written.
  std::function<void(const FaultRig&, std::uint64_t seed, const std::string& audit, FaultOutcome*)>
      alone = nullptr;
  // Ticks until power is asked to be cut, where that comes later than the decision to stop.
  int off = 0;
  // By which an arm is later than its loop says [s].
  double lag = 0;

  // How it takes part in pairs, where that is otherwise than by `inject`.
  // A run is begun with it: what it changes of the options and of the bench before.
  std::function<void(const FaultRig&, std::uint64_t seed, BenchOptions*)> options = nullptr;
  std::function<void(Bench&, std::uint64_t seed)> begin = nullptr;
  // The arms recover from it while another comes, instead of running.
  bool recovers = false;
  // The loop is gone from then on: what is done in each millisecond of that instead.
  std::function<std::function<void()>(Bench&)> gone = nullptr;

  bool Begins() const { return options != nullptr || begin != nullptr; }
  // Whether it can come together with another.
  bool Pairs() const { return inject != nullptr || Begins() || gone != nullptr; }

  std::string ToString() const { return std::to_string(number) + " " + name; }
};
const std::vector<Fault>& Faults();

// What a person must be told after a fault that warns or stops: one of these, in the words of its
// cause, and of which hand.
struct FaultWords {
  int number;
  const char* fault;  // how its name begins
  std::vector<const char*> any;
  bool names_hand = true;
};
const std::vector<FaultWords>& AllFaultWords();
// nullptr: nothing is asked for.
const FaultWords* WordsOf(const Fault& fault);

// Whether its Frankas are as slow as the scenario has them: with every other pair of seeds. Else
// they are quick.
bool HasSlowFranka(const FaultRig& rig, std::uint64_t seed);

// As the rig has it. Even seeds move at nearly the handles' cap.
BenchOptions OptionsOf(const FaultRig& rig, std::uint64_t seed);

}  // namespace predictor
