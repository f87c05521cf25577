// Tests that the program judges the person during a run without affecting the run.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child.h"
#include "support/soak.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

class LiveEvaluationOfARun : public testing::Test {
 protected:
  int Run(const std::string& file, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"run", Scenario("box_9kg"), "--no-viewer", "--duration",
                                          "2",   "--record",          file};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Child child(arguments);
    const int code = child.Wait();
    said_ = child.output() + child.errors();
    return code;
  }
  // The file's preamble is not compressed, so this function finds the topic by its name.
  static bool HasTopic(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    return bytes.find("/person/state") != std::string::npos;
  }
  static int Verify(const std::string& file) { return Child({"verify", file}).Wait(); }

  const test::TemporaryFolder folder_;
  const std::string file_ = folder_.path() / "run.mcap";
  std::string said_;
};

TEST_F(LiveEvaluationOfARun, IsRecordedAndTheTicksAreStillComputedAgainBitForBit) {
  ASSERT_EQ(Run(file_), 0) << said_;
  EXPECT_TRUE(HasTopic(file_));
  EXPECT_EQ(Verify(file_), 0);
  const std::string mended = folder_.path() / "run.repaired.mcap";
  EXPECT_EQ(Child({"repair", file_}).Wait(), 0);
  EXPECT_TRUE(HasTopic(mended));
}

TEST_F(LiveEvaluationOfARun, CanBeSwitchedOff) {
  ASSERT_EQ(Run(file_, {"--no-evaluation"}), 0) << said_;
  EXPECT_FALSE(HasTopic(file_));
}

TEST_F(LiveEvaluationOfARun, IsLeftOutIfThePlaceIsNotKnown) {
  ASSERT_EQ(Run(file_, {"--set", "operator.stance=null"}), 0) << said_;
  EXPECT_FALSE(HasTopic(file_));
}

// Returns the duration that one tick in a thousand exceeds [us].
double TickOf(bool evaluated) {
  Child child({"run", Scenario("box_9kg"), "--no-viewer", "--duration", "10", "--quiet", "--json",
               "-", evaluated ? "--evaluation" : "--no-evaluation"});
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  const auto json = nlohmann::json::parse(child.output(), nullptr, false);
  return json.is_object() ? json["timing_us"]["tick"]["p999"].get<double>() : NAN;
}

// Returns the upper bound of a one-sided 95 % interval of the mean, from Student's distribution.
double UpperBound(const std::vector<double>& x) {
  constexpr double kQuantile = 1.729;  // of 19 degrees of freedom
  const auto n = static_cast<double>(x.size());
  double mean = 0, squares = 0;
  for (const double value : x) mean += value / n;
  for (const double value : x) squares += (value - mean) * (value - mean);
  return mean + kQuantile * std::sqrt(squares / (n - 1) / n);
}

// The runs are made in pairs, and the order in a pair alternates. The interval is narrow only on an
// otherwise idle computer.
TEST(LiveEvaluation, DoesNotDelayTheTickSoak) {
  const long pairs = Count(0, 20);
  if (pairs == 0) GTEST_SKIP() << "Only ./dev soak takes the time.";
  std::vector<double> differences;
  double base = 0;
  for (long pair = 0; pair < pairs; ++pair) {
    const bool first = pair % 2 == 0;
    const double one = TickOf(first), other = TickOf(!first);
    const double with = first ? one : other, without = first ? other : one;
    std::printf("pair %ld: p99.9 of the tick %.0f us with, %.0f us without\n", pair + 1, with,
                without);
    differences.push_back(with - without);
    base += without / static_cast<double>(pairs);
  }
  const double bound = UpperBound(differences) / base;
  std::printf("upper 95 %% bound of the difference: %.1f %% of %.0f us\n", 100 * bound, base);
  EXPECT_LE(bound, 0.10);
}

}  // namespace
}  // namespace predictor
