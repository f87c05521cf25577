// Tests the words and numbers in plots, the headings of pages, and the names of runs.
#include "report/plot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "report/page.h"
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

// A scenario's name may contain characters that change the direction of text.
TEST(Page, ShowsHiddenCharactersInItsHeadings) {
  ReportPage page("Box \u202egk 9", "");
  page.Section("a", "Part\u2066 <1>");
  page.Folded("More\u200f", "text");
  const std::string html = page.Finish();
  for (const char* part : {"<title>Box \\u202egk 9</title>", "<h1>Box \\u202egk 9</h1>",
                           "<h2>Part\\u2066 &lt;1&gt;</h2>", "<summary>More\\u200f</summary>"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

TEST(ShortNames, DistinguishFilesByWhatIsNotCommon) {
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

TEST(ShortNames, AreTheConditionsIfThoseDistinguishThem) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", "emulated"}}), (Names{"real", "emulated"}));
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", "real"}}), (Names{"a", "b"}));
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", ""}}), (Names{"a", "b"}));
  EXPECT_EQ(ShortNames({{"a.mcap", std::string(41, 'x')}, {"b.mcap", "y"}}), (Names{"a", "b"}));
}

}  // namespace
}  // namespace predictor
