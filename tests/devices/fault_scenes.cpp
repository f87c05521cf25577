#include "devices/fault_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "devices/audit.h"
#include "devices/fault_bring.h"
#include "emulator/emulator.h"
#include "emulator/stop_reach.h"

namespace predictor {
namespace {

using enum Carrier;
using enum Expect;

// Returns the heights of the last half waves of a force [N], as long as each is larger than its
// predecessor. The slow part of the force and the tremor are removed first.
std::vector<double> GrowingCycles(const std::vector<double>& force) {
  constexpr double kSlowPart = 0.0025, kTremor = 0.02;  // coefficients per millisecond: 0.4 Hz, 3
                                                        // Hz
  // The filter reduces a sensor's noise of 0.05 N to 0.005 N. The constant is the effect of the
  // remaining noise on the difference of two peaks [N].
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

// The run may end in any way, provided that the commands are bounded (the audit checks this) and
// that the arms rest at the end.
void RunsToSomeEnd(Bench& bench, double time, const Fault& fault, const FaultRig& rig,
                   std::uint64_t seed, const std::string& audit, FaultOutcome* o) {
  bench.Capture();
  const bool runs = bench.Start();
  if (runs) bench.Pass(time);
  const BenchStop stop = bench.AwaitStop(bench.record().tick, 0.5);
  Take(stop, o);
  o->ran = runs;
  o->SetMessage(Messages(bench));
  const bool rests = o->end == RunState::kHeld || o->end == RunState::kUnpowered;
  o->Require(rests || o->end == RunState::kRun || o->end == RunState::kIdle,
             std::string("ends ") + Name(o->end));
  if (rests) JudgeRest(bench, o);
  AppendForAudit(audit, fault, seed, rig, bench, stop);
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
    o->SetMessage(error.what());
  }
}

void BeginUnderdamped(const FaultRig&, std::uint64_t, BenchOptions* options) {
  options->change = [change = options->change](Scenario* s) {
    change(s);
    // Only the cobot should swing. No lead is stable with this cobot, so the automatic choice would
    // be the full lead. With the full lead, the loop of a quick Franka next to a UR vibrates before
    // the cobot swings.
    s->rendering.lead = Emulator(*s).setup().lead.lead;
    s->cobot.controller.Set("damping_ratio=[0.7, 0.7, 0.02, 0.7, 0.7, 0.7]");
    s->operator_.hand.stiffness = {250, 100, 150};
    s->safety.handle_speed = 0.5;
    s->operator_.script = {MakeActionSpec("grip", 0, {"duration=0.5"}),
                           MakeActionSpec("move", 1, {"duration=4", "by=[0, 0, 0.1]"}),
                           MakeActionSpec("hold", 5, {"duration=25"})};
  };
  options->machine = [](Machine* m) { m->limits.handle_speed = 0.5; };
}

void Underdamped(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                 const Fault& fault, FaultOutcome* o) {
  BenchOptions options = OptionsOf(rig, seed);
  BeginUnderdamped(rig, seed, &options);
  Bench bench(options);
  bench.Capture();
  if (!bench.Start()) return o->Fail("no run: " + Messages(bench));
  // The test counts the peaks of the vertical force independently of the detector.
  std::vector<double> force;
  for (int k = 0; k < 20'000 && bench.emulator().state() == RunState::kRun; ++k) {
    bench.Tick();
    force.push_back(bench.record().hands[0].wrench[2]);
  }
  const BenchStop stop = bench.AwaitStop(bench.record().tick, 1);
  Take(stop, o);
  o->SetMessage(Messages(bench));
  JudgeMessage(fault, -1, o);
  o->Require(o->cause == StopCause::kOscillation,
             std::string("ends ") + Name(o->end) + ", " + Name(o->cause));
  // The run must stop at the third growing cycle whose amplitude is large enough to count.
  const std::vector<double> growing = GrowingCycles(force);
  const double least = bench.scenario().safety.oscillation.amplitude;
  o->ticks = static_cast<int>(std::count_if(growing.begin(), growing.end(),
                                            [least](double peak) { return peak >= least; }));
  o->Require(growing.size() >= 3, Formatted("stops at growing cycle %zu", growing.size()));
  o->Require(o->ticks <= fault.bound,
             Formatted("stops at the %dth growing cycle above the amplitude", o->ticks));
  JudgeRest(bench, o);
  AppendForAudit(audit, fault, seed, rig, bench, stop);
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

// Moves the bases as far away as possible without preventing the run.
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
    o->SetMessage(error.what());
  }
}

// Returns the mirrored axis of the sensor.
int MirroredAxis(std::uint64_t seed) { return static_cast<int>(seed / 2 % 3); }

void BeginMirrored(Bench& bench, std::uint64_t seed) {
  const int axis = MirroredAxis(seed);
  Matrix3 R = Matrix3::Identity();
  R(axis, axis) = -1;
  for (int hand = 0; hand < kHands; ++hand) bench.rig().Wire(hand, R);
}

// Returns the force that one kilogram of the handle exerts on the sensor at acceleration a, in the
// sensor's axes [N].
Vector3 KilogramAt(Bench& bench, std::size_t hand, const Vector3& a) {
  const ArmSpec& arm = bench.scenario().arm(static_cast<int>(hand));
  const Quaternion q_HS = arm.handle.ToPose().q.conjugate() * arm.sensor.pose.ToPose().q;
  const Quaternion q_WS = bench.rig().rig().true_handles()[hand].X_W.q * q_HS;
  return q_WS.conjugate() * (Vector3(0, 0, -bench.scenario().environment.gravity) - a);
}

// A sensor is mounted mirrored, and no push test was made. The time to detect this begins when a
// handle drags the hand with more than 6 N at two fifths of its speed limit. The measured force
// differs from that of a pushing hand only in how it grows, so detection takes time. Until the
// detection, and if the measured force does not grow in this way, the force thresholds protect the
// hand. The thresholds depend only on the magnitude of the force.
void RunsAwayMirrored(const FaultRig& rig, std::uint64_t seed, const std::string& audit,
                      const Fault& fault, FaultOutcome* o) {
  Bench bench(OptionsOf(rig, seed));
  bench.Capture();
  BeginMirrored(bench, seed);
  if (!bench.Start()) return o->Fail("no run: " + Messages(bench));
  constexpr double kNoise = 2;  // tolerance for sensor noise and for the tick of the decision [N]
  int fast = 0;
  double hardest = 0;
  const Vector3 zero = Vector3::Zero();
  const std::array<Vector3, kHands> tared = {KilogramAt(bench, 0, zero),
                                             KilogramAt(bench, 1, zero)};
  std::array<Vector3, kHands> before = {zero, zero};
  for (int k = 0; k < 5000 && bench.emulator().state() == RunState::kRun; ++k) {
    bench.Tick();
    // The handle drags the hand with more than 6 N at more than two fifths of the speed limit.
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
  o->SetMessage(Messages(bench));
  const bool rests = o->end == RunState::kHeld || o->end == RunState::kUnpowered;
  o->Require(rests || fast == 0, "drags the hand along and continues");
  if (rests) JudgeMessage(fault, -1, o);
  o->Require(fast <= fault.bound, Formatted("runs away for %d ms", fast));
  o->Require(hardest <= bench.scenario().safety.force + kNoise,
             Formatted("drags the hand along with %.1f N besides the handle's weight", hardest));
  // The handles may rotate at their speed limit, so the joints may take longer to decelerate.
  if (rests) JudgeReach(StopOfArms(bench.scenario(), MinStopAcceleration(bench.scenario())), o);
  if (rests) JudgeRest(bench, o);
  AppendForAudit(audit, fault, seed, rig, bench, stop);
}

}  // namespace

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
  FindFault(&all, 22, "")->begin = BeginMirrored;
  FindFault(&all, 25, "")->options = BeginUnderdamped;
  FindFault(&all, 28, "")->options = BeginNearlySingular;
  return all;
}

}  // namespace predictor
