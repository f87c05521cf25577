// Reads and writes the note that a controller's library passed its trial (`predictor trial`). The
// note is stored beside the library, with a line for each list of parameters with which the library
// passed. A line is valid only for the same bytes of the library and the same parameters.
#pragma once

#include <filesystem>
#include <string>

namespace predictor {

std::filesystem::path TrialNoteFile(const std::filesystem::path& library);

// Notes whether the library, as it is now, passed with these cobot.controller.parameters (words,
// separated by spaces). Removes the lines about other bytes, and the file if no line is left.
// Throws InputError if the library cannot be read or the file cannot be written.
void NoteTrial(const std::filesystem::path& library, const std::string& parameters, bool passed);

// Returns whether the library, as it is now, passed with these parameters.
bool HasPassedTrial(const std::filesystem::path& library, const std::string& parameters);

}  // namespace predictor
