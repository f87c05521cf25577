#include "process/landlock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>

namespace predictor {
namespace {

// The numbers are the same on every architecture; older headers lack them.
constexpr long kCreateRuleset = 444, kAddRule = 445, kRestrictSelf = 446;
constexpr std::uint32_t kAskVersion = 1;
constexpr int kPathBeneath = 1;

constexpr std::uint64_t Bit(int n) { return std::uint64_t{1} << n; }
constexpr std::uint64_t kWriteFile = Bit(1), kReadFile = Bit(2), kReadFolder = Bit(3),
                        kRemoveFile = Bit(5), kMakeFile = Bit(8), kTruncate = Bit(14);
// Rights that do not apply to folders.
constexpr std::uint64_t kOfFiles = kWriteFile | kReadFile | kTruncate;
constexpr std::uint64_t kBind = Bit(0), kConnect = Bit(1);

struct Ruleset {
  std::uint64_t files = 0, ports = 0, scopes = 0;
};

struct [[gnu::packed]] PathRule {
  std::uint64_t allowed = 0;
  std::int32_t folder = -1;
};

// All rights that a version of Landlock can refuse.
Ruleset EverythingOf(long version) {
  Ruleset all;
  all.files = Bit(13) - 1;
  if (version >= 2) all.files |= Bit(13);  // moves between folders
  if (version >= 3) all.files |= kTruncate;
  if (version >= 5) all.files |= Bit(15);  // ioctl of devices
  if (version >= 4) all.ports = kBind | kConnect;
  if (version >= 6) all.scopes = 3;  // abstract sockets, signals
  return all;
}

// Older versions have a shorter ruleset.
std::size_t SizeOf(long version) {
  if (version >= 6) return sizeof(Ruleset);
  return version >= 4 ? offsetof(Ruleset, scopes) : offsetof(Ruleset, ports);
}

bool Allow(int rules, const std::filesystem::path& path, std::uint64_t access) {
  const int place = open(path.c_str(), O_PATH | O_CLOEXEC);
  if (place < 0) return true;  // the path does not exist
  struct stat status {};
  if (fstat(place, &status) == 0 && !S_ISDIR(status.st_mode)) access &= kOfFiles;
  const PathRule rule{access, place};
  const bool added = syscall(kAddRule, rules, kPathBeneath, &rule, 0) == 0;
  close(place);
  return added;
}

}  // namespace

bool EnterLandlock(const Preparation& may) {
  const long version = syscall(kCreateRuleset, nullptr, 0, kAskVersion);
  if (version < 1) return false;
  Ruleset refused = EverythingOf(version);
  if (may.listen) refused.ports &= ~kBind;
  const int rules = static_cast<int>(syscall(kCreateRuleset, &refused, SizeOf(version), 0));
  if (rules < 0) return false;
  constexpr std::uint64_t kReading = kReadFile | kReadFolder;
  constexpr std::uint64_t kWriting = kReading | kWriteFile | kRemoveFile | kMakeFile | kTruncate;
  bool good = true;
  for (const auto& path : may.read) good &= Allow(rules, path, kReading & refused.files);
  for (const auto& path : may.write) good &= Allow(rules, path, kWriting & refused.files);
  const bool entered = good && syscall(kRestrictSelf, rules, 0) == 0;
  close(rules);
  return entered;
}

}  // namespace predictor
