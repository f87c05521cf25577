#include "devices/fault_bring.h"

#include <algorithm>
#include <cctype>

#include "core/format.h"
#include "core/words.h"
#include "devices/audit.h"
#include "emulator/stop_reach.h"

namespace predictor {
namespace {

constexpr double kSoon = 0.100;     // longest delay from the first to the second fault [s]
constexpr double kLongestStop = 1;  // [s]
constexpr double kRest = 2e-3;      // speed below which a handle is at rest [m/s]
constexpr double kDegrees = 57.29577951;
constexpr double kBefore = 0.05;  // audited time before a fault [s]

// The limits of a stop are literals, so that the judgement does not depend on the program's own
// prediction. The first limit applies to quick arms. This limit is the sum of the documented limit
// at 0.25 m/s, the 30 ms for which one arm follows the other, and the lag (10 ms, or 120 ms for a
// Franka's impedance control). The second limit applies to a Franka with a bandwidth of 15 Hz.
constexpr StopBudget kMaxStop{0.240, 0.0134 + 0.25 * 0.040}, kMaxSlowStop{0.260, 0.037};
constexpr double kMaxDrift = 0.002, kMaxTurn = 0.5 / kDegrees;

double Speed(Bench& bench) {
  double speed = 0;
  for (const FrameMotion& handle : bench.rig().rig().true_handles())
    speed = std::max(speed, handle.V_W.head<3>().norm());
  return speed;
}

int AnyHand(const Fault& fault, const FaultRig& rig, RandomStream* random) {
  const std::vector<int> hands = HandsWith(fault.carrier, rig);
  return hands[random->Next() % hands.size()];
}

bool Continues(const Fault& fault) {
  return fault.expect == Expect::kContinues || fault.expect == Expect::kWarned;
}

StopBudget MaxStopOf(const Bench& bench, const Fault& fault, const FaultRig& rig,
                     std::uint64_t seed) {
  Scenario s = bench.scenario();
  for (std::optional<ArmSpec>* arm : {&s.device.left, &s.device.right})
    (*arm)->loop.delay += fault.lag;
  StopBudget most = StopOfArms(s);
  if (fault.lag > 0) return most;
  const StopBudget cap = HasSlowFranka(rig, seed) ? kMaxSlowStop : kMaxStop;
  return {std::min(most.time, cap.time), std::min(most.way, cap.way)};
}

bool Warns(const Bench& bench) {
  return (bench.record().hands[0].warnings | bench.record().hands[1].warnings) != 0;
}

void JudgeContinuing(const Bench& bench, const Fault& fault, FaultOutcome* o) {
  o->Require(o->end == RunState::kRun, "stops: " + Messages(bench));
  if (fault.expect == Expect::kWarned) o->Require(Warns(bench), "shows no warning");
  if (fault.expect == Expect::kContinues) o->Require(!Warns(bench), "warns: " + Messages(bench));
}

}  // namespace

std::string Messages(const Bench& bench) {
  const TickRecord& record = bench.record();
  std::string reported;
  const auto add = [&reported](const std::string& words) {
    if (!reported.empty() && !words.empty()) reported += " ";
    reported += words;
  };
  add(StopCauseWords(record));
  add(StopAdvice(record));
  for (std::size_t hand = 0; hand < kHands; ++hand)
    for (const std::string& words : NewWarnings(0, record.hands[hand], hand)) add(words);
  add(bench.device().Trouble());
  return reported;
}

void Take(const BenchStop& stop, FaultOutcome* outcome) {
  outcome->end = stop.end;
  outcome->cause = stop.cause;
  outcome->ticks = stop.ticks;
  outcome->off = stop.off;
  outcome->time = stop.time;
  outcome->distance = stop.distance;
  outcome->drift = stop.drift;
  outcome->turn = stop.turn;
  outcome->apart = stop.apart;
}

void JudgeMessage(const Fault& fault, int hand, FaultOutcome* o) {
  const FaultWords* words = WordsOf(fault);
  if (words == nullptr) return o->Fail("FaultWords has no entry for this fault");
  const std::string reported = o->message.data();
  o->Require(!reported.empty(), "shows no message");
  o->Require(std::any_of(
                 words->any.begin(), words->any.end(),
                 [&](const std::string& text) { return reported.find(text) != std::string::npos; }),
             "the message does not describe the cause: " + reported);
  if (!words->names_hand) return;
  // The text may have the form "Left hand: ..." or "... of the left sensor's readings ...".
  std::string text = reported;
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto place = [&text](const std::string& name) { return text.find(name + " "); };
  const auto right = static_cast<std::size_t>(hand), wrong = 1 - right;
  o->Require(place(kHandNames[right]) < place(kHandNames[wrong]),
             std::string("does not name the ") + kHandNames[right] + " hand: " + reported);
}

void JudgeReach(const StopBudget& most, FaultOutcome* o) {
  o->Require(o->time <= most.time, Formatted("rests after %.0f ms", 1e3 * o->time));
  o->Require(o->distance <= most.way, Formatted("continues for %.1f mm", 1e3 * o->distance));
}

void JudgeStop(const Fault& fault, const StopBudget& most, FaultOutcome* o) {
  const RunState end = fault.expect == Expect::kHold ? RunState::kHeld : RunState::kUnpowered;
  o->Require(o->end == end, std::string("ends ") + Name(o->end) + " instead of " + Name(end) +
                                ", cause " + Name(o->cause));
  o->Require(o->ticks >= 0 && o->ticks <= fault.bound,
             Formatted("detected after %d ticks, %d allowed", o->ticks, fault.bound));
  if (fault.expect == Expect::kPowerOff) {
    const int latest = std::max(fault.bound, fault.off);
    o->Require(o->off >= 0 && o->off <= latest,
               Formatted("requests power-off after %d ticks, %d allowed", o->off, latest));
  }
  JudgeReach(most, o);
  if (!fault.together) return;
  o->Require(o->drift <= kMaxDrift,
             Formatted("the relative position of the handles changes by %.2f mm", 1e3 * o->drift));
  o->Require(
      o->turn <= kMaxTurn,
      Formatted("the relative orientation of the handles changes by %.2f deg", kDegrees * o->turn));
}

void JudgeRest(Bench& bench, FaultOutcome* o) {
  bench.Pass(0.1);
  bench.rig().Mark();
  bench.Pass(0.3);
  const double fastest = bench.rig().motion().moving;
  o->Require(fastest < kRest, Formatted("moves at %.1f mm/s after the stop", 1e3 * fastest));
}

FaultOutcome Bring(Bench& bench, const Fault& fault, const FaultRig& rig, std::uint64_t seed,
                   const std::string& audit) {
  RandomStream random(seed, fault.name);
  FaultOutcome outcome;
  const int hand = AnyHand(fault, rig, &random);
  bench.Forget(kBefore);
  if (fault.before) fault.before(bench, hand);
  outcome.speed = Speed(bench);
  if (fault.upon) {
    fault.upon(bench, hand, &outcome);
    AppendForAudit(audit, fault, seed, rig, bench, {});
    return outcome;
  }
  const std::uint64_t tick = bench.record().tick;
  fault.inject(bench, hand);
  const double patience = fault.expect == Expect::kContinues ? 0.5 : 1.5;
  const BenchStop stop = bench.AwaitStop(tick, patience);
  Take(stop, &outcome);
  outcome.SetMessage(Messages(bench));
  if (fault.expect != Expect::kContinues) JudgeMessage(fault, hand, &outcome);
  if (Continues(fault)) {
    JudgeContinuing(bench, fault, &outcome);
  } else {
    JudgeStop(fault, MaxStopOf(bench, fault, rig, seed), &outcome);
    JudgeRest(bench, &outcome);
  }
  AppendForAudit(audit, fault, seed, rig, bench, stop);
  return outcome;
}

namespace {

// Lets time pass for the devices without running the loop.
void PassWithoutLoop(Bench& bench, double time, const std::function<void()>& each) {
  for (int n = static_cast<int>(1e3 * time); n > 0; --n) {
    if (each) each();
    bench.Hang(0.001);
  }
}

void JudgeRestWithoutLoop(Bench& bench, const std::function<void()>& each, FaultOutcome* o) {
  constexpr double kToRest = 0.4, kResting = 0.3;  // [s]
  PassWithoutLoop(bench, kToRest, each);
  bench.rig().Mark();
  PassWithoutLoop(bench, kResting, each);
  const double fastest = bench.rig().motion().moving;
  o->Require(fastest < kRest, Formatted("moves at %.1f mm/s without the loop", 1e3 * fastest));
}

// Returns whether a run may end in this state even if the arms do not rest after a stop.
bool MayEnd(RunState end, const Fault& first, const Fault& second) {
  const auto lets_continue = [](const Fault& f) { return f.Begins() || Continues(f); };
  if (end == RunState::kRun) return lets_continue(first) && lets_continue(second);
  // While the arms recover, the emulation does not run.
  if (end == RunState::kRecovery)
    return (first.recovers || second.recovers) &&
           (lets_continue(second) || second.carrier == Carrier::kLoop);
  return end == RunState::kIdle && first.Begins();  // it never ran
}

void JudgeBoth(Bench& bench, const Fault& first, const Fault& second, FaultOutcome* o) {
  o->SetMessage(Messages(bench));
  const bool held = o->end == RunState::kHeld || o->end == RunState::kUnpowered;
  o->Require(!held || o->message[0] != 0, "shows no message");
  o->Require(held || MayEnd(o->end, first, second), std::string("ends ") + Name(o->end));
  if (held || o->end == RunState::kIdle) JudgeRest(bench, o);
  // The second fault may be detected only after the first fault's stop has come to rest.
  if (held) o->end = bench.emulator().state();
  const bool must_not_hold =
      first.expect == Expect::kPowerOff || second.expect == Expect::kPowerOff;
  o->Require(!must_not_hold || o->end != RunState::kHeld,
             "holds the arms, which the most severe fault forbids");
}

}  // namespace

FaultOutcome BringBoth(Bench& bench, const Fault& first, const Fault& second, const FaultRig& rig,
                       std::uint64_t seed, const std::string& audit) {
  const std::string name = first.ToString() + ", then " + second.ToString();
  RandomStream random(seed, name);
  FaultOutcome outcome;
  bench.Forget(kBefore);
  outcome.speed = Speed(bench);
  const std::uint64_t tick = bench.record().tick;
  BenchStop stop;
  std::function<void()> each;
  const auto bring = [&](const Fault& fault) {
    if (!fault.inject) return;
    const int hand = AnyHand(fault, rig, &random);
    if (fault.before) fault.before(bench, hand);
    fault.inject(bench, hand);
  };
  bring(first);
  if (first.gone) each = first.gone(bench);
  const double soon = kSoon * random.Uniform();
  if (first.gone)
    PassWithoutLoop(bench, soon, each);
  else if (!first.Begins())
    bench.Pass(soon);
  bring(second);
  if (second.gone) each = second.gone(bench);
  if (first.gone || second.gone) {
    stop = bench.AwaitStop(tick, 0);  // the part of the stop that the loop began
    JudgeRestWithoutLoop(bench, each, &outcome);
  } else {
    stop = bench.AwaitStop(tick, 1.5);
    if (bench.emulator().state() == RunState::kStopping)  // the stop has just begun
      stop = bench.AwaitStop(tick, kLongestStop);
    Take(stop, &outcome);
    JudgeBoth(bench, first, second, &outcome);
  }
  AppendForAudit(audit, name, rig, bench, stop);
  return outcome;
}

}  // namespace predictor
