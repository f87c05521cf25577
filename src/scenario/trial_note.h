// The note that a controller's library passed its trial (`predictor trial`). It is stored beside
// the library and is valid only for the same bytes.
#pragma once

#include <filesystem>
#include <string>

namespace predictor {

std::filesystem::path TrialNoteFile(const std::filesystem::path& library);
// Returns the note for the library as it is now. Throws InputError if it cannot be read.
std::string TrialNote(const std::filesystem::path& library);
// Returns whether the note exists and is about the library as it is now.
bool HasPassedTrial(const std::filesystem::path& library);

}  // namespace predictor
