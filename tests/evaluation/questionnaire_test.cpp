// Tests how answers are read and written, the paper's table, and the report on a study.
#include "evaluation/questionnaire.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "evaluation/questionnaire_files.h"
#include "evaluation/questionnaire_report.h"
#include "evaluation/questionnaire_table.h"
#include "scenario/pseudonym.h"
#include "support/questionnaire.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// ---- the paper's table

TEST(PaperTable, EveryRowIsReachedByWholeAnswersOfSeventeen) {
  const std::array<std::size_t, kStatements> solutions = {1, 2, 2, 2, 2, 1, 2, 1};
  for (std::size_t i = 0; i < kStatements; ++i)
    EXPECT_EQ(MatchingCounts(PaperTable()[i].figures, kPaperPeople).size(), solutions[i])
        << Statements()[i].name;
}

TEST(PaperTable, WithTheTextsRemarksOnlyS5AndS7HaveTwoSolutions) {
  const std::array<std::vector<ScoreCounts>, kStatements> expected = {{
      {{0, 0, 1, 7, 9}},
      {{0, 0, 3, 10, 4}},
      {{0, 0, 5, 11, 1}},
      {{0, 0, 3, 11, 3}},
      {{0, 0, 5, 4, 8}, {0, 1, 2, 7, 7}},
      {{0, 0, 1, 2, 14}},
      {{0, 0, 3, 5, 9}, {0, 1, 0, 8, 8}},
      {{0, 0, 0, 12, 5}},
  }};
  for (std::size_t i = 0; i < kStatements; ++i) {
    const PaperRow& row = PaperTable()[i];
    EXPECT_EQ(MatchingCounts(row.figures, kPaperPeople, row.lowest), expected[i])
        << Statements()[i].name;
  }
}

// The solutions reproduce the printed digits, both in floating point and with the general
// statistics.
TEST(PaperTable, SolutionsHaveThePrintedFigures) {
  const std::array<std::pair<const char*, const char*>, kStatements> printed = {{{"1.47", "0.62"},
                                                                                 {"1.06", "0.66"},
                                                                                 {"0.76", "0.56"},
                                                                                 {"1.00", "0.61"},
                                                                                 {"1.18", "0.88"},
                                                                                 {"1.76", "0.56"},
                                                                                 {"1.35", "0.79"},
                                                                                 {"1.29", "0.47"}}};
  const std::array<double, kStatements> medians = {2, 1, 1, 1, 1, 2, 1, 1};
  for (std::size_t i = 0; i < kStatements; ++i) {
    const PaperRow& row = PaperTable()[i];
    for (const ScoreCounts& counts : MatchingCounts(row.figures, kPaperPeople)) {
      const StatementSummary summary = SummariseCounts(counts);
      char mean[16], deviation[16];
      std::snprintf(mean, sizeof mean, "%.2f", summary.mean);
      std::snprintf(deviation, sizeof deviation, "%.2f", summary.deviation);
      EXPECT_STREQ(mean, printed[i].first);
      EXPECT_STREQ(deviation, printed[i].second);
    }
    for (const ScoreCounts& counts : MatchingCounts(row.figures, kPaperPeople, row.lowest)) {
      const double expected = counts == ScoreCounts{0, 0, 3, 5, 9} ? 2 : medians[i];
      EXPECT_EQ(MedianOf(counts), expected) << Statements()[i].name;
    }
  }
}

TEST(PaperTable, RoundsExactlyAndHalvesAwayFromZero) {
  // One answer of eight differs from the others by 1. The mean 1/8 = 0.125 is rounded to 0.13, and
  // the deviation is √(1/8) = 0.35355.
  EXPECT_EQ(FiguresOf({0, 0, 7, 1, 0}), (RoundedFigures{13, 35}));
  EXPECT_EQ(FiguresOf({0, 1, 7, 0, 0}), (RoundedFigures{-13, 35}));
  EXPECT_EQ(FiguresOf({0, 0, 0, 0, 17}), (RoundedFigures{200, 0}));
  EXPECT_EQ(FiguresOf({1, 0, 0, 0, 1}), (RoundedFigures{0, 283}));  // √8
  EXPECT_TRUE(MatchingCounts({148, 62}, kPaperPeople).empty());     // no set of 17 answers has this
                                                                    // mean
}

TEST(PaperTable, MediansAreOrderStatistics) {
  EXPECT_EQ(MedianOf({1, 0, 0, 0, 1}), 0);
  EXPECT_EQ(MedianOf({0, 0, 1, 1, 0}), 0.5);
  EXPECT_EQ(MedianOf({3, 0, 0, 0, 2}), -2);
  EXPECT_TRUE(MedianOf({}) != MedianOf({}));
}

// ---- a single answer

Json Form() {
  Json answers;
  for (const Statement& s : Statements()) answers[s.name] = 1;
  return {{"type", "answer"}, {"consent", true}, {"condition", "emulated"}, {"answers", answers},
          {"age", 23},        {"sex", "female"}, {"comment", "Größe <b>"},  {"pseudonym", nullptr}};
}

// Returns the key and the message of the error with which the program refuses the form.
std::pair<std::string, std::string> Refused(const Json& form) {
  try {
    ParseSurveyForm(form.dump());
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).ends_with('.')) << error.what();
    return {error.key(), error.what()};
  }
  return {"accepted", ""};
}

TEST(SurveyForm, IsTakenAsItIs) {
  const SurveyAnswer answer = ParseSurveyForm(Form().dump());
  EXPECT_EQ(answer.condition, Condition::kEmulated);
  for (const auto& score : answer.scores) EXPECT_EQ(score, 1);
  EXPECT_EQ(answer.age, 23);
  EXPECT_EQ(answer.sex, "female");
  EXPECT_EQ(answer.comment, "Größe <b>");
  EXPECT_EQ(answer.pseudonym, "");
}

TEST(SurveyForm, MayLeaveOutOptionalAnswers) {
  Json form = Form();
  form["age"] = form["sex"] = form["answers"]["S3"] = nullptr;
  form.erase("comment");
  const SurveyAnswer answer = ParseSurveyForm(form.dump());
  EXPECT_FALSE(answer.age);
  EXPECT_FALSE(answer.scores[2]);
  EXPECT_TRUE(answer.scores[3]);
}

TEST(SurveyForm, RefusesWhatCannotBeInWords) {
  const auto with = [](const char* key, const Json& value) {
    Json form = Form();
    form[key] = value;
    return Refused(form).first;
  };
  const auto scored = [](const Json& value) {
    Json form = Form();
    form["answers"]["S4"] = value;
    return Refused(form).first;
  };
  for (const Json& consent : {Json(false), Json(nullptr), Json(1), Json("true")})
    EXPECT_EQ(with("consent", consent), "consent");
  for (const Json& score : {Json(3), Json(-3), Json(0.5), Json("1"), Json(true),
                            Json(18446744073709551615u), Json(-9223372036854775807)})
    EXPECT_EQ(scored(score), "S4") << score;
  for (const Json& age :
       {Json(0), Json(-5), Json(121), Json(23.5), Json("23"), Json(18446744073709551615u)})
    EXPECT_EQ(with("age", age), "age") << age;
  EXPECT_EQ(with("sex", "yes"), "sex");
  EXPECT_EQ(with("condition", "both"), "condition");
  EXPECT_EQ(with("comment", std::string(kLongestComment + 1, 'a')), "comment");
  EXPECT_EQ(with("comment", std::string("a\0b", 3)), "comment");
  EXPECT_EQ(with("pseudonym", "../../evil"), "pseudonym");
  EXPECT_EQ(with("pseudonym", "ABCDEFGI"), "pseudonym");  // contains an I
  EXPECT_EQ(with("name", "Alice"), "name");
  EXPECT_EQ(with("answers", Json::array()), "answers");
  Json form = Form();
  form["answers"]["S9"] = 1;
  EXPECT_EQ(Refused(form).first, "S9");
  form = Form();
  for (auto& [key, value] : form["answers"].items()) value = nullptr;
  EXPECT_EQ(Refused(form).first, "answers");
}

TEST(SurveyForm, CountsCharactersNotBytes) {
  Json form = Form();
  std::string comment;
  for (std::size_t i = 0; i < kLongestComment; ++i) comment += "ß";
  form["comment"] = comment;
  EXPECT_EQ(ParseSurveyForm(form.dump()).comment, comment);
}

TEST(SurveyForm, RefusesInvalidForms) {
  for (const char* text : {"", "[]", "null", "{", "\"a\"", "{\"consent\": true}"})
    EXPECT_THROW(ParseSurveyForm(text), InputError) << text;
  EXPECT_THROW(ParseSurveyForm(std::string(kLongestAnswer + 1, ' ')), InputError);
  EXPECT_THROW(ParseSurveyForm(std::string(10000, '[')), InputError);
  EXPECT_THROW(ParseSurveyForm("{\"comment\": \"\xff\"}"), InputError);
}

TEST(Pseudonym, IsDrawnAtRandomAndCanBeWrittenDown) {
  std::set<std::string> drawn;
  for (int i = 0; i < 200; ++i) {
    const std::string name = DrawPseudonym();
    EXPECT_TRUE(IsPseudonym(name)) << name;
    drawn.insert(name);
  }
  EXPECT_EQ(drawn.size(), 200u);
  EXPECT_FALSE(IsPseudonym(""));
  EXPECT_FALSE(IsPseudonym("abcdefgh"));
  EXPECT_FALSE(IsPseudonym(std::string(8, '\0')));
  EXPECT_FALSE(IsPseudonym("ABCDEFGFJ"));
}

// A mistyped pseudonym must not silently create a second person.
TEST(Pseudonym, IsKnownFromOneWithAWrongCharacter) {
  const std::string right = DrawPseudonym();
  for (std::size_t i = 0; i < right.size(); ++i)
    for (const char c : std::string("23456789ABCDEFGHJKLMNPQRSTUVWXYZ")) {
      std::string wrong = right;
      wrong[i] = c;
      EXPECT_EQ(IsPseudonym(wrong), c == right[i]) << wrong;
    }
}

// ---- files

class SurveyFiles : public ::testing::Test {
 protected:
  static SurveyAnswer Answer(const std::string& pseudonym, Condition condition, int score) {
    SurveyAnswer answer;
    answer.pseudonym = pseudonym;
    answer.condition = condition;
    answer.recording = std::string(Name(condition)) + ".mcap";
    answer.scores.fill(score);
    answer.age = 20 + score;
    answer.sex = "male";
    answer.comment = "said \"so\"\nand <i>so</i>";
    return answer;
  }
  std::string Text(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(SurveyFiles, KeepTheAnswers) {
  SurveyAnswer answer = Answer("ABCDEFGF", Condition::kEmulated, -2);
  answer.scores[4] = {};
  answer.age = {};
  const fs::path file = StoreSurveyAnswer(folder_, answer);
  EXPECT_EQ(file.filename(), "emulated.ABCDEFGF.emulated.survey.json");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  const auto read = ReadSurveyAnswers({folder_});
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].answer.scores, answer.scores);
  EXPECT_EQ(read[0].answer.age, answer.age);
  EXPECT_EQ(read[0].answer.sex, "male");
  EXPECT_EQ(read[0].answer.comment, answer.comment);
  EXPECT_EQ(read[0].answer.recording, "emulated.mcap");
  EXPECT_EQ(read[0].answer.pseudonym, "ABCDEFGF");
}

TEST_F(SurveyFiles, AreNeverWrittenOver) {
  StoreSurveyAnswer(folder_, Answer("ABCDEFGF", Condition::kReal, 1));
  try {
    StoreSurveyAnswer(folder_, Answer("ABCDEFGF", Condition::kReal, 2));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "pseudonym");
  }
  EXPECT_EQ(ReadSurveyAnswers({folder_})[0].answer.scores[0], 1);
  EXPECT_THROW(StoreSurveyAnswer(folder_ / "absent", Answer("ABCDEFGF", Condition::kReal, 1)),
               InputError);
}

TEST_F(SurveyFiles, AreRemovedAlone) {
  fs::create_directory(folder_ / "below");
  StoreSurveyAnswer(folder_, Answer("ABCDEFGF", Condition::kReal, 1));
  StoreSurveyAnswer(folder_ / "below", Answer("ABCDEFGF", Condition::kEmulated, 1));
  StoreSurveyAnswer(folder_, Answer("ABCDEFH2", Condition::kEmulated, 1));
  std::ofstream(folder_ / "run.ABCDEFGF.mcap") << "a recording";
  std::ofstream(folder_ / "run.ABCDEFGF.emulated.survey.json") << "cut o";
  EXPECT_EQ(RemoveSurveyAnswers({folder_}, "ABCDEFGF").size(), 3u);
  EXPECT_TRUE(fs::exists(folder_ / "run.ABCDEFGF.mcap"));
  ASSERT_EQ(ReadSurveyAnswers({folder_}).size(), 1u);
  EXPECT_TRUE(RemoveSurveyAnswers({folder_}, "ABCDEFGF").empty());
  EXPECT_THROW(RemoveSurveyAnswers({folder_}, "*"), InputError);
  EXPECT_THROW(RemoveSurveyAnswers({folder_ / "absent"}, "ABCDEFGF"), InputError);
}

TEST_F(SurveyFiles, NameTheInvalidOne) {
  const fs::path file = StoreSurveyAnswer(folder_, Answer("ABCDEFGF", Condition::kReal, 1));
  const std::string whole = Text(file);
  for (std::size_t length = 0; length + 2 < whole.size(); ++length) {
    std::ofstream(file) << whole.substr(0, length);
    try {
      ReadSurveyAnswers({file});
      FAIL() << length;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(file.string())) << error.what();
    }
  }
  std::ofstream(file) << std::string(kLongestAnswer * 3, ' ');
  EXPECT_THROW(ReadSurveyAnswers({file}), InputError);
  Json without = Json::parse(whole);
  without.erase("consent");
  std::ofstream(file) << without;
  EXPECT_THROW(ReadSurveyAnswers({file}), InputError);
}

// ---- reports

TEST(SurveyReport, CountsPeopleAndAnswers) {
  std::vector<StoredAnswer> answers = {Stored("A", Condition::kEmulated, 2),
                                       Stored("B", Condition::kEmulated, 1),
                                       Stored("B", Condition::kReal, 0)};
  answers[0].answer.age = 20;
  answers[1].answer.age = 25;
  answers[0].answer.sex = "female";
  answers[1].answer.scores[6] = {};
  const SurveyReport report = SummariseSurvey(answers);
  EXPECT_EQ(report.people, 2);
  EXPECT_EQ(report.paired_people, 1);
  const ConditionSummary& emulated =
      report.conditions[static_cast<std::size_t>(Condition::kEmulated)];
  EXPECT_EQ(emulated.people, 2);
  EXPECT_EQ(emulated.statements[0].counts, (ScoreCounts{0, 0, 0, 1, 1}));
  EXPECT_DOUBLE_EQ(emulated.statements[0].mean, 1.5);
  EXPECT_DOUBLE_EQ(emulated.statements[0].deviation, std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(emulated.statements[0].median, 1.5);
  EXPECT_DOUBLE_EQ(emulated.statements[0].agreeing, 1);
  EXPECT_EQ(emulated.statements[6].answers, 1);
  EXPECT_DOUBLE_EQ(emulated.age_mean, 22.5);
  EXPECT_EQ(emulated.female, 1);
  EXPECT_EQ(report.paired[0].count, 1);
  EXPECT_EQ(report.paired[6].count, 0);
}

TEST(SurveyReport, ComparesPairsByTheSignedRanks) {
  std::vector<StoredAnswer> answers;
  // S1 has eight differences of +1. S2 has seven differences of +1 and one of −1. All other
  // differences are zero.
  for (int i = 0; i < 8; ++i) {
    const std::string person = "P" + std::to_string(i);
    answers.push_back(Stored(person, Condition::kReal, 0));
    answers.push_back(Stored(person, Condition::kEmulated, 0));
    answers.back().answer.scores[0] = 1;
    answers.back().answer.scores[1] = i == 0 ? -1 : 1;
  }
  const SurveyReport report = SummariseSurvey(answers);
  EXPECT_EQ(report.paired_people, 8);
  EXPECT_DOUBLE_EQ(report.paired[0].test.p, 2.0 / 256);
  EXPECT_DOUBLE_EQ(report.paired[0].shift.estimate, 1);
  EXPECT_DOUBLE_EQ(report.paired[0].adjusted, 8 * 2.0 / 256);
  EXPECT_DOUBLE_EQ(report.paired[1].test.p, 2 * 9.0 / 256);  // at most one of eight is negative
  EXPECT_EQ(report.paired[2].test.zeros, 8u);
  EXPECT_EQ(report.paired[2].test.p, 1);
}

// Of n values with the same sign, the two-sided signed-rank test gives p = 2 / 2^n.
TEST(SurveyReport, StatesThatFewPeopleCannotShowADifference) {
  std::vector<StoredAnswer> answers;
  const auto few_with = [&](std::size_t people) {
    while (answers.size() < people)
      answers.push_back(
          Stored(std::string(1, static_cast<char>('A' + answers.size())), Condition::kEmulated, 1));
    return TooFewText(SummariseSurvey(answers).conditions[0].from_neutral) +
           TooFewText(SummariseSurvey(answers).conditions[1].from_neutral);
  };
  EXPECT_TRUE(few_with(1).starts_with("The smallest p that 1 value can give is 1.0000."));
  EXPECT_TRUE(few_with(5).starts_with("The smallest p that 5 values can give is 0.0625."));
  EXPECT_NE(SurveyTable(SummariseSurvey(answers)).find(few_with(5)), std::string::npos);
  EXPECT_EQ(few_with(6), "");
}

TEST(SurveyReport, RefusesNoPeopleAndDuplicates) {
  EXPECT_THROW(SummariseSurvey({}), InputError);
  EXPECT_THROW(
      SummariseSurvey({Stored("A", Condition::kReal, 1), Stored("A", Condition::kReal, 2)}),
      InputError);
}

TEST(SurveyReport, ShowsThePapersStudyAsThePaperDoes) {
  const SurveyReport report = SummariseSurvey(PapersAnswers());
  const std::string table = SurveyTable(report);
  for (const char* line : {"S1    17    1.47 ± 0.62      2.0", "S3    17    0.76 ± 0.56      1.0",
                           "S6    17    1.76 ± 0.56      2.0", "S8    17    1.29 ± 0.47      1.0"})
    EXPECT_NE(table.find(line), std::string::npos) << line << "\n" << table;
  EXPECT_NE(table.find("No one answered exactly once for each"), std::string::npos);
}

// The expected values were computed with scipy 1.17.1: wilcoxon(x, zero_method="wilcox",
// method=PermutationMethod(n_resamples=inf)), which enumerates all signs. The shift is the median
// of the 153 Walsh averages. The limits of the interval are the 35th and the 119th of these
// averages, as in the published tables for 17 differences. Holm's correction was computed by hand.
TEST(SurveyReport, ComparesThePapersAnswersWithNeutral) {
  struct Expected {
    double p, adjusted, shift, lower, upper;  // p in units of 2^−16
    std::size_t zeros;
  };
  const std::array<Expected, kStatements> expected = {{{2, 14, 1.5, 1, 2, 1},
                                                       {8, 40, 1, 0.5, 1.5, 3},
                                                       {32, 64, 1, 0.5, 1, 5},
                                                       {8, 40, 1, 0.5, 1.5, 3},
                                                       {32, 64, 1, 0.5, 2, 5},
                                                       {2, 14, 2, 1.5, 2, 1},
                                                       {8, 40, 1.5, 1, 2, 3},
                                                       {1, 8, 1, 1, 1.5, 0}}};
  const SurveyReport report = SummariseSurvey(PapersAnswers());
  const ConditionSummary& c = report.conditions[static_cast<std::size_t>(Condition::kEmulated)];
  for (std::size_t i = 0; i < kStatements; ++i) {
    const ShiftSummary& s = c.from_neutral[i];
    EXPECT_EQ(s.count, kPaperPeople) << i;
    EXPECT_EQ(s.test.zeros, expected[i].zeros) << i;
    EXPECT_DOUBLE_EQ(s.test.p * 65536, expected[i].p) << i;
    EXPECT_DOUBLE_EQ(s.adjusted * 65536, expected[i].adjusted) << i;
    EXPECT_EQ(s.shift.estimate, expected[i].shift) << i;
    EXPECT_EQ(s.shift.lower, expected[i].lower) << i;
    EXPECT_EQ(s.shift.upper, expected[i].upper) << i;
    EXPECT_GE(s.shift.confidence, 0.95) << i;
  }
  const std::string table = SurveyTable(report);
  EXPECT_NE(table.find("compared with neutral (0)"), std::string::npos) << table;
  EXPECT_NE(table.find("S1    17      1   +1.50"), std::string::npos) << table;
}

TEST(SurveyTable, ASingleAgeHasNoDeviation) {
  ConditionSummary c;
  c.ages = 1;
  c.age_mean = 23;
  c.age_deviation = NAN;
  EXPECT_EQ(AgeText(c), "23");
  c.ages = 2;
  c.age_deviation = 1.5;
  EXPECT_EQ(AgeText(c), "23.00 ± 1.50");
}

}  // namespace
}  // namespace predictor
