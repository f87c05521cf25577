// Tests words and numbers in plots, names of runs, and values computed for plots.
#include "report/plot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "report/oscillation_index.h"
#include "report/run_data.h"
#include "report/run_names.h"

namespace predictor {
namespace {

TEST(Plot, NumbersHaveSensibleDigits) {
  EXPECT_EQ(Significant(0.012345), "0.0123");
  EXPECT_EQ(Significant(12345), "12345");
  EXPECT_EQ(Significant(-3.7945e-5, 3, 3), "0");
  EXPECT_EQ(Significant(NAN), "–");
  EXPECT_EQ(Round(30), "30");
  EXPECT_EQ(Round(0.300), "0.3");
  EXPECT_EQ(Round(20.053), "20.05");
}

TEST(ShortNames, TellFilesApartByWhatIsNotCommon) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(ShortNames({{"runs/bar_circle_2026-01-31_14-05-09.mcap", ""},
                        {"runs/bar_circle_2026-01-31_14-07-22.mcap", ""}}),
            (Names{"14-05-09", "14-07-22"}));
  EXPECT_EQ(ShortNames({{"a/real_run.mcap", ""}, {"a/emulated_run.mcap", ""}}),
            (Names{"real", "emulated"}));
  EXPECT_EQ(ShortNames({{"box.mcap", ""}, {"box_2.mcap", ""}}), (Names{"box", "box_2"}));
}

TEST(ShortNames, TakeTheFolderWhereFilesHaveOneName) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(ShortNames({{"/x/first/run.mcap", ""}, {"/x/second/run.mcap", ""}}),
            (Names{"first", "second"}));
  EXPECT_EQ(ShortNames({{"/x/a/b/run.mcap", ""}, {"/x/c/b/run.mcap", ""}}), (Names{"a", "c"}));
  EXPECT_EQ(ShortNames({{"run.mcap", ""}, {"run.mcap", ""}}), (Names{"1: run", "2: run"}));
}

TEST(ShortNames, AreTheConditionsIfThoseTellThemApart) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", "emulated"}}), (Names{"real", "emulated"}));
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", "real"}}), (Names{"a", "b"}));
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", ""}}), (Names{"a", "b"}));
  EXPECT_EQ(ShortNames({{"a.mcap", std::string(41, 'x')}, {"b.mcap", "y"}}), (Names{"a", "b"}));
}

// A force with a slow component and a tremor at f: the tremor's share is known.
TEST(OscillationIndex, IsThePartOfThePowerFromThreeToTenHertz) {
  for (const double f : {4.0, 6.25, 9.0}) {
    OscillationIndex index(0.001);
    for (int i = 0; i < 9'000; ++i) {
      const double t = 1e-3 * i;
      index.Add(t, Vector3(3 * std::sin(2 * M_PI * t), 2 * std::cos(2 * M_PI * f * t), 7));
    }
    ASSERT_EQ(index.windows().size(), 3u);
    for (const auto& window : index.windows()) {
      EXPECT_NEAR(window.index, 4.0 / (4 + 9), 0.01) << f;
      EXPECT_NEAR(window.rms, 2 / std::sqrt(2), 0.02) << f;
      EXPECT_NEAR(window.total, std::sqrt(6.5), 0.03) << f;
    }
    EXPECT_NEAR(index.windows()[1].time, 4, 0.01);
  }
}

TEST(PortEnergy, TellsWhatCameBackAndHowLowTheSumFell) {
  PortEnergy port;
  for (int i = 0; i < 1000; ++i) port.Add(2, 0.001);
  for (int i = 0; i < 1000; ++i) port.Add(-3, 0.001);
  for (int i = 0; i < 1000; ++i) port.Add(4, 0.001);
  EXPECT_NEAR(port.sum, 3, 1e-9);
  EXPECT_NEAR(port.lowest, -1, 1e-9);
  EXPECT_NEAR(port.returned, 3, 1e-9);
  EXPECT_EQ(port.peak_return, 3);
  EXPECT_EQ(port.episodes, 1);
}

}  // namespace
}  // namespace predictor
