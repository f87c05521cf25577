// Tests every fault of arms, sensors, wires and the loop that a run must survive, with many seeds
// in virtual time. The tests check when the program detects the fault, how and how far the arms
// stop, and whether the handles keep their relative pose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/words.h"
#include "devices/fault_bring.h"
#include "devices/fault_runs.h"
#include "support/soak.h"

namespace predictor {
namespace {

constexpr double kWatchdog = 0.020;  // time-out of a controller for our program [s]

const char* Words(Expect expect) {
  switch (expect) {
    case Expect::kContinues:
      return "continues";
    case Expect::kWarned:
      return "warned";
    case Expect::kHold:
      return "holds";
    case Expect::kPowerOff:
      return "power off";
    case Expect::kRefused:
      return "refused";
    case Expect::kArmsThemselves:
      return "arms stop";
    case Expect::kAnyEnd:
      return "ends well";
  }
  return "";
}

// PREDICTOR_SEEDS is the number of seeds. With a smaller number of seeds, the test takes less time.
long Seeds() {
  const char* seeds = std::getenv("PREDICTOR_SEEDS");
  return seeds == nullptr ? Count(1, 200) : std::atol(seeds);
}

// PREDICTOR_PAIRS is the fraction of the pairs that a short test runs.
double Pairs() {
  const char* share = std::getenv("PREDICTOR_PAIRS");
  if (share != nullptr) return std::atof(share);
  return InFull() ? 1 : 0.01;
}

// Returns the file in which a long test keeps its results. A short test keeps none.
std::string KeptIn(const std::string& what, const FaultRig& rig) {
  const char* folder = std::getenv("PREDICTOR_FAULTS");
  if (folder == nullptr || OnlyFault() != 0) return "";
  std::string name = what + " " + rig.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return std::string(folder) + "/" + name;
}

void PrintRow(const Fault& fault, const std::vector<const FaultOutcome*>& runs) {
  FaultOutcome worst = *runs.front();
  for (const FaultOutcome* run : runs) {
    worst.ticks = std::max(worst.ticks, run->ticks);
    worst.off = std::max(worst.off, run->off);
    worst.speed = std::max(worst.speed, run->speed);
    worst.time = std::max(worst.time, run->time);
    worst.distance = std::max(worst.distance, run->distance);
    worst.drift = std::max(worst.drift, run->drift);
    worst.turn = std::max(worst.turn, run->turn);
    worst.apart = std::max(worst.apart, run->apart);
  }
  std::printf("%2d  %-50s %-9s", fault.number, fault.name, Words(fault.expect));
  if (fault.expect == Expect::kHold || fault.expect == Expect::kPowerOff ||
      fault.expect == Expect::kArmsThemselves)
    std::printf(
        " detected after %2d of %2d ticks; from up to %3.0f mm/s at rest after %3.0f ms, %4.1f mm; "
        "apart %.2f mm, %.2f deg (on the way %.2f mm)",
        worst.ticks, fault.bound, 1e3 * worst.speed, 1e3 * worst.time, 1e3 * worst.distance,
        1e3 * worst.drift, 57.2958 * worst.turn, 1e3 * worst.apart);
  if (fault.expect == Expect::kAnyEnd)
    std::printf(
        " %td of %zu reached RUN",
        std::count_if(runs.begin(), runs.end(), [](const FaultOutcome* run) { return run->ran; }),
        runs.size());
  if (fault.off > 0)
    std::printf("; power-off requested after %d of %d ticks", worst.off, fault.off);
  std::printf("\n");
  if (worst.message[0] != 0) std::printf("      \"%s\"\n", worst.message.data());
}

void ExpectAudited(const FaultRuns& runs) {
  std::size_t audits = 0;
  for (const FaultRun& run : runs.all) {
    if (run.fault != kAudit) continue;
    ++audits;
    EXPECT_TRUE(run.outcome.well) << "audit of the commands to the arms, seed " << run.seed << ": "
                                  << run.outcome.why.data();
  }
  EXPECT_EQ(audits, runs.audits_due);
  EXPECT_EQ(runs.all.size(), runs.due + runs.audits_due);
}

class Faults : public testing::TestWithParam<FaultRig> {};

TEST_P(Faults, AreSeenInTimeAndStopTheArmsTogetherSoak) {
  const FaultRig& rig = GetParam();
  const long seeds = Seeds();
  const FaultRuns runs = RunFaults(rig, seeds, KeptIn("rows", rig));
  std::printf("%s: %zu runs\n", rig.name, runs.due);
  for (std::size_t i = 0; i < predictor::Faults().size(); ++i) {
    const Fault& fault = predictor::Faults()[i];
    if (!Concerns(fault, rig)) continue;
    std::vector<const FaultOutcome*> of_it;
    for (const FaultRun& run : runs.all) {
      if (run.fault != i || run.second >= 0) continue;
      of_it.push_back(&run.outcome);
      EXPECT_TRUE(run.outcome.well)
          << fault.ToString() << ", seed " << run.seed << ": " << run.outcome.why.data();
    }
    EXPECT_EQ(of_it.size(), static_cast<std::size_t>(seeds)) << fault.ToString();
    if (!of_it.empty()) PrintRow(fault, of_it);
    const bool ran =
        std::any_of(of_it.begin(), of_it.end(), [](const auto* run) { return run->ran; });
    EXPECT_TRUE(ran || fault.expect != Expect::kAnyEnd || seeds < 6) << fault.ToString();
  }
  ExpectAudited(runs);
}

// Two faults occur at once, or one occurs during the stop that the other caused. The arms must come
// to rest and stay at rest.
TEST_P(Faults, InPairsEndAtRestSoak) {
  const FaultRig& rig = GetParam();
  const FaultRuns runs = RunFaultPairs(rig, Pairs(), KeptIn("pairs", rig));
  std::set<std::pair<int, int>> numbers;
  for (const FaultRun& run : runs.all) {
    if (run.second < 0) continue;
    numbers.insert(std::minmax(predictor::Faults()[run.fault].number,
                               predictor::Faults()[static_cast<std::size_t>(run.second)].number));
    EXPECT_TRUE(run.outcome.well)
        << predictor::Faults()[run.fault].ToString() << ", then "
        << predictor::Faults()[static_cast<std::size_t>(run.second)].ToString() << ", seed "
        << run.seed << ": " << run.outcome.why.data();
  }
  EXPECT_GT(runs.due, 0U);
  ExpectAudited(runs);
  std::erase_if(numbers, [](const auto& pair) { return pair.first == pair.second; });
  std::printf("%s: %zu ordered pairs of faults, %zu pairs of numbers\n", rig.name, runs.due,
              numbers.size());
}

// Each fault that stops the run or causes a warning must have expected words, and all expected
// words must belong to a fault.
TEST(FaultWords, AreRequiredAfterEachReportedFault) {
  std::set<const FaultWords*> used;
  for (const Fault& fault : predictor::Faults()) {
    const FaultWords* words = WordsOf(fault);
    used.insert(words);
    const bool reported =
        !fault.upon && (fault.expect == Expect::kWarned || fault.expect == Expect::kHold ||
                        fault.expect == Expect::kPowerOff);
    EXPECT_TRUE(words != nullptr || !reported) << fault.ToString();
  }
  for (const FaultWords& words : AllFaultWords())
    EXPECT_TRUE(used.contains(&words)) << words.number << " " << words.fault;
}

// The judge must not accept silence, other words, or the name of the wrong hand.
TEST(FaultWords, AreThoseOfTheFaultAndOfItsHandFirst) {
  const auto& all = predictor::Faults();
  const auto silent = std::find_if(all.begin(), all.end(), [](const Fault& fault) {
    return fault.ToString() == "3 sensor silent";
  });
  ASSERT_NE(silent, all.end());
  const auto well = [&](const std::string& reported, int hand) {
    FaultOutcome outcome;
    outcome.SetMessage(reported);
    JudgeMessage(*silent, hand, &outcome);
    return outcome.well;
  };
  const auto cause = [](StopCause why, int hand, Quantity quantity) {
    return CauseWords({why, static_cast<std::int8_t>(hand), 0.02, 0.01, quantity}) + ".";
  };
  const std::string left = cause(StopCause::kStale, 0, Quantity::kSensorAge);
  EXPECT_TRUE(well(left, 0));
  EXPECT_FALSE(well(left, 1));
  EXPECT_FALSE(well(left + " The right sensor too.", 1));
  EXPECT_FALSE(well(cause(StopCause::kStale, -1, Quantity::kSensorAge), 0));
  EXPECT_FALSE(well(cause(StopCause::kStale, 0, Quantity::kArmAge), 0));
  EXPECT_FALSE(well(cause(StopCause::kDevice, 0, Quantity::kNone), 0));
  EXPECT_FALSE(well("", 0));
}

// Each pair of the numbers 1 to 33 must occur on some rig. Faults that are refused before the run
// or that a run cannot detect are excepted.
TEST(FaultPairs, AreOfAllNumbersThatCanComeTogether) {
  const std::set<int> never = {14, 32, 33};  // versions; the wall clock; real-time priority
  std::set<std::pair<int, int>> together;
  for (const FaultRig& rig : FaultRigs())
    for (const Fault& first : predictor::Faults())
      for (const Fault& second : predictor::Faults())
        if (HavePair(first, second, rig)) together.insert(std::minmax(first.number, second.number));
  int pairs = 0;
  for (int i = 1; i <= 33; ++i)
    for (int j = i + 1; j <= 33; ++j) {
      const bool meant = !never.contains(i) && !never.contains(j);
      EXPECT_EQ(together.contains({i, j}), meant) << i << " and " << j;
      pairs += together.contains({i, j}) ? 1 : 0;
    }
  std::printf("%d of 528 pairs of numbers\n", pairs);
}

INSTANTIATE_TEST_SUITE_P(faults, Faults, testing::ValuesIn(FaultRigs()),
                         [](const testing::TestParamInfo<FaultRig>& rig) {
                           std::string name = rig.param.name;
                           std::erase_if(name, [](char c) { return c == ' '; });
                           return name;
                         });

// For debugging, PREDICTOR_TRACE="rig/fault/seed" prints every tick of the stop.
TEST(Fault, DISABLED_Trace) {
  const char* text = std::getenv("PREDICTOR_TRACE");
  ASSERT_NE(text, nullptr);
  std::istringstream words(text);
  std::string rig_name, fault_name, seed;
  std::getline(words, rig_name, '/');
  std::getline(words, fault_name, '/');
  std::getline(words, seed);
  for (const FaultRig& rig : FaultRigs())
    for (const predictor::Fault& fault : predictor::Faults()) {
      if (rig.name != rig_name || fault.ToString() != fault_name) continue;
      if (fault.alone) {
        FaultOutcome outcome;
        const std::string audit = "/tmp/predictor-audit-trace";
        fault.alone(rig, std::stoull(seed), audit, &outcome);
        std::printf("%s%s\n%.0f ms, %.1f mm; see %s\n", outcome.message.data(), outcome.why.data(),
                    1e3 * outcome.time, 1e3 * outcome.distance, audit.c_str());
        continue;
      }
      Bench bench(OptionsOf(rig, std::stoull(seed)));
      ASSERT_TRUE(bench.Start());
      bench.Pass(TimeOf(fault.ToString(), std::stoull(seed)));
      RandomStream random(std::stoull(seed), fault.name);  // the same choice as on the bench
      const std::vector<int> hands = HandsWith(fault.carrier, rig);
      {
        const int hand = hands[random.Next() % hands.size()];
        std::printf("%s hand\n", kHandNames[static_cast<std::size_t>(hand)]);
        if (fault.before) fault.before(bench, hand);
        fault.inject(bench, hand);
        const auto relative = [&bench] {
          const auto& handles = bench.rig().rig().true_handles();
          return Vector3(handles[1].X_W.p - handles[0].X_W.p);
        };
        const Vector3 begun = relative();
        for (int k = 0; k < 600; ++k) {
          const auto& handles = bench.rig().rig().true_handles();
          const auto norm = [&](std::size_t i) {
            return Eigen::Map<const Vector6>(bench.record().hands[i].command.data()).norm();
          };
          const Vector3 apart = 1e3 * (relative() - begun);
          std::printf(
              "%4d %-9s handles %.4f %.4f m/s, commands %.5f %.5f rad/s, apart %.2f %.2f %.2f mm\n",
              k, Name(bench.emulator().state()), handles[0].V_W.head<3>().norm(),
              handles[1].V_W.head<3>().norm(), norm(0), norm(1), apart[0], apart[1], apart[2]);
          bench.Tick();
        }
      }
    }
}

// If the loop hangs, the controllers must stop the arms on their own.
TEST(Loop, ThatHangsStopsTheArms) {
  BenchOptions options;
  options.scenario = PREDICTOR_SOURCE_DIR "/scenarios/dual_ur5.yaml";
  Bench bench(options);
  ASSERT_TRUE(bench.Start());
  bench.Pass(2.5);
  bench.Hang(kWatchdog + 0.3);
  for (const FrameMotion& handle : bench.rig().rig().true_handles())
    EXPECT_LT(handle.V_W.norm(), 1e-3);
}

}  // namespace
}  // namespace predictor
