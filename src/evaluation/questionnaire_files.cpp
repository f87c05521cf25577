#include "evaluation/questionnaire_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "scenario/pseudonym.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".survey.json";

InputError CannotWrite(const fs::path& file, int error) {
  return InputError(file.string(),
                    std::string("The answer cannot be stored: ") + std::strerror(error) + ".");
}

// Writes all of `text` to `descriptor` and to the disk. Returns errno if writing fails.
int WriteAll(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return fsync(descriptor) == 0 ? 0 : errno;
}

// Writes the folder to the disk, so that the new file name is stored.
void SyncFolder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

bool IsAnswerFile(const fs::path& file) { return file.filename().string().ends_with(kEnding); }

// Returns the pseudonym in a file name "[RECORDING.]PSEUDONYM.CONDITION.survey.json".
std::string PseudonymIn(const fs::path& file) {
  std::string name = file.filename().string();
  if (!name.ends_with(kEnding)) return "";
  name.resize(name.size() - kEnding.size());
  const std::size_t condition = name.rfind('.');
  if (condition == std::string::npos || !ConditionNamed(name.substr(condition + 1))) return "";
  name.resize(condition);
  return name.substr(name.rfind('.') + 1);
}

void AddFolder(const fs::path& folder, std::vector<fs::path>* files) {
  try {
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (!entry.is_symlink() && entry.is_regular_file() && IsAnswerFile(entry.path()))
        files->push_back(entry.path());
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder.string(),
                     std::string("The folder cannot be read: ") + error.code().message() + ".");
  }
}

std::vector<fs::path> FindFiles(const std::vector<fs::path>& places) {
  std::vector<fs::path> files;
  for (const fs::path& place : places) {
    if (fs::is_directory(place))
      AddFolder(place, &files);
    else if (fs::exists(place))
      files.push_back(place);
    else
      throw InputError(place.string(), "There is no such file or folder.");
  }
  // The user may name a folder and, in addition, a file in this folder.
  for (fs::path& file : files) file = file.lexically_normal();
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

SurveyAnswer ReadFile(const fs::path& file) {
  const std::string text = ReadWholeFile(file, kLongestAnswer + 1);
  try {
    return ParseSurveyAnswer(text);
  } catch (const InputError& error) {
    throw InputError(file.string(), error.what());
  }
}

}  // namespace

std::string SurveyFileName(const SurveyAnswer& answer) {
  const std::string recording = fs::path(answer.recording).stem().string();
  return (recording.empty() ? "" : recording + ".") + answer.pseudonym + "." +
         Name(answer.condition) + std::string(kEnding);
}

fs::path StoreSurveyAnswer(const fs::path& folder, const SurveyAnswer& answer) {
  const fs::path file = folder / SurveyFileName(answer);
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0 && errno == EEXIST)
    throw InputError::At("pseudonym",
                         std::string("A person with this pseudonym has already answered for the ") +
                             Name(answer.condition) + " system after this run.");
  if (descriptor < 0) throw CannotWrite(file, errno);
  int error = WriteAll(descriptor, SurveyAnswerJson(answer));
  if (close(descriptor) != 0 && error == 0) error = errno;
  if (error != 0) {
    unlink(file.c_str());
    throw CannotWrite(file, error);
  }
  SyncFolder(folder);
  return file;
}

std::vector<StoredAnswer> ReadSurveyAnswers(const std::vector<fs::path>& places) {
  std::vector<StoredAnswer> answers;
  for (const fs::path& file : FindFiles(places)) answers.push_back({file, ReadFile(file)});
  std::stable_sort(answers.begin(), answers.end(), [](const auto& a, const auto& b) {
    return a.answer.pseudonym < b.answer.pseudonym;
  });
  return answers;
}

std::vector<fs::path> RemoveSurveyAnswers(const std::vector<fs::path>& places,
                                          const std::string& pseudonym) {
  if (!IsPseudonym(pseudonym))
    throw InputError(Quote(pseudonym) +
                     " is not a pseudonym from the questionnaire. Check for typing errors.");
  std::vector<fs::path> removed;
  for (const fs::path& file : FindFiles(places)) {
    if (PseudonymIn(file) != pseudonym) continue;
    std::error_code error;
    if (!fs::remove(file, error) || error)
      throw InputError(file.string(), "The answer cannot be removed: " + error.message() + ".");
    SyncFolder(file.parent_path());
    removed.push_back(file);
  }
  return removed;
}

}  // namespace predictor
