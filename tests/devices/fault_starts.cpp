#include "devices/fault_starts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "commissioning/push_test.h"
#include "core/error.h"
#include "core/format.h"
#include "core/words.h"
#include "devices/audit.h"
#include "devices/fault_bring.h"
#include "safety/warnings.h"

namespace predictor {
namespace {

using enum Carrier;
using enum Expect;

constexpr double kMaxRecoverySpeed = 0.050;  // [m/s]

std::size_t Index(int hand) { return static_cast<std::size_t>(hand); }

// Returns the error when the bench connects, or "" if it succeeds.
std::string WhyNot(const BenchOptions& options) {
  try {
    const Bench bench(options);
    return "";
  } catch (const DeviceError& error) {
    return error.what();
  } catch (const InputError& error) {
    return error.what();
  }
}

void UnknownVersion(Carrier carrier, const char* option, const char* version, const char* word,
                    const FaultRig& rig, std::uint64_t seed, FaultOutcome* o) {
  BenchOptions options = OptionsOf(rig, seed);
  const std::vector<int> hands = HandsWith(carrier, rig);
  options.arm_options[Index(hands[seed % hands.size()])][option] = version;
  const std::string why = WhyNot(options);
  o->SetMessage(why);
  o->Require(!why.empty(), "connects");
  o->Require(why.find(word) != std::string::npos, "the message does not name the error: " + why);
}

// The sequence numbers start so that they wrap around during the run.
void BeginBeforeWrap(const FaultRig&, std::uint64_t seed, BenchOptions* options) {
  RandomStream random(seed, "wrap");
  const auto before = static_cast<std::uint64_t>(6000 + 2000 * random.Uniform());
  for (std::size_t i = 0; i < kHands; ++i) {
    options->sensor_options[i]["first"] = std::to_string((1ULL << 32U) - before);
    if (options->arms[i] == "franka") options->arm_options[i]["first"] = std::to_string(-before);
  }
}

void SequencesWrap(const FaultRig& rig, std::uint64_t seed, FaultOutcome* o) {
  BenchOptions options = OptionsOf(rig, seed);
  BeginBeforeWrap(rig, seed, &options);
  Bench bench(options);
  if (!bench.Start()) return o->Fail("no run: " + Messages(bench));
  bench.Pass(5);
  o->end = bench.emulator().state();
  o->Require(o->end == RunState::kRun, "stops: " + Messages(bench));
  o->Require((bench.record().hands[0].warnings | bench.record().hands[1].warnings) == 0,
             "warns: " + Messages(bench));
  for (const int hand : HandsWith(kNetFt, rig))
    o->Require(bench.record().hands[Index(hand)].sensor_sequence > 0, "no readings");
}

// Draws a drift of the force bias of 2 to 12 N per minute.
Wrench DriftRate(RandomStream* random) {
  const double rate = 2.2 + 10 * random->Uniform();  // [N/min]
  Vector3 direction(random->Normal(), random->Normal(), random->Normal());
  Wrench F = Wrench::Zero();
  F.head<3>() = rate / 60 * direction.normalized();
  return F;
}

// The bias drifts while no hand is near until a handle reads more than 5 N.
void SensorDrifts(const FaultRig& rig, std::uint64_t seed, const std::string&, const Fault& fault,
                  FaultOutcome* o) {
  RandomStream random(seed, "drift");
  Bench bench(OptionsOf(rig, seed));
  if (!bench.Await(RunState::kIdle, 2)) return o->Fail("not idle");
  bench.Pass(2 * Warnings::kDriftTime + 0.1);
  const auto hand = static_cast<int>(random.Next() % kHands);
  const auto warned = [&] { return Has(bench.record().hands[Index(hand)], Warning::kBiasDrift); };
  o->Require(!warned(), "a warning appears without a drift");
  const Wrench rate = DriftRate(&random);
  bench.rig().Drift(hand, rate);
  for (int k = 0; k < 20'000 && !warned(); ++k) {
    bench.Tick();
    o->ticks = k;
  }
  o->SetMessage(Messages(bench));
  o->Require(warned(), "shows no warning");
  JudgeMessage(fault, hand, o);
  bench.rig().Drift(hand, Wrench::Zero());
  bench.rig().Disturb(hand, JointVector(), Wrench(6.5 * rate.normalized()));
  bench.Hold(true);
  bench.Pass(0.3);
  bench.emulator().Request(RunEvent::kAlignRequested);
  bench.Tick();
  o->end = bench.emulator().state();
  o->Require(static_cast<Refusal>(bench.record().why_refused) == Refusal::kNotFree,
             std::string("ALIGN was not refused: ") + Name(o->end));
}

// Returns an incorrect mounting: depending on the seed, the axes are rotated, swapped or mirrored.
Matrix3 Mounting(std::uint64_t seed) {
  std::vector<Matrix3> all;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (unsigned signs = 0; signs < 8; ++signs) {
      Matrix3 R = Matrix3::Zero();
      for (int i = 0; i < 3; ++i) R(order[Index(i)], i) = (signs >> Index(i) & 1U) != 0 ? -1 : 1;
      if (!R.isIdentity()) all.push_back(R);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all[seed % all.size()];
}

// A person pushes as instructed, but the sensor is mounted incorrectly.
void PushesAreRefused(const FaultRig& rig, std::uint64_t seed, FaultOutcome* o) {
  Bench bench(OptionsOf(rig, seed));
  const auto hand = static_cast<int>(seed % kHands);
  bench.rig().Wire(hand, Mounting(seed));
  if (!bench.Await(RunState::kIdle, 2)) return o->Fail("not idle: " + Messages(bench));
  const auto wrench = [&](int h) {
    return Wrench(Eigen::Map<const Vector6>(bench.record().hands[Index(h)].wrench.data()));
  };
  commissioning::PushTest test;
  commissioning::PushTest::Hint hint{};  // in the middle of a push
  for (int k = 0; k < 6000 && !test.done(); ++k) {
    const bool pushes = k % 1500 > 500 && !test.done();
    bench.rig().Press(hand, pushes ? Vector3(12 * Vector3::Unit(test.axis())) : Vector3::Zero());
    bench.Tick();
    test.Update(wrench(hand), wrench(1 - hand), 0.001);
    if (k % 1500 == 1000) hint = test.hint();
  }
  // The sensor's axes may be at an angle to the axes of the world. The test then recognises no push
  // along an axis and does not advance.
  o->SetMessage(test.done() ? test.Refusal() : commissioning::Sentence(hint));
  o->Require(!test.passed(), "passes");
  o->Require(
      test.done() ? !test.Refusal().empty() : hint == commissioning::PushTest::Hint::kStraighter,
      "the message is: " + std::string(o->message.data()));
}

// Returns the distance of the nearest links at the start of the run [m].
double ElbowDistance(const BenchOptions& options) {
  Bench bench(options);
  return bench.Start() ? bench.record().link_distance : 0;
}

// RECOVERY moves the arm back slowly, and only while the person holds the key.
void Recovers(Bench& bench, FaultOutcome* o, Refusal expected) {
  if (!bench.Await(RunState::kIdle, 2)) return o->Fail("not idle: " + Messages(bench));
  bench.Hold(true);
  bench.Pass(0.2);
  bench.emulator().Request(RunEvent::kAlignRequested);
  bench.Tick();
  const auto why = static_cast<Refusal>(bench.record().why_refused);
  o->SetMessage(Sentence(why));
  o->Require(why == expected, std::string("not refused: ") + Name(bench.emulator().state()));
  bench.emulator().Request(RunEvent::kRecoverRequested);
  bench.Tick();
  o->Require(bench.emulator().state() == RunState::kRecovery, "no recovery");
  bench.rig().Mark();
  bench.Pass(8);
  o->speed = bench.rig().motion().fastest;
  o->Require(o->speed > 1e-3, "does not move");
  o->Require(o->speed <= kMaxRecoverySpeed, Formatted("recovers at %.1f mm/s", 1e3 * o->speed));
  bench.Hold(false);
  o->Require(bench.Await(RunState::kIdle, 1), std::string("RECOVERY does not return the arm: ") +
                                                  Name(bench.emulator().state()) + " " +
                                                  Messages(bench));
  bench.Hold(true);
  bench.Pass(0.2);
  bench.emulator().Request(RunEvent::kAlignRequested);
  bench.Tick();
  o->end = bench.emulator().state();
  o->Require(o->end == RunState::kAlign, "still beyond");
  bench.emulator().Request(RunEvent::kStopRequested);
  bench.Await(RunState::kHeld, 1);
}

void BeginBeyondALimit(const FaultRig& rig, std::uint64_t seed, BenchOptions* options) {
  RandomStream random(seed, "beyond");
  const std::vector<int> hands = HandsWith(kUr, rig);
  const int hand = hands[seed % hands.size()];
  const double beyond = 0.01 + 0.05 * random.Uniform();
  options->start = [hand, beyond](std::array<JointVector, kHands>* q) {
    (*q)[Index(hand)][2] = 3.14159265 + beyond;  // the elbow's limit is π
  };
}

void BeginWithElbowsTooNear(const FaultRig&, std::uint64_t seed, BenchOptions* options) {
  RandomStream random(seed, "near");
  const double distance = ElbowDistance(*options) + 0.01 + 0.02 * random.Uniform();
  options->change = [change = options->change, distance](Scenario* s) {
    change(s);
    s->rendering.security_distance = distance;
    s->rendering.influence_distance = std::max(s->rendering.influence_distance, distance + 0.2);
  };
}

template <auto kBegin, Refusal kReason>
void StartIsRefused(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                    const Fault& fault, FaultOutcome* o) {
  BenchOptions options = OptionsOf(rig, seed);
  kBegin(rig, seed, &options);
  Bench bench(options);
  bench.Capture();
  Recovers(bench, o, kReason);
  AppendForAudit(audit, fault, seed, rig, bench, {});
}

void ScenarioLoosens(const FaultRig& rig, std::uint64_t seed, FaultOutcome* o) {
  struct Limit {
    const char* key;
    double SafetySpec::*value;
    bool least = false;  // true if a lower value is less strict
  };
  static constexpr std::array<Limit, 7> kLimits = {
      {{"stop_acceleration", &SafetySpec::stop_acceleration, true},
       {"stop_jerk", &SafetySpec::stop_jerk, true},
       {"force", &SafetySpec::force},
       {"torque", &SafetySpec::torque},
       {"handle_speed", &SafetySpec::handle_speed},
       {"handle_rotation_speed", &SafetySpec::handle_rotation_speed},
       {"align_speed", &SafetySpec::align_speed}}};
  RandomStream random(seed, "looser");
  const Limit& limit = kLimits[seed % kLimits.size()];
  const auto with = [&](double factor) {
    BenchOptions options = OptionsOf(rig, seed);
    options.change = [&limit, factor, change = options.change](Scenario* s) {
      change(s);
      s->safety.*limit.value *= factor;
    };
    return WhyNot(options);
  };
  const double looser = 1 + std::pow(10, -6 + 7 * random.Uniform());
  const std::string why = with(limit.least ? 1 / looser : looser);
  o->SetMessage(why);
  o->Require(why.find(std::string("safety.") + limit.key) != std::string::npos,
             "not refused: " + why);
  const double tighter = limit.least ? 1 + 0.2 * random.Uniform() : 1 - 0.5 * random.Uniform();
  o->Require(with(tighter).empty(), "a tighter limit is refused");
}

// Starts a drift of the sensor.
void BeginToDrift(Bench& bench, int hand) {
  RandomStream random(static_cast<std::uint64_t>(hand) + bench.record().tick, "drift");
  bench.rig().Drift(hand, DriftRate(&random));
}

}  // namespace

bool StartToRecover(Bench& bench) {
  if (!bench.Await(RunState::kIdle, 2)) return false;
  bench.Hold(true);
  bench.Pass(0.2);
  bench.emulator().Request(RunEvent::kRecoverRequested);
  bench.Tick();
  return bench.emulator().state() == RunState::kRecovery;
}

std::vector<Fault> FaultsOfStarts() {
  std::vector<Fault> all;
  const auto add = [&](int number, const char* name, Carrier carrier, Expect expect, int bound,
                       auto alone) {
    Fault fault{number, name, carrier, expect, bound, nullptr};
    fault.alone = [alone, fault](const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                                 FaultOutcome* o) { alone(rig, seed, audit, fault, o); };
    all.push_back(fault);
  };
  const auto unaudited = [](auto run) {
    return [run](const FaultRig& rig, std::uint64_t seed, const std::string&, const Fault&,
                 FaultOutcome* o) { run(rig, seed, o); };
  };
  add(7, "sequences come round to zero", kLoop, kContinues, 0, unaudited(SequencesWrap));
  add(14, "RTDE of another version", kUr, kRefused, 0,
      unaudited([](const FaultRig& rig, std::uint64_t seed, FaultOutcome* o) {
        UnknownVersion(kUr, "protocol", "1", "version", rig, seed, o);
      }));
  add(14, "FCI of another version", kFranka, kRefused, 0,
      unaudited([](const FaultRig& rig, std::uint64_t seed, FaultOutcome* o) {
        UnknownVersion(kFranka, "version", "9", "version", rig, seed, o);
      }));
  add(20, "a sensor's bias drifts by 2 to 12 N a minute", kLoop, kWarned, 10'100, SensorDrifts);
  add(22, "a sensor turned, swapped or mirrored: pushes", kLoop, kRefused, 0,
      unaudited(PushesAreRefused));
  add(29, "starts beyond a joint's limit", kUr, kRefused, 0,
      StartIsRefused<BeginBeyondALimit, Refusal::kBeyondJoint>);
  add(29, "starts with the elbows too near", kLoop, kRefused, 0,
      StartIsRefused<BeginWithElbowsTooNear, Refusal::kBeyondLinks>);
  add(42, "a scenario loosens the machine's limits", kLoop, kRefused, 0,
      unaudited(ScenarioLoosens));
  // The following faults also occur in pairs with other faults.
  FindFault(&all, 7, "")->options = BeginBeforeWrap;
  FindFault(&all, 20, "")->inject = BeginToDrift;
  FindFault(&all, 29, "starts beyond")->options = BeginBeyondALimit;
  FindFault(&all, 29, "starts with the elbows")->options = BeginWithElbowsTooNear;
  for (Fault& fault : all) fault.recovers = fault.number == 29;
  return all;
}

}  // namespace predictor
