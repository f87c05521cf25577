// Reads and writes whole files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>

namespace predictor {

// Returns the file's bytes, at most `max_bytes` of them: a caller that limits the size gives one
// more than it accepts. Throws InputError if the file cannot be read.
std::string ReadWholeFile(const std::filesystem::path& file,
                          std::size_t max_bytes = std::numeric_limits<std::size_t>::max());

// Replaces the file. Throws InputError if that fails.
void WriteWholeFile(const std::filesystem::path& file, const std::string& bytes);

}  // namespace predictor
