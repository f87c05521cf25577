// In complete runs, the emulator must stop an unstable haptic loop early and must not stop a stable
// one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "emulator/runs.h"
#include "support/high_pass.h"
#include "support/soak.h"

namespace predictor {
namespace {

using Settings = std::vector<std::string>;

struct Outcome {
  bool ran = false;  // false: the predicted margin is too low
  StopCause cause = StopCause::kNone;
  bool vibrated = false;  // the vibration detector stopped it
  double time = 0;        // of the stop [s]
  double peak = 0;        // largest force component above 10 Hz until the stop [N]

  bool stopped() const { return cause != StopCause::kNone; }
  bool by_another() const { return stopped() && !vibrated; }
};

// The test runs the loop only if the predicted margin of the loop is at least `margin`.
Outcome RunLoop(const std::string& scenario_name, const Settings& set, double margin = 0) {
  const Scenario scenario = LoadTestScenario(scenario_name, set);
  Emulator emulator(scenario);
  Outcome outcome;
  if (emulator.setup().lead.margin.gain < margin) return outcome;
  outcome.ran = true;
  std::vector<HighPass> filters(3 * kHands, HighPass(1 / scenario.rate));
  Simulate(&emulator, scenario.duration, [&](const TickRecord& record) {
    if (!record.ran) return;
    for (std::size_t i = 0; i < filters.size(); ++i)
      outcome.peak =
          std::max(outcome.peak, std::abs(filters[i].Step(record.hands[i / 3].wrench[i % 3])));
  });
  const StopReport stop = emulator.stop();
  outcome.cause = stop.status.cause;
  outcome.time = stop.time;
  outcome.vibrated = stop.status.quantity == Quantity::kVibration;
  return outcome;
}

std::string Loop(double bandwidth, double delay_ms) {
  return "rig.loop={bandwidth: " + std::to_string(bandwidth) +
         ", damping_ratio: 0.9, delay: " + std::to_string(delay_ms / 1e3) + "}";
}

struct Known {
  const char* scenario;
  Settings set;
  double peak;  // the run must stop before this peak [N]
};

// Before the detector existed, each of these loops vibrated with up to 20 N at 17 to 28 Hz.
TEST(VibrationRun, LoopsThatVibratedUnseenStop) {
  const std::string lead = "rendering.lead=0.01808";
  const std::array<Known, 6> known = {{
      {"bar_circle", {"operator.hand.mass=5"}, 5},
      {"box_9kg", {lead, "operator.hand.mass=4"}, 5},
      {"dual_ur5", {lead, "operator.hand.mass=4"}, 5},
      {"box_9kg", {lead, "operator.hand.mass=3", Loop(20, 4)}, 4},
      {"box_9kg", {lead, "operator.hand.mass=3", Loop(15, 6)}, 4},
      {"box_9kg", {lead, "operator.hand.mass=5"}, 5},
  }};
  for (const Known& loop : known) {
    const Outcome outcome = RunLoop(loop.scenario, loop.set);
    std::printf("%s %s: stop at %.2f s, peak %.2f N above 10 Hz\n", loop.scenario,
                loop.set.back().c_str(), outcome.time, outcome.peak);
    EXPECT_TRUE(outcome.vibrated) << loop.scenario << ' ' << loop.set.back();
    EXPECT_LT(outcome.peak, loop.peak) << loop.scenario << ' ' << loop.set.back();
  }
}

// A line of a file in tests/vibration.
struct Combination {
  std::string kind, scenario;
  double mass, stiffness, bandwidth, delay, lead, rate, frequency;
  std::size_t seed = 0;  // of the operator and the sensors; 0: that of the scenario

  Settings Set() const {
    const auto text = [](double x) { return std::to_string(x); };
    Settings set = {"operator.hand.mass=" + text(mass),
                    "operator.hand.stiffness=[" + text(250 * stiffness) + ", " +
                        text(100 * stiffness) + ", " + text(100 * stiffness) + "]",
                    "operator.hand.rotation_stiffness=" + text(4 * stiffness),
                    "operator.hand.rotation_damping=" + text(0.1 * std::sqrt(stiffness)),
                    Loop(bandwidth, delay),
                    "rendering.lead=" + text(lead / 1e3)};
    if (seed > 0) set.push_back("seed=" + std::to_string(seed));
    // If the doubling time of a vibration is 20 s, the test needs a long run and a constant
    // posture.
    if (kind == "slow")
      set.insert(set.end(),
                 {"operator.script=[{action: grip, start: 0, duration: 0.5}]", "duration=150"});
    return set;
  }
};

// The full test runs every combination.
std::size_t Step(std::size_t sample) { return InFull() ? 1 : sample; }

// Prints the number of runs, which the record of long runs contains.
void PrintCount(long runs) {
  if (InFull()) std::printf("soak: count=%ld\n", runs);
}

std::vector<Combination> Combinations(const std::string& kind,
                                      const std::string& name = "combinations") {
  std::ifstream file(std::string(PREDICTOR_SOURCE_DIR) + "/tests/vibration/" + name + ".txt");
  std::vector<Combination> found;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    Combination c;
    if (words >> c.kind >> c.scenario >> c.mass >> c.stiffness >> c.bandwidth >> c.delay >>
            c.lead >> c.rate >> c.frequency &&
        c.kind == kind)
      found.push_back(c);
  }
  return found;
}

struct Misses {
  long runs = 0, missed = 0, late = 0;
  std::vector<std::string> late_loops;  // scenario and frequency [Hz]
  long by_another = 0;                  // loops that stop in time, but for another reason
};

// Counts the loops that do not stop and those that stop only at 5 N or more.
Misses Unstable(const std::vector<Combination>& all, std::size_t step) {
  Misses count;
  for (std::size_t i = 0; i < all.size(); i += step) {
    const Combination& c = all[i];
    const Outcome outcome = RunLoop(c.scenario, c.Set());
    ++count.runs;
    const bool missed = !outcome.stopped();
    const bool late = !missed && outcome.peak >= 5;
    count.missed += missed ? 1 : 0;
    count.late += late ? 1 : 0;
    if (late) count.late_loops.push_back(c.scenario + " " + std::to_string(c.frequency));
    count.by_another += outcome.by_another() && !late ? 1 : 0;
    if (missed || late || outcome.by_another())
      std::printf("%s %zu %s: rate %.2f 1/s at %.1f Hz, stop %d at %.2f s, peak %.2f N\n",
                  c.kind.c_str(), i, c.scenario.c_str(), c.rate, c.frequency,
                  static_cast<int>(outcome.cause), outcome.time, outcome.peak);
  }
  PrintCount(count.runs);
  std::printf("%ld runs, %ld not stopped, %ld at 5 N or more, %ld stopped by another cause\n",
              count.runs, count.missed, count.late, count.by_another);
  return count;
}

TEST(VibrationRun, AnyLoopThatDoublesWithinTwoSecondsStopsBeforeFiveNewtonSoak) {
  const Misses count = Unstable(Combinations("fast"), Step(8));
  ASSERT_GE(count.runs, 25);
  EXPECT_EQ(count.missed, 0);
  EXPECT_EQ(count.late, 0);
  EXPECT_EQ(count.by_another, 0);
}

// These loops were drawn after the detector's thresholds had been fixed, and each has another seed.
// The detector misses the requirement in one of them, in which the force reaches 6.2 N
// (docs/concepts/vibration.md). The test allows no other one.
TEST(VibrationRun, FreshLoopsStopBeforeFiveNewtonWithOneExceptionSoak) {
  std::vector<Combination> all = Combinations("fast", "fresh_combinations");
  ASSERT_EQ(all.size(), 200U);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].seed = i + 1;
  const Misses count = Unstable(all, Step(25));
  ASSERT_GE(count.runs, 8);
  EXPECT_EQ(count.missed, 0);
  for (const std::string& loop : count.late_loops)
    EXPECT_EQ(loop, "bar_circle " + std::to_string(46.5));
  EXPECT_EQ(count.by_another, 0);
}

TEST(VibrationRun, SlowerLoopsStopBeforeFiveNewtonSoak) {
  const Misses count = Unstable(Combinations("slow"), Step(12));
  ASSERT_GE(count.runs, 9);
  EXPECT_LE(20 * (count.missed + count.late), count.runs);
  EXPECT_EQ(count.by_another, 0);
}

TEST(VibrationRun, NoStableLoopIsStoppedSoak) {
  const std::vector<Combination> all = Combinations("stable");
  ASSERT_EQ(all.size(), 200U);
  long runs = 0;
  for (std::size_t i = 0; i < all.size(); i += Step(25), ++runs) {
    const Outcome outcome = RunLoop(all[i].scenario, all[i].Set());
    EXPECT_FALSE(outcome.stopped())
        << i << " by " << Name(outcome.cause) << " at " << outcome.time << " s";
  }
  PrintCount(runs);
}

constexpr const char* kWithAPerson[] = {"bar_circle", "box_18kg",     "box_9kg",
                                        "dual_ur5",   "excite_cobot", "push",
                                        "single_arm", "underdamped",  "ur_and_panda"};

Settings Sensors(const std::string& scenario, double noise) {
  Settings set;
  // there are no arms, because the hands act on the object
  if (scenario == "excite_cobot") return set;
  for (const char* arm : {"left", "right"}) {
    if (arm == std::string("right") && scenario == "single_arm") continue;
    const std::string sensor = std::string("device.arms.") + arm + ".sensor.";
    set.push_back(sensor + "noise_force=" + std::to_string(0.05 * noise));
    set.push_back(sensor + "noise_torque=" + std::to_string(0.002 * noise));
  }
  return set;
}

// Returns the margin that a loop needs for this test, so that hands may differ from the scenario's.
// The slow oscillation of `underdamped` reduces its margin but is not a vibration. `excite_cobot`
// has no loop.
double NeededMargin(const std::string& scenario) {
  return scenario == "underdamped" || scenario == "excite_cobot" ? 0 : 1.5;
}

// The test runs nine scenarios with many seeds, with nominal and threefold sensor noise, at 1000,
// 500 and 250 Hz if the margin allows it. The short test uses five seeds of each scenario, each
// with one of the six variants.
TEST(VibrationRun, NoScenarioIsStoppedSoak) {
  long runs = 0;
  std::map<std::string, long> left_out;
  const long seeds = Count(5, 50);
  for (std::size_t k = 0; k < std::size(kWithAPerson); ++k) {
    const std::string scenario = kWithAPerson[k];
    for (long seed = 1; seed <= seeds; ++seed) {
      for (long variant = 0; variant < 6; ++variant) {
        if (!InFull() && variant != (seed - 1 + 5 * static_cast<long>(k)) % 6) continue;
        const int rate = std::array<int, 3>{1000, 500, 250}[static_cast<std::size_t>(variant % 3)];
        Settings set = Sensors(scenario, variant < 3 ? 1 : 3);
        // Disables the detector for oscillations below 10 Hz.
        set.insert(set.end(), {"rate=" + std::to_string(rate), "safety.oscillation.amplitude=900",
                               "seed=" + std::to_string(40000 + seed)});
        const Outcome outcome = RunLoop(scenario, set, NeededMargin(scenario));
        const std::string where = scenario + " at " + std::to_string(rate) + " Hz";
        if (!outcome.ran) {
          ++left_out[where];
          continue;
        }
        ++runs;
        EXPECT_FALSE(outcome.vibrated) << set.back() << ", " << where << ", variant " << variant
                                       << ", " << outcome.time << " s";
        EXPECT_TRUE(!outcome.stopped() || scenario == "push" || scenario == "underdamped")
            << where << ": " << Name(outcome.cause);
      }
    }
    std::printf("%s: %ld runs so far\n", scenario.c_str(), runs);
    std::fflush(stdout);
  }
  for (const auto& [where, count] : left_out)
    std::printf("%s: %ld runs omitted because of their margin\n", where.c_str(), count);
  // Only this loop has a margin that is too low.
  const long without = InFull() ? 100 : 1;
  EXPECT_EQ(left_out, (std::map<std::string, long>{{"bar_circle at 250 Hz", without}}));
  EXPECT_EQ(runs + without, 9 * seeds * (InFull() ? 6 : 1));
}

// A person pushes as suddenly as muscles allow (50 ms) and releases abruptly.
TEST(VibrationRun, SuddenPushesAndReleasesAreNoVibrationSoak) {
  for (const char* scenario : {"box_9kg", "bar_circle", "box_18kg"}) {
    for (const char* force : {"[14, 0, 0]", "[0, 14, 0]", "[0, 0, 14]", "[-9, 9, -9]"}) {
      for (const char* rise : {"0.05", "0.12"}) {
        for (long seed = 1; seed <= Count(1, 20); ++seed) {
          std::string script = "operator.script=[{action: grip, start: 0, duration: 0.5}";
          script.append(", {action: push, start: 2, duration: 0.5, force: ").append(force);
          script.append(", rise_time: ").append(rise).append("}");
          script += ", {action: release, start: 4}]";
          const Outcome outcome =
              RunLoop(scenario, {script, "operator.hand.release_time=0.01", "duration=6",
                                 "seed=" + std::to_string(50000 + seed)});
          EXPECT_FALSE(outcome.stopped()) << scenario << ' ' << force << ' ' << rise << " by "
                                          << Name(outcome.cause) << " at " << outcome.time << " s";
        }
      }
    }
  }
}

}  // namespace
}  // namespace predictor
