#include "devices/fault_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "commissioning/push_test.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "core/words.h"
#include "devices/audit.h"
#include "devices/fault_bring.h"
#include "devices/stop_channel.h"
#include "emulator/stop_reach.h"
#include "safety/warnings.h"
#include "watchdog/watchdog.h"

namespace predictor {
namespace {

using enum Carrier;
using enum Expect;

constexpr double kMostInRecovery = 0.050;  // [m/s]
constexpr double kSlow = 5e-6;             // distance in a millisecond at 5 mm/s [m]

std::size_t Index(int hand) { return static_cast<std::size_t>(hand); }

void AuditOf(const Fault& fault, const FaultRig& rig, std::uint64_t seed, const std::string& audit,
             const Bench& bench, const BenchStop& stop) {
  AppendForAudit(audit, fault.ToString() + ", seed " + std::to_string(seed), rig, bench, stop);
}

// The error when the bench connects; "" if it succeeds.
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

// ---- before the run -----------------------------------------------------------------------------

void UnknownVersion(Carrier carrier, const char* option, const char* version, const char* word,
                    const FaultRig& rig, std::uint64_t seed, FaultOutcome* o) {
  BenchOptions options = OptionsOf(rig, seed);
  const std::vector<int> hands = HandsWith(carrier, rig);
  options.arm_options[Index(hands[seed % hands.size()])][option] = version;
  const std::string why = WhyNot(options);
  o->Tell(why);
  o->Require(!why.empty(), "connects");
  o->Require(why.find(word) != std::string::npos, "does not say what is wrong: " + why);
}

// The sequence numbers begin so that they wrap around during the run.
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
  if (!bench.Start()) return o->Fail("no run: " + Told(bench));
  bench.Pass(5);
  o->end = bench.emulator().state();
  o->Require(o->end == RunState::kRun, "stops: " + Told(bench));
  o->Require((bench.record().hands[0].warnings | bench.record().hands[1].warnings) == 0,
             "warns: " + Told(bench));
  for (const int hand : HandsWith(kNetFt, rig))
    o->Require(bench.record().hands[Index(hand)].sensor_sequence > 0, "no readings");
}

// A random drift of the force bias by 2 to 12 N per minute.
Wrench DriftRate(RandomStream* random) {
  const double rate = 2.2 + 10 * random->Uniform();  // [N/min]
  Vector3 direction(random->Normal(), random->Normal(), random->Normal());
  Wrench F = Wrench::Zero();
  F.head<3>() = rate / 60 * direction.normalized();
  return F;
}

// First the bias drifts while no hand is near; then a handle reads more than 5 N.
void SensorDrifts(const FaultRig& rig, std::uint64_t seed, const std::string&, const Fault& fault,
                  FaultOutcome* o) {
  RandomStream random(seed, "drift");
  Bench bench(OptionsOf(rig, seed));
  if (!bench.Await(RunState::kIdle, 2)) return o->Fail("not idle");
  bench.Pass(2 * Warnings::kDriftTime + 0.1);
  const auto hand = static_cast<int>(random.Next() % kHands);
  const auto warned = [&] { return Has(bench.record().hands[Index(hand)], Warning::kBiasDrift); };
  o->Require(!warned(), "warned of without a drift");
  const Wrench rate = DriftRate(&random);
  bench.rig().Drift(hand, rate);
  for (int k = 0; k < 20'000 && !warned(); ++k) {
    bench.Tick();
    o->ticks = k;
  }
  o->Tell(Told(bench));
  o->Require(warned(), "nobody is warned");
  JudgeTold(fault, hand, o);
  bench.rig().Drift(hand, Wrench::Zero());
  bench.rig().Disturb(hand, JointVector(), Wrench(6.5 * rate.normalized()));
  bench.Hold(true);
  bench.Pass(0.3);
  bench.emulator().Request(RunEvent::kAlignRequested);
  bench.Tick();
  o->end = bench.emulator().state();
  o->Require(static_cast<Refusal>(bench.record().why_refused) == Refusal::kNotFree,
             std::string("not refused to align: ") + Name(o->end));
}

// An incorrect mounting: axes rotated, swapped or mirrored, depending on the seed.
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
  if (!bench.Await(RunState::kIdle, 2)) return o->Fail("not idle: " + Told(bench));
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
  // The sensor's axes may be at an angle to those of the world. Then no push counts as one along an
  // axis, and the test does not advance.
  o->Tell(test.done() ? test.Refusal() : commissioning::Sentence(hint));
  o->Require(!test.passed(), "passes");
  o->Require(
      test.done() ? !test.Refusal().empty() : hint == commissioning::PushTest::Hint::kStraighter,
      "the person is told: " + std::string(o->told.data()));
}

// Distance of the nearest links at the start of the run [m].
double ElbowDistance(const BenchOptions& options) {
  Bench bench(options);
  return bench.Start() ? bench.record().link_distance : 0;
}

// RECOVERY moves the arm back slowly, and only while the key is held.
void Recovers(Bench& bench, FaultOutcome* o, Refusal expected) {
  if (!bench.Await(RunState::kIdle, 2)) return o->Fail("not idle: " + Told(bench));
  bench.Hold(true);
  bench.Pass(0.2);
  bench.emulator().Request(RunEvent::kAlignRequested);
  bench.Tick();
  const auto why = static_cast<Refusal>(bench.record().why_refused);
  o->Tell(Sentence(why));
  o->Require(why == expected, std::string("not refused: ") + Name(bench.emulator().state()));
  bench.emulator().Request(RunEvent::kRecoverRequested);
  bench.Tick();
  o->Require(bench.emulator().state() == RunState::kRecovery, "no recovery");
  bench.rig().Mark();
  bench.Pass(8);
  o->speed = bench.rig().motion().fastest;
  o->Require(o->speed > 1e-3, "does not move");
  o->Require(o->speed <= kMostInRecovery, Formatted("recovers at %.1f mm/s", 1e3 * o->speed));
  bench.Hold(false);
  o->Require(
      bench.Await(RunState::kIdle, 1),
      std::string("does not come back: ") + Name(bench.emulator().state()) + " " + Told(bench));
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

void StartsBeyondALimit(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                        const Fault& fault, FaultOutcome* o) {
  BenchOptions options = OptionsOf(rig, seed);
  BeginBeyondALimit(rig, seed, &options);
  Bench bench(options);
  bench.Capture();
  Recovers(bench, o, Refusal::kBeyondJoint);
  AuditOf(fault, rig, seed, audit, bench, {});
}

void StartsWithElbowsTooNear(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                             const Fault& fault, FaultOutcome* o) {
  BenchOptions options = OptionsOf(rig, seed);
  BeginWithElbowsTooNear(rig, seed, &options);
  Bench bench(options);
  bench.Capture();
  Recovers(bench, o, Refusal::kBeyondLinks);
  AuditOf(fault, rig, seed, audit, bench, {});
}

void ScenarioLoosens(const FaultRig& rig, std::uint64_t seed, FaultOutcome* o) {
  struct Limit {
    const char* key;
    double SafetySpec::*value;
    bool least = false;  // a lower value is less strict
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
  o->Tell(why);
  o->Require(why.find(std::string("safety.") + limit.key) != std::string::npos,
             "not refused: " + why);
  const double tighter = limit.least ? 1 + 0.2 * random.Uniform() : 1 - 0.5 * random.Uniform();
  o->Require(with(tighter).empty(), "a tighter one is refused");
}

// ---- our own process
// -----------------------------------------------------------------------------

// Lets the far end continue without our process.
void WithoutUs(Bench& bench, FaultOutcome* o, int bound, const std::function<void()>& each) {
  const auto handles = [&](std::size_t i) { return bench.rig().rig().true_handles()[i].X_W; };
  const std::array<Pose, kHands> begin = {handles(0), handles(1)};
  std::array<Pose, kHands> last = begin;
  std::array<double, kHands> told{}, way{};
  std::array<int, kHands> braked = {-1, -1};
  for (std::size_t i = 0; i < kHands; ++i) told[i] = bench.rig().told(static_cast<int>(i)).norm();
  for (int k = 1; k <= 600; ++k) {
    if (each) each();
    bench.Hang(0.001);
    for (std::size_t i = 0; i < kHands; ++i) {
      const double now = bench.rig().told(static_cast<int>(i)).norm();
      if (braked[i] < 0 && now < 0.97 * told[i]) braked[i] = k;
      told[i] = std::max(told[i], now);
      const double step = (handles(i).p - last[i].p).norm();
      way[i] += step;
      if (step > kSlow) o->time = 0.001 * k;
      last[i] = handles(i);
    }
  }
  o->ticks = std::max(braked[0], braked[1]);
  o->distance = std::max(way[0], way[1]);
  const Pose before = begin[0].Inverse() * begin[1], after = last[0].Inverse() * last[1];
  o->drift = (before.p - after.p).norm();
  o->turn = RotationError(before.q, after.q).norm();
  o->Require(braked[0] > 0 && braked[1] > 0, "an arm does not brake");
  o->Require(o->ticks <= bound, Formatted("brakes after %d ms", o->ticks));
  o->Require(o->time < 0.25, Formatted("rests after %.0f ms", 1e3 * o->time));
  o->Require(o->distance < 0.0134 + 0.25 * 0.060,
             Formatted("goes on for %.1f mm", 1e3 * o->distance));
}

void ProcessDies(Bench& bench, int, FaultOutcome* o) {
  WithoutUs(bench, o, 23, nullptr);
  o->Tell("(Nobody is left to tell: the robot's own panel.)");
}

// The watchdog has channels to URs. A Franka accepts only one client and relies on its own
// time-out.
struct Guarded {
  std::vector<std::unique_ptr<StopChannel>> channels;
  watchdog::Watchdog watchdog;
};

// Returns the watchdog's work for each later millisecond.
std::function<void()> WatchdogOf(Bench& bench) {
  const auto guarded = std::make_shared<Guarded>();
  for (int hand = 0; hand < kHands; ++hand)
    if (bench.arm(hand).tcp_ports().size() > 1)
      guarded->channels.push_back(
          OpenStopChannel({ArmMake::kUr, Bench::HostOf(hand)}, &bench.network()));
  const auto look = [guarded, &bench] {
    if (!guarded->watchdog.Look(bench.record().tick, bench.emulator().state(), bench.now())) return;
    for (const auto& channel : guarded->channels) channel->Stop();
  };
  look();
  return look;
}

void LoopHangs(Bench& bench, int, FaultOutcome* o) {
  bool all = true;
  for (int hand = 0; hand < kHands; ++hand) all = all && bench.arm(hand).tcp_ports().size() > 1;
  // The watchdog takes 10 ms, looks every millisecond, and the controller needs two cycles.
  WithoutUs(bench, o, all ? 14 : 23, WatchdogOf(bench));
  o->Tell("The control loop hung, and the watchdog stopped the arms.");
}

void EndIsAskedFor(Bench& bench, int, FaultOutcome* o) {
  const std::uint64_t tick = bench.record().tick;
  bench.emulator().RequestEnd();
  Take(bench.AwaitStop(tick, 2), o);
  o->Require(o->end == RunState::kHeld && o->cause == StopCause::kNone,
             std::string("ends ") + Name(o->end) + ", " + Name(o->cause));
  o->Require(o->ticks == 1, Formatted("seen after %d ticks", o->ticks));
  JudgeRest(bench, o);
}

// ---- the emulation
// --------------------------------------------------------------------------------

// The heights of the last half waves of a force [N], as long as each is larger than the one before.
// The slow part of the force and the tremor are removed.
std::vector<double> GrowingCycles(const std::vector<double>& force) {
  constexpr double kSlowPart = 0.0025, kTremor = 0.02;  // coefficients per millisecond: 0.4 Hz, 3
                                                        // Hz
  // The filter reduces a sensor's noise of 0.05 N to 0.005 N. This is its effect on the difference
  // of two peaks [N].
  constexpr double kNoise = 0.015;
  std::vector<double> peaks;
  double smooth = 0, slow = 0, slower = 0, highest = 0;
  for (const double f : force) {
    smooth += kTremor * (f - smooth);
    slow += kSlowPart * (smooth - slow);
    slower += kSlowPart * (smooth - slow - slower);
    const double y = smooth - slow - slower;
    if (y < -0.3 && highest > 0.5) peaks.push_back(highest);
    highest = y < -0.3 ? 0 : std::max(highest, y);
  }
  if (highest > 0.5) peaks.push_back(highest);  // the peak at which the run stopped
  std::size_t first = peaks.empty() ? 0 : peaks.size() - 1;
  while (first > 0 && peaks[first] > peaks[first - 1] - kNoise) --first;
  return {peaks.begin() + static_cast<std::ptrdiff_t>(std::min(first + 1, peaks.size())),
          peaks.end()};
}

// The run may end in any way, as long as the commands are bounded (the audit) and the arms rest at
// the end.
void RunsToSomeEnd(Bench& bench, double time, const Fault& fault, const FaultRig& rig,
                   std::uint64_t seed, const std::string& audit, FaultOutcome* o) {
  bench.Capture();
  const bool runs = bench.Start();
  if (runs) bench.Pass(time);
  const BenchStop stop = bench.AwaitStop(bench.record().tick, 0.5);
  Take(stop, o);
  o->ran = runs;
  o->Tell(Told(bench));
  const bool rests = o->end == RunState::kHeld || o->end == RunState::kUnpowered;
  o->Require(rests || o->end == RunState::kRun || o->end == RunState::kIdle,
             std::string("ends ") + Name(o->end));
  if (rests) JudgeRest(bench, o);
  AuditOf(fault, rig, seed, audit, bench, stop);
}

void StiffModel(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                const Fault& fault, FaultOutcome* o) {
  RandomStream random(seed, "stiff");
  BenchOptions options = OptionsOf(rig, seed);
  const double stiffness = std::pow(10, 3.5 + 1.5 * random.Uniform());
  options.change = [change = options.change, stiffness](Scenario* s) {
    change(s);
    s->cobot.controller = {"joint_impedance", {}};
    s->cobot.controller.Set("joint_stiffness=" + FormatNumber(stiffness));
    s->cobot.controller.Set("joint_damping_ratio=0.05");
  };
  try {
    Bench bench(options);
    RunsToSomeEnd(bench, 4, fault, rig, seed, audit, o);
  } catch (const InputError& error) {
    o->Tell(error.what());
  }
}

void BeginUnderdamped(const FaultRig&, std::uint64_t, BenchOptions* options) {
  options->change = [change = options->change](Scenario* s) {
    change(s);
    s->cobot.controller.Set("damping_ratio=[0.7, 0.7, 0.02, 0.7, 0.7, 0.7]");
    s->operator_.hand.stiffness = {250, 100, 150};
    s->safety.handle_speed = 0.5;
    ActionSpec grip, lift, hold;
    grip.action = "grip";
    grip.duration = 0.5;
    lift.action = "move";
    lift.start = 1;
    lift.duration = 4;
    lift.by = {0, 0, 0.10};
    hold.action = "hold";
    hold.start = 5;
    hold.duration = 25;
    s->operator_.script = {grip, lift, hold};
  };
  options->machine = [](Machine* m) { m->limits.handle_speed = 0.5; };
}

void Underdamped(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                 const Fault& fault, FaultOutcome* o) {
  BenchOptions options = OptionsOf(rig, seed);
  BeginUnderdamped(rig, seed, &options);
  Bench bench(options);
  bench.Capture();
  if (!bench.Start()) return o->Fail("no run: " + Told(bench));
  // Counts the peaks of the vertical force independently of the detector.
  std::vector<double> force;
  for (int k = 0; k < 20'000 && bench.emulator().state() == RunState::kRun; ++k) {
    bench.Tick();
    force.push_back(bench.record().hands[0].wrench[2]);
  }
  const BenchStop stop = bench.AwaitStop(bench.record().tick, 1);
  Take(stop, o);
  o->Tell(Told(bench));
  JudgeTold(fault, -1, o);
  o->Require(o->cause == StopCause::kOscillation,
             std::string("ends ") + Name(o->end) + ", " + Name(o->cause));
  // The run must stop at the third growing cycle above the amplitude from which cycles count.
  const std::vector<double> growing = GrowingCycles(force);
  const double least = bench.scenario().safety.oscillation.amplitude;
  o->ticks = static_cast<int>(std::count_if(growing.begin(), growing.end(),
                                            [least](double peak) { return peak >= least; }));
  o->Require(growing.size() >= 3, Formatted("stops at growing cycle %zu", growing.size()));
  o->Require(o->ticks <= fault.bound,
             Formatted("stops at the %dth growing cycle above the amplitude", o->ticks));
  JudgeRest(bench, o);
  AuditOf(fault, rig, seed, audit, bench, stop);
}

void MoveBases(double away, double aside, BenchOptions* options) {
  options->change = [change = options->change, away, aside](Scenario* s) {
    change(s);
    for (std::optional<ArmSpec>* arm : {&s->device.left, &s->device.right}) {
      (*arm)->base.xyz.x() -= away;
      (*arm)->base.xyz.y() += ((*arm)->base.xyz.y() > 0 ? aside : -aside);
    }
  };
}

bool ComesToRun(const BenchOptions& options) {
  try {
    return Bench(options).Start();
  } catch (const InputError&) {
    return false;
  }
}

// Moves the bases as far away as a run still permits.
void BeginNearlySingular(const FaultRig&, std::uint64_t seed, BenchOptions* options) {
  RandomStream random(seed, "singular");
  const double aside = 0.1 * random.Normal();
  for (double share = 1; share > 0.1; share -= 0.15) {
    BenchOptions moved = *options;
    MoveBases(0.45 * share, share * aside, &moved);
    if (!ComesToRun(moved)) continue;
    *options = moved;
    return;
  }
}

// The bases are so far away that the arms are nearly stretched out or cannot reach the object at
// all.
void NearlySingular(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                    const Fault& fault, FaultOutcome* o) {
  RandomStream random(seed, "singular");
  BenchOptions options = OptionsOf(rig, seed);
  const double away = 0.45 * random.Uniform(), aside = 0.1 * random.Normal();
  MoveBases(away, aside, &options);
  try {
    Bench bench(options);
    RunsToSomeEnd(bench, 4, fault, rig, seed, audit, o);
  } catch (const InputError& error) {
    o->Tell(error.what());
  }
}

// The mirrored axis of the sensor.
int MirroredAxis(std::uint64_t seed) { return static_cast<int>(seed / 2 % 3); }

void BeginMirrored(Bench& bench, std::uint64_t seed) {
  const int axis = MirroredAxis(seed);
  Matrix3 R = Matrix3::Identity();
  R(axis, axis) = -1;
  for (int hand = 0; hand < kHands; ++hand) bench.rig().Wire(hand, R);
}

// Force of one kilogram of the handle on the sensor at acceleration a, in the sensor's axes [N].
Vector3 KilogramAt(Bench& bench, std::size_t hand, const Vector3& a) {
  const ArmSpec& arm = bench.scenario().arm(static_cast<int>(hand));
  const Quaternion q_HS = arm.handle.ToPose().q.conjugate() * arm.sensor.pose.ToPose().q;
  const Quaternion q_WS = bench.rig().rig().true_handles()[hand].X_W.q * q_HS;
  return q_WS.conjugate() * (Vector3(0, 0, -bench.scenario().environment.gravity) - a);
}

// A sensor is mounted mirrored, and no push test was made. The time counts from the moment at which
// a handle drags the hand with more than 6 N at two fifths of its speed limit. The measurement
// differs from that of a pushing hand only in how it grows, so detection takes time. Until then,
// and if it does not grow in that way, the thresholds limit the force on the hand, because they
// depend only on the magnitude.
void RunsAwayMirrored(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                      const Fault& fault, FaultOutcome* o) {
  Bench bench(OptionsOf(rig, seed));
  bench.Capture();
  BeginMirrored(bench, seed);
  if (!bench.Start()) return o->Fail("no run: " + Told(bench));
  constexpr double kNoise = 2;  // tolerance for sensor noise and the deciding tick [N]
  int fast = 0;
  double hardest = 0;
  const Vector3 zero = Vector3::Zero();
  const std::array<Vector3, kHands> tared = {KilogramAt(bench, 0, zero),
                                             KilogramAt(bench, 1, zero)};
  std::array<Vector3, kHands> before = {zero, zero};
  for (int k = 0; k < 5000 && bench.emulator().state() == RunState::kRun; ++k) {
    bench.Tick();
    // The hand is dragged along at more than two fifths of the speed limit with more than 6 N.
    bool dragged = false;
    for (std::size_t i = 0; i < kHands; ++i) {
      const Vector3 v = bench.rig().rig().true_handles()[i].V_W.head<3>();
      const Vector3 F = bench.rig().rig().true_operator().F_H_W[i].head<3>();
      const bool fast_and_hard =
          v.norm() > 0.4 * bench.scenario().safety.handle_speed && F.dot(v) < -6 * v.norm();
      dragged = dragged || fast_and_hard;
      // After the handle has rotated, or while it accelerates, the weight compensation has the
      // wrong sign along the mirrored axis.
      const Vector3 a = (v - std::exchange(before[i], v)) / bench.emulator().dt();
      const double misread = 2 * bench.scenario().arm(static_cast<int>(i)).payload.mass *
                             std::abs((KilogramAt(bench, i, a) - tared[i])[MirroredAxis(seed)]);
      hardest = std::max(hardest, F.norm() - misread);
    }
    fast = dragged ? fast + 1 : 0;
  }
  const BenchStop stop = bench.AwaitStop(bench.record().tick, 1);
  Take(stop, o);
  o->ticks = fast;
  o->Tell(Told(bench));
  const bool rests = o->end == RunState::kHeld || o->end == RunState::kUnpowered;
  o->Require(rests || fast == 0, "drags the hand along, and goes on");
  if (rests) JudgeTold(fault, -1, o);
  o->Require(fast <= fault.bound, Formatted("runs away for %d ms", fast));
  o->Require(hardest <= bench.scenario().safety.force + kNoise,
             Formatted("drags the hand along with %.1f N besides the handle's weight", hardest));
  // The handles may rotate at their speed limit, so the joints may need longer to decelerate.
  if (rests) JudgeReach(StopOfArms(bench.scenario(), MinStopAcceleration(bench.scenario())), o);
  if (rests) JudgeRest(bench, o);
  AuditOf(fault, rig, seed, audit, bench, stop);
}

// Starts a drift of the sensor.
void BeginToDrift(Bench& bench, int hand) {
  RandomStream random(static_cast<std::uint64_t>(hand) + bench.record().tick, "drift");
  bench.rig().Drift(hand, DriftRate(&random));
}

Fault* Find(std::vector<Fault>* all, int number, const char* beginning) {
  for (Fault& fault : *all)
    if (fault.number == number && std::string(fault.name).starts_with(beginning)) return &fault;
  throw std::logic_error(std::string("no such fault: ") + beginning);
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
  add(7, "sequences come round to zero", kLoop, kGoesOn, 0, unaudited(SequencesWrap));
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
  add(29, "starts beyond a joint's limit", kUr, kRefused, 0, StartsBeyondALimit);
  add(29, "starts with the elbows too near", kLoop, kRefused, 0, StartsWithElbowsTooNear);
  add(42, "a scenario loosens the machine's limits", kLoop, kRefused, 0,
      unaudited(ScenarioLoosens));
  // These faults also take part in pairs.
  Find(&all, 7, "")->options = BeginBeforeWrap;
  Find(&all, 20, "")->inject = BeginToDrift;
  Find(&all, 29, "starts beyond")->options = BeginBeyondALimit;
  Find(&all, 29, "starts with the elbows")->options = BeginWithElbowsTooNear;
  for (Fault& fault : all) fault.recovers = fault.number == 29;
  return all;
}

std::vector<Fault> FaultsOfProcesses() {
  std::vector<Fault> all;
  const auto add = [&](int number, const char* name, Expect expect, int bound, auto upon) {
    Fault fault{number, name, kLoop, expect, bound, nullptr, false};
    fault.upon = upon;
    all.push_back(fault);
  };
  add(16, "our process dies in motion", kArmsThemselves, 23, ProcessDies);
  add(31, "the loop hangs", kArmsThemselves, 23, LoopHangs);
  add(50, "the program is asked to end", kHold, 1, EndIsAskedFor);
  Find(&all, 16, "")->gone = [](Bench&) { return std::function<void()>(); };
  Find(&all, 31, "")->gone = WatchdogOf;
  return all;
}

std::vector<Fault> FaultsOfScenes() {
  std::vector<Fault> all;
  const auto add = [&](int number, const char* name, Expect expect, int bound, auto alone) {
    Fault fault{number, name, kLoop, expect, bound, nullptr};
    fault.alone = [alone, fault](const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                                 FaultOutcome* o) { alone(rig, seed, audit, fault, o); };
    all.push_back(fault);
  };
  add(22, "both sensors mirrored, pushes not tested", kHold, 1000, RunsAwayMirrored);
  add(24, "a cobot as stiff as can be written", kAnyEnd, 0, StiffModel);
  add(25, "a cobot that swings more and more (growing cycles)", kHold, 3, Underdamped);
  add(28, "arms nearly stretched out", kAnyEnd, 0, NearlySingular);
  Find(&all, 22, "")->begin = BeginMirrored;
  Find(&all, 25, "")->options = BeginUnderdamped;
  Find(&all, 28, "")->options = BeginNearlySingular;
  return all;
}

}  // namespace predictor
