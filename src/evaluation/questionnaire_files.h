// Stores answers to the questionnaire as files. Each answer has its own file, so each answer can be
// removed separately.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/questionnaire.h"

namespace predictor {

// Returns "RECORDING.PSEUDONYM.CONDITION.survey.json", where RECORDING is the recording's name
// without its extension. If there is no recording, the first part of the name is omitted.
std::string SurveyFileName(const SurveyAnswer& answer);

// Writes the answer to a file in `folder` that only the owner can read, and waits until the file is
// on the disk. Returns its path. Throws InputError with key "pseudonym" if this person has already
// answered for this recording and condition. Throws InputError without a key if the file cannot be
// written. In this case, no partial file remains.
std::filesystem::path StoreSurveyAnswer(const std::filesystem::path& folder,
                                        const SurveyAnswer& answer);

struct StoredAnswer {
  std::filesystem::path file;
  SurveyAnswer answer;
};

// Reads the answers in these files, and in these folders and their subfolders. Links are not
// followed. The answers are sorted by pseudonym. Throws InputError, whose text names the missing or
// invalid file.
std::vector<StoredAnswer> ReadSurveyAnswers(const std::vector<std::filesystem::path>& places);

// Removes the files with this pseudonym in their names. The function does not read the files, so it
// also removes damaged files. Returns the removed files. Throws InputError if the pseudonym is
// invalid, a place is missing, or a file cannot be removed.
std::vector<std::filesystem::path> RemoveSurveyAnswers(
    const std::vector<std::filesystem::path>& places, const std::string& pseudonym);

}  // namespace predictor
