// Answers to the questionnaire as files: one each, so that one can be removed alone.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/questionnaire.h"

namespace predictor {

// "RECORDING.PSEUDONYM.CONDITION.survey.json", with the recording's name without its ending;
// without a recording the first word is missing.
std::string SurveyFileName(const SurveyAnswer& answer);

// Writes the answer into `folder`, readable by the owner alone, and waits until it is on the disk.
// Returns its path. Throws InputError, with key "pseudonym", if this person has answered for this
// recording and condition already, and without a key if it cannot be written; nothing is left then.
std::filesystem::path StoreSurveyAnswer(const std::filesystem::path& folder,
                                        const SurveyAnswer& answer);

struct StoredAnswer {
  std::filesystem::path file;
  SurveyAnswer answer;
};

// The answers among these files and in these folders with all folders below (links are not
// followed), in the order of their pseudonyms. Throws InputError naming what is missing or no
// answer.
std::vector<StoredAnswer> ReadSurveyAnswers(const std::vector<std::filesystem::path>& places);

// Removes the files of that pseudonym, by their names alone, so that also a spoilt one goes.
// Returns what was removed. Throws InputError if the pseudonym is none, a place is missing or a
// file cannot be removed.
std::vector<std::filesystem::path> RemoveSurveyAnswers(
    const std::vector<std::filesystem::path>& places, const std::string& pseudonym);

}  // namespace predictor
