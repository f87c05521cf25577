#include "evaluation/questionnaire.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "core/error.h"
#include "core/text_table.h"
#include "scenario/pseudonym.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;  // format version of a stored answer

const std::set<std::string> kSexes = {"female", "male", "other"};

Json ParseObject(std::string_view text) {
  if (text.size() > kLongestAnswer) throw InputError("The answer is too long.");
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw InputError("The answer is not a JSON object.");
  return json;
}

void RefuseUnknown(const Json& object, const std::set<std::string>& known) {
  for (const auto& [key, value] : object.items())
    if (!known.contains(key))
      throw InputError::At(key, "\"" + key + "\" is not a field of the questionnaire.");
}

const Json* Find(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? nullptr : &*found;
}

std::string ReadText(const Json& object, const char* key) {
  const Json* value = Find(object, key);
  if (!value) return "";
  if (!value->is_string()) throw InputError::At(key, std::string(key) + " must be text.");
  return value->get<std::string>();
}

// Returns true only if the JSON value is a whole number from `least` to `most`.
bool IsWhole(const Json& value, int least, int most) {
  if (value.is_number_unsigned())
    return most >= 0 && value.get<std::uint64_t>() <= static_cast<std::uint64_t>(most) &&
           static_cast<int>(value.get<std::uint64_t>()) >= least;
  return value.is_number_integer() && value.get<std::int64_t>() >= least &&
         value.get<std::int64_t>() <= most;
}

std::optional<int> ReadScore(const Json& answers, const char* name) {
  const Json* value = Find(answers, name);
  if (!value) return {};
  if (!IsWhole(*value, kLowestScore, kHighestScore))
    throw InputError::At(
        name, std::string("The answer to ") + name + " must be −2, −1, 0, 1 or 2, or omitted.");
  return value->get<int>();
}

void ReadScores(const Json& object, SurveyAnswer* answer) {
  const Json* answers = Find(object, "answers");
  if (!answers || !answers->is_object())
    throw InputError::At("answers", "The answers to the statements are missing.");
  std::set<std::string> names;
  for (std::size_t i = 0; i < kStatements; ++i) {
    names.insert(Statements()[i].name);
    answer->scores[i] = ReadScore(*answers, Statements()[i].name);
  }
  RefuseUnknown(*answers, names);
  if (std::none_of(answer->scores.begin(), answer->scores.end(),
                   [](const auto& score) { return score.has_value(); }))
    throw InputError::At("answers", "No statement was answered.");
}

std::optional<int> ReadAge(const Json& object) {
  const Json* value = Find(object, "age");
  if (!value) return {};
  if (!IsWhole(*value, 1, kOldest))
    throw InputError::At("age", "The age must be a whole number of years from 1 to " +
                                    std::to_string(kOldest) + ", or omitted.");
  return value->get<int>();
}

std::string ReadComment(const Json& object) {
  std::string comment = ReadText(object, "comment");
  if (CharactersIn(comment) > kLongestComment)
    throw InputError::At("comment", "The comment may have at most " +
                                        std::to_string(kLongestComment) + " characters.");
  const bool odd = std::any_of(comment.begin(), comment.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\r' && c != '\t') || c == 127;
  });
  if (odd)
    throw InputError::At("comment", "The comment contains characters that cannot be displayed.");
  return comment;
}

// Reads the fields that a form and a stored answer have in common.
SurveyAnswer ReadFields(const Json& object) {
  SurveyAnswer answer;
  const auto condition = ConditionNamed(ReadText(object, "condition"));
  if (!condition)
    throw InputError::At(
        "condition", "Choose the system that you used: the real system or the emulated system.");
  answer.condition = *condition;
  ReadScores(object, &answer);
  answer.age = ReadAge(object);
  answer.sex = ReadText(object, "sex");
  if (!answer.sex.empty() && !kSexes.contains(answer.sex))
    throw InputError::At("sex", "The sex must be female, male or other, or omitted.");
  answer.comment = ReadComment(object);
  answer.pseudonym = ReadText(object, "pseudonym");
  if (!answer.pseudonym.empty() && !IsPseudonym(answer.pseudonym))
    throw InputError::At(
        "pseudonym",
        "The text is not a pseudonym from this questionnaire. Check the pseudonym "
        "that you wrote down, or leave the field empty if you have no pseudonym yet.");
  return answer;
}

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace

const std::array<Statement, kStatements>& Statements() {
  static constexpr std::array<Statement, kStatements> kList = {{
      {"S1", "Usability",
       "The physical emulator is easy-to-use for the human-robot collaboration task."},
      {"S2", "Subjective realism",
       "The realism level of visual rendering of the emulation of the human-robot collaboration "
       "task is very good compared to the real task."},
      {"S3", "Subjective realism",
       "The realism level of haptic rendering/feedback of the emulation of the human-robot "
       "collaboration task is very good compared to the real task."},
      {"S4", "Subjective realism",
       "The overall realism level of the emulation of the human-robot collaboration task is very "
       "good compared to the real task."},
      {"S5", "Responsiveness",
       "The emulated human-robot collaboration task is as responsive as the real task."},
      {"S6", "Perceived safety",
       "I feel safe to use the physical emulator in the human-robot collaboration task."},
      {"S7", "Comfort",
       "I feel comfortable with the physical emulator in the human-robot collaboration task."},
      {"S8", "Overall performance",
       "I am satisfied with the overall performance of the physical emulator."},
  }};
  return kList;
}

const std::array<const char*, kScores>& ScoreNames() {
  static constexpr std::array<const char*, kScores> kList = {"Strongly disagree", "Disagree",
                                                             "Neutral", "Agree", "Strongly agree"};
  return kList;
}

const char* Name(Condition condition) {
  return condition == Condition::kReal ? "real" : "emulated";
}

std::optional<Condition> ConditionNamed(std::string_view name) {
  for (const Condition condition : {Condition::kReal, Condition::kEmulated})
    if (name == Name(condition)) return condition;
  return {};
}

const char* ConsentText() {
  return "You are asked for your opinion of the system that you have just used: eight statements "
         "and, if you like, your age, your sex and a comment. Answering is voluntary: you may "
         "leave out any question, and you may stop at any time without giving a reason. Your "
         "answers are stored in a file on this computer, beside the recording of your run, under "
         "a randomly drawn pseudonym. Neither your name nor the time of your answer is asked for "
         "or recorded. The pseudonym is shown to you once, at the end. Give it to the "
         "experimenter if you want your answers removed. Please write nothing in the comment "
         "that could identify you.";
}

SurveyAnswer ParseSurveyForm(std::string_view text) {
  const Json form = ParseObject(text);
  const Json* consent = Find(form, "consent");
  if (!consent || *consent != true)
    throw InputError::At("consent", "Nothing is stored without your consent.");
  RefuseUnknown(form,
                {"type", "consent", "condition", "answers", "age", "sex", "comment", "pseudonym"});
  return ReadFields(form);
}

std::string SurveyAnswerJson(const SurveyAnswer& answer) {
  Json answers = Json::object();
  for (std::size_t i = 0; i < kStatements; ++i)
    answers[Statements()[i].name] = OrNull(answer.scores[i]);
  const Json json = {{"predictor_survey", kFormat},
                     {"pseudonym", answer.pseudonym},
                     {"recording", answer.recording},
                     {"condition", Name(answer.condition)},
                     {"answers", answers},
                     {"age", OrNull(answer.age)},
                     {"sex", answer.sex.empty() ? Json(nullptr) : Json(answer.sex)},
                     {"comment", answer.comment},
                     {"consent", kConsentVersion}};
  return json.dump(2) + "\n";
}

SurveyAnswer ParseSurveyAnswer(std::string_view text) {
  const Json json = ParseObject(text);
  if (json.value("predictor_survey", Json()) != kFormat)
    throw InputError("The file is not a stored answer of this version (\"predictor_survey\": 1).");
  RefuseUnknown(json, {"predictor_survey", "pseudonym", "recording", "condition", "answers", "age",
                       "sex", "comment", "consent"});
  if (const Json* consent = Find(json, "consent"); !consent || *consent != kConsentVersion)
    throw InputError::At("consent",
                         "The answer contains no consent, so the answer may not be used.");
  SurveyAnswer answer = ReadFields(json);
  if (answer.pseudonym.empty()) throw InputError::At("pseudonym", "The answer has no pseudonym.");
  answer.recording = ReadText(json, "recording");
  return answer;
}

}  // namespace predictor
