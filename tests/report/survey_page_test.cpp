// Tests the page about the answers to a questionnaire.
#include "report/survey_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/questionnaire.h"
#include "support/text.h"

namespace predictor {
namespace {

std::size_t Count(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST(SurveyPage, ComparesThePapersAnswersWithNeutral) {
  const std::string page = SurveyPage(SummariseSurvey(PapersAnswers()));
  EXPECT_NE(page.find("Compared with neutral (0)"), std::string::npos);
  EXPECT_NE(page.find("<td>0.0001</td><td>0.0006</td>"), std::string::npos);      // S2
  EXPECT_NE(page.find("<td>&lt;0.0001</td><td>0.0002</td>"), std::string::npos);  // S1
}

TEST(SurveyPage, PlotHasACrossForEachAnswer) {
  LikertSeries series{"Emulated", {}};
  series.counts[0] = {1, 2, 3, 4, 7};
  series.counts[5] = {0, 0, 0, 0, 60};
  const Plot plot = LikertPlot({series});
  ASSERT_EQ(plot.panels.size(), 1u);
  ASSERT_EQ(plot.panels[0].series.size(), 2u);
  const PlotSeries &answers = plot.panels[0].series[0], &means = plot.panels[0].series[1];
  EXPECT_EQ(answers.x->size(), 17u + 60u);
  for (int score = -2; score <= 2; ++score) {
    const auto near = [&](double y) { return std::abs(y - score) < 0.4; };
    EXPECT_EQ(std::count_if(answers.y->begin(), answers.y->end(), near),
              score == 2 ? 67 : score + 3);
  }
  for (const double y : *answers.y) EXPECT_TRUE(std::isfinite(y));
  ASSERT_EQ(means.x->size(), 2u);
  EXPECT_DOUBLE_EQ((*means.y)[0], 14.0 / 17);
  EXPECT_DOUBLE_EQ((*means.y)[1], 2);
  EXPECT_NEAR((*means.error)[0], std::sqrt((4 + 2 + 4 + 28 - 196.0 / 17) / 16), 1e-12);
  EXPECT_EQ((*means.error)[1], 0);
  EXPECT_EQ(plot.x.names.size(), kStatements);
  EXPECT_EQ(plot.panels[0].y.names.front(), "Strongly disagree (−2)");
}

// No two crosses may coincide, and each cross must lie within the width of its statement.
TEST(SurveyPage, CrossesOfManyAnswersStandBesideEachOther) {
  LikertSeries series{"Emulated", {}};
  series.counts[3] = {5, 17, 30, 60, 2};
  const Plot plot = LikertPlot({series, series});
  std::vector<std::pair<double, double>> places;
  for (const PlotSeries& one : plot.panels[0].series) {
    if (one.error) continue;
    for (std::size_t k = 0; k < one.x->size(); ++k) places.emplace_back((*one.x)[k], (*one.y)[k]);
  }
  ASSERT_EQ(places.size(), 2u * 114u);
  for (const auto& [x, y] : places) EXPECT_NEAR(x, 3, 0.5);
  std::sort(places.begin(), places.end());
  EXPECT_EQ(std::unique(places.begin(), places.end()), places.end());
}

TEST(SurveyPage, IsSelfContainedAndTrustsNoComment) {
  std::vector<StoredAnswer> answers = {Stored("ABCDEFGF", Condition::kEmulated, 2),
                                       Stored("ABCDEFGF", Condition::kReal, 1)};
  answers[0].answer.comment = "<script>alert(1)</script> & \"so\"";
  const std::string page = WithoutScript(SurveyPage(SummariseSurvey(answers)));
  EXPECT_EQ(page.find("<script>"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;alert(1)&lt;/script&gt; &amp;"), std::string::npos);
  EXPECT_EQ(page.find("ABCDEFGF"), std::string::npos);  // a report needs no pseudonym
  EXPECT_EQ(Count(page, "http"), Count(page, "http-equiv"));
  EXPECT_EQ(Count(page, "<table>"), Count(page, "</table>"));
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace predictor
