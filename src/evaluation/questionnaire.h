// The questionnaire of the paper's user study: statements S1 to S8, and one person's answer to
// them.
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

// Of a statement: how often each score was given, from the lowest.
using ScoreCounts = std::array<int, kScores>;

struct Statement {
  const char* name;    // "S1"
  const char* aspect;  // "Usability"
  const char* text;
};
// In the paper's words.
const std::array<Statement, kStatements>& Statements();
// "Strongly disagree" and so on, from the lowest score.
const std::array<const char*, kScores>& ScoreNames();

// What was used before answering: the system itself (mode: direct) or its emulation.
enum class Condition : int { kReal, kEmulated };
inline constexpr std::size_t kConditions = 2;
const char* Name(Condition condition);  // "real", "emulated"
std::optional<Condition> ConditionNamed(std::string_view name);

// What a person agrees to before anything is asked; stored answers name its version.
const char* ConsentText();
inline constexpr int kConsentVersion = 1;

inline constexpr int kOldest = 120;                      // [years]
inline constexpr std::size_t kLongestComment = 2000;     // [characters]
inline constexpr std::size_t kLongestAnswer = 32 << 10;  // as JSON [bytes]
inline constexpr std::size_t kPseudonymLength = 8;

struct SurveyAnswer {
  std::string pseudonym;  // IsPseudonym; empty in a form: one is drawn
  std::string recording;  // file name of the run's recording; empty: none
  Condition condition = Condition::kEmulated;
  std::array<std::optional<int>, kStatements> scores;  // nothing: not answered
  std::optional<int> age;                              // [years]; nothing: not told
  std::string sex;                                     // "female", "male", "other"; empty: not told
  std::string comment;                                 // UTF-8
};

// Eight of the digits 2 to 9 and the capitals without I and O, so that it can be written down; the
// last follows from the others, so that no single mistyped character makes another pseudonym.
bool IsPseudonym(std::string_view text);
// Thirty-five random bits of the system's generator. Throws std::runtime_error.
std::string DrawPseudonym();

// What the page sends: {"consent": true, "condition", "answers": {"S1": 2, ...}, "age", "sex",
// "comment", "pseudonym"}; a statement, age and sex may be null. Throws InputError with a sentence
// for the person; its key() names the field.
SurveyAnswer ParseSurveyForm(std::string_view json);

// A stored answer, as text and back. Parsing throws InputError.
std::string SurveyAnswerJson(const SurveyAnswer& answer);
SurveyAnswer ParseSurveyAnswer(std::string_view json);

}  // namespace predictor
