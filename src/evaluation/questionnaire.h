// The questionnaire of the paper's user study. This file defines the statements S1 to S8 and the
// answers of one person.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace predictor {

inline constexpr std::size_t kStatements = 8;
// Levels of agreement, from −2 (strongly disagree) to 2 (strongly agree).
inline constexpr int kLowestScore = -2, kHighestScore = 2;
inline constexpr std::size_t kScores = 5;

// The number of people who gave each score of a statement, starting with the lowest score.
using ScoreCounts = std::array<int, kScores>;

struct Statement {
  const char* name;    // "S1"
  const char* aspect;  // "Usability"
  const char* text;
};
// Returns the statements in the wording of the paper.
const std::array<Statement, kStatements>& Statements();
// Returns the names of the levels ("Strongly disagree" and so on), starting with the lowest score.
const std::array<const char*, kScores>& ScoreNames();

// The system that the person used before answering: the real system (mode: direct) or its
// emulation.
enum class Condition : int { kReal, kEmulated };
inline constexpr std::size_t kConditions = 2;
const char* Name(Condition condition);  // "real", "emulated"
std::optional<Condition> ConditionNamed(std::string_view name);

// Returns the text of the consent that a person gives before the first question. Stored answers
// contain the version of this text.
const char* ConsentText();
inline constexpr int kConsentVersion = 1;

inline constexpr int kOldest = 120;                      // [years]
inline constexpr std::size_t kLongestComment = 2000;     // [characters]
inline constexpr std::size_t kLongestAnswer = 32 << 10;  // size of the JSON [bytes]

struct SurveyAnswer {
  std::string pseudonym;  // valid by IsPseudonym; drawn if the form has none
  std::string recording;  // file name of the run's recording; may be empty
  Condition condition = Condition::kEmulated;
  std::array<std::optional<int>, kStatements> scores;  // no value: not answered
  std::optional<int> age;                              // [years]; no value: not given
  std::string sex;      // "female", "male", "other"; empty: not given
  std::string comment;  // UTF-8
};

// Parses the text that the page sends, which has the form {"consent": true, "condition", "answers":
// {"S1": 2, ...}, "age", "sex", "comment", "pseudonym"}. The answer to a statement, the age and the
// sex may be null. Throws InputError with a sentence for the person. The key() of the error is the
// name of the field.
SurveyAnswer ParseSurveyForm(std::string_view json);

// Converts a stored answer to text and back. Parsing throws InputError.
std::string SurveyAnswerJson(const SurveyAnswer& answer);
SurveyAnswer ParseSurveyAnswer(std::string_view json);

}  // namespace predictor
