// Parses any text as a filled-in questionnaire and as a stored answer. The parsers must accept it
// or throw InputError. An accepted answer must be the same after it has been stored and read again.
#include <cstdlib>

#include "core/error.h"
#include "evaluation/questionnaire.h"
#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    (void)predictor::ParseSurveyForm(text);
  } catch (const predictor::InputError&) {
  }
  try {
    const std::string stored = predictor::SurveyAnswerJson(predictor::ParseSurveyAnswer(text));
    if (predictor::SurveyAnswerJson(predictor::ParseSurveyAnswer(stored)) != stored) std::abort();
  } catch (const predictor::InputError&) {
  }
  return 0;
}
