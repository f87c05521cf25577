// Reads and writes the note which states that a controller's library passed its trial (`predictor
// trial`). The note is stored beside the library, with a line for each list of parameters with
// which the library passed. A line is valid only if the bytes of the library and the parameters
// have not changed.
#pragma once

#include <filesystem>
#include <string>

namespace predictor {

std::filesystem::path TrialNoteFile(const std::filesystem::path& library);

// Notes whether the present library passed with these cobot.controller.parameters (words, separated
// by spaces). Removes the lines about other versions of the library. If no line is left, removes
// the file. Throws InputError if the library cannot be read or the file cannot be written.
void NoteTrial(const std::filesystem::path& library, const std::string& parameters, bool passed);

// Returns whether the present library passed with these parameters.
bool HasPassedTrial(const std::filesystem::path& library, const std::string& parameters);

}  // namespace predictor
