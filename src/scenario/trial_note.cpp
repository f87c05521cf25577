#include "scenario/trial_note.h"

#include <cstdio>
#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

bool ReadFile(const std::filesystem::path& file, std::string* bytes) {
  std::ifstream stream(file, std::ios::binary);
  bytes->assign(std::istreambuf_iterator<char>(stream), {});
  return stream.good() || stream.eof();
}

}  // namespace

std::filesystem::path TrialNoteFile(const std::filesystem::path& library) {
  return library.string() + ".trial";
}

std::string TrialNote(const std::filesystem::path& library) {
  std::string bytes;
  if (!ReadFile(library, &bytes))
    throw InputError(library.string(), "The library cannot be read. Check its permissions.");
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(Fnv1a(bytes)));
  return library.filename().string() + " (" + std::to_string(bytes.size()) + " bytes, hash " +
         hash + ") passed `predictor trial`.\n";
}

bool HasPassedTrial(const std::filesystem::path& library) {
  std::string note;
  try {
    return ReadFile(TrialNoteFile(library), &note) && note == TrialNote(library);
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace predictor
