// Tests whether the intervals of a continued run contain what simulated people would have done.
//
// The parameters of IntentModel were chosen with the seeds 1000 to 1400. The seeds below were fixed
// earlier and were not used to choose these parameters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "analysis/continuation/continuation.h"
#include "evaluation/statistics_samples.h"
#include "stopped_people.h"
#include "support/soak.h"

namespace predictor {
namespace {

constexpr std::uint64_t kInsideSeed = 20000, kOutsideSeed = 30000;

struct Coverage {
  // counts of values below, within and above their interval, by kind and for "all"
  std::map<std::string, std::array<int, 3>> counts;
  // of the intervals [N], and relative to the true value
  std::vector<double> widths, shares;
  // all people, those whom no limit stops, and those whose true run ends with a fault
  int runs = 0, others = 0, unknown = 0;

  double share() const {
    const auto& n = counts.at("all");
    return n[1] / static_cast<double>(n[0] + n[1] + n[2]);
  }
  void Print(const char* title) const {
    std::printf("%s: %d people, %d not stopped by a limit, %d whose true run ends with a fault\n",
                title, runs, others, unknown);
    for (const auto& [kind, n] : counts)
      std::printf("  %-16s %3d below, %3d within, %3d above\n", kind.c_str(), n[0], n[1], n[2]);
    std::printf("  coverage %.1f %%, median width %.1f N, %.2f of the value\n", 100 * share(),
                Median(widths), Median(shares));
  }
};

// Simulates people until the true outcome of `stops` stops is known.
Coverage Study(std::uint64_t seed, long stops, bool outside, int draws) {
  Coverage result;
  const ArmDistribution arms = ArmDistribution::Prior(HandSpec());
  while (static_cast<long>(result.shares.size()) < stops) {
    const StoppedPerson person = DrawPerson(seed++, outside);
    ++result.runs;
    const auto stop = RunToStop(person);
    if (!stop) {
      ++result.others;
      continue;
    }
    ContinueOptions options;
    options.draws = draws;
    options.horizon = 1;
    options.reference = true;
    options.joint_loads = false;
    options.recorded_operator = person.Maker();
    const Continuation c = Continue(*stop, arms, options);
    if (c.reference->ending == Ending::kFault) {
      ++result.unknown;
      continue;
    }
    const Interval90 peak = c.IntervalOf(&ContinuedRun::peak_force);
    const double truth = c.reference->peak_force;
    const std::size_t side = truth < peak.low.value ? 0 : truth > peak.high.value ? 2 : 1;
    ++result.counts[person.what][side];
    ++result.counts["all"][side];
    result.widths.push_back(peak.high.value - peak.low.value);
    result.shares.push_back(result.widths.back() / truth);
  }
  return result;
}

// The interval extends from the second smallest to the second largest of 39 draws. With a
// probability of 90 %, a further draw lies in this interval.
constexpr int kDraws = 39;

TEST(ContinuationCoverage, ContainsWhatSimulatedPeopleWouldHaveDoneSoak) {
  const Coverage inside = Study(kInsideSeed, Count(8, 200), false, kDraws);
  inside.Print("Inside the prior");
  // If the intervals are correct, the probability that fewer than five of eight contain the true
  // value is 0.005.
  EXPECT_GE(inside.share(), InFull() ? 0.84 : 0.6);
  EXPECT_LE(inside.share(), InFull() ? 0.96 : 1);
  EXPECT_LE(Median(inside.shares), 1);
}

// According to the prior, these arms and reflexes are very unlikely. The only requirement is that
// more than half of the intervals contain the true value.
TEST(ContinuationCoverage, OfPeopleOutsideThePriorIsReportedSoak) {
  const Coverage outside = Study(kOutsideSeed, Count(4, 200), true, kDraws);
  outside.Print("Outside the prior");
  EXPECT_GE(outside.share(), 0.5);
}

}  // namespace
}  // namespace predictor
