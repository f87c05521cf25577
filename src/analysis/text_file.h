// Writes the files of a study.
#pragma once

#include <filesystem>
#include <string>

namespace predictor {

// Replaces the file. Throws InputError if that fails.
void WriteText(const std::filesystem::path& file, const std::string& text);

}  // namespace predictor
