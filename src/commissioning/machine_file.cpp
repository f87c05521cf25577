#include "commissioning/machine_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "scenario/yaml_tree.h"

namespace predictor::commissioning {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const fs::path& file, const std::string& what) {
  throw InputError(file.string(), what + ": " + std::strerror(errno) +
                                      ". Nothing was changed. Check the free space on the disk and "
                                      "your write permission for the folder.");
}

bool WriteAll(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = write(descriptor, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return fsync(descriptor) == 0;
}

// Writes a new file at `file` and synchronises it to the disk.
void WriteNew(const fs::path& file, const std::string& text, mode_t mode) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (descriptor < 0) Fail(file, "The file could not be created");
  const bool written = WriteAll(descriptor, text);
  const int error = errno;
  close(descriptor);
  if (written) return;
  unlink(file.c_str());
  errno = error;
  Fail(file, "The file could not be written");
}

fs::path FreeName(const fs::path& file, const std::string& date) {
  const std::string first = file.string() + ".before-" + date;
  fs::path name = first;
  for (int n = 2; fs::exists(fs::symlink_status(name)); ++n) name = first + "-" + std::to_string(n);
  return name;
}

}  // namespace

fs::path ChangeMachine(const fs::path& named, const std::string& date,
                       const std::function<void(Machine*)>& change) {
  const std::string before = ReadYamlText(named, "a machine file");
  const fs::path file = fs::canonical(named);  // the file itself if `named` is a link
  Machine machine = ParseMachine(before, file.string());
  change(&machine);
  const std::string after = SaveMachine(machine);
  ParseMachine(after, file.string());
  const auto mode = static_cast<mode_t>(fs::status(file).permissions() & fs::perms::mask);
  const fs::path copy = FreeName(file, date);
  WriteNew(copy, before, mode);
  ReplaceFile(file, after, mode);
  return copy;
}

void ReplaceFile(const fs::path& file, const std::string& text, mode_t mode) {
  const fs::path next = fs::path(file.string() + ".new-" + std::to_string(getpid()));
  WriteNew(next, text, mode);
  if (rename(next.c_str(), file.c_str()) == 0) return;
  const int error = errno;
  unlink(next.c_str());
  errno = error;
  Fail(file, "The file could not be replaced");
}

}  // namespace predictor::commissioning
