#include "scenario/trial_note.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace predictor {
namespace {

// Returns the beginning of all lines about the library as it is now. Throws InputError if it cannot
// be read.
std::string StartOf(const std::filesystem::path& library) {
  const std::string bytes = ReadWholeFile(library);
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(Fnv1a(bytes)));
  return library.filename().string() + " (" + std::to_string(bytes.size()) + " bytes, hash " +
         hash + ") passed `predictor trial` with";
}

// Returns the text with which the line about a list of parameters ends. The separators between the
// parameters do not matter.
std::string WordsOf(const std::string& parameters) {
  std::istringstream words(parameters);
  std::string text;
  for (std::string word; words >> word;) text += " " + word;
  return text.empty() ? " no parameters." : " the parameters" + text;
}

std::vector<std::string> LinesOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::filesystem::path TrialNoteFile(const std::filesystem::path& library) {
  return library.string() + ".trial";
}

void NoteTrial(const std::filesystem::path& library, const std::string& parameters, bool passed) {
  const std::string start = StartOf(library), line = start + WordsOf(parameters);
  const std::filesystem::path file = TrialNoteFile(library);
  std::string note;
  for (const std::string& other : LinesOf(file))
    if (other.starts_with(start) && other != line) note += other + "\n";
  if (passed) note += line + "\n";
  if (!note.empty()) return WriteWholeFile(file, note);
  std::error_code error;
  std::filesystem::remove(file, error);
  if (std::filesystem::exists(file, error))
    throw InputError(file.string(), "The note could not be removed. Check the permissions.");
}

bool HasPassedTrial(const std::filesystem::path& library, const std::string& parameters) {
  try {
    const std::vector<std::string> lines = LinesOf(TrialNoteFile(library));
    return std::ranges::find(lines, StartOf(library) + WordsOf(parameters)) != lines.end();
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace predictor
