#include "process/sandbox.h"

#include <fcntl.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <sstream>
#include <string>

namespace predictor {
namespace {

// ---- Landlock: restricts what a process may access in the file system and on the network

// The numbers of these system calls are the same on every architecture, but older headers do not
// define them.
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

// Returns all rights that a version of Landlock can refuse.
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

// Older versions of Landlock have a shorter ruleset.
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

// Allows only the actions that `may` lists. All other actions that this kernel's Landlock can
// refuse are refused. Returns false if the kernel has no Landlock.
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

// ---- seccomp: restricts the system calls

// The lists were made from traces of a run with viewer, TLS and ROS-TCP, and of the questionnaire,
// all with glibc 2.36. The lists also include calls that other versions of glibc use for the same
// functions.

// The calls that a server needs, and the calls that the C library needs to allocate memory, wait,
// read the time and abort.
constexpr const char* kServing =
    "read write readv writev recvfrom recvmsg close shutdown accept accept4 getsockname "
    "getpeername getsockopt setsockopt poll ppoll epoll_wait epoll_pwait epoll_pwait2 "
    "epoll_ctl timerfd_settime munmap mremap brk madvise futex futex_time64 clock_gettime "
    "clock_gettime64 clock_getres clock_nanosleep clock_nanosleep_time64 nanosleep "
    "gettimeofday time getrandom sched_yield sched_getaffinity sysinfo getpid gettid getppid "
    "getuid geteuid getgid getegid rt_sigaction rt_sigprocmask rt_sigreturn sigaltstack "
    "restart_syscall exit exit_group fstat rseq set_robust_list";
constexpr const char* kReadingFiles =
    "pread64 lseek stat lstat newfstatat statx readlink readlinkat getcwd access faccessat "
    "faccessat2 getdents64 fadvise64";
constexpr const char* kWritingFiles =
    "rename renameat renameat2 unlink unlinkat fsync fdatasync pwrite64";
constexpr const char* kListening = "bind listen epoll_create1 eventfd2 timerfd_create";
constexpr const char* kGivingUpMore = "setgroups setresgid setresuid setrlimit prctl seccomp";
// Some versions of libseccomp do not know the names of these calls.
constexpr int kLandlockCalls[] = {444, 445, 446};

using Context = std::unique_ptr<void, decltype(&seccomp_release)>;

// The list under construction. Calls that do not exist on this architecture are omitted.
class List {
 public:
  List() : context_(seccomp_init(SCMP_ACT_ERRNO(EPERM)), &seccomp_release) {
    good_ = context_ &&
            seccomp_attr_set(context_.get(), SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS) == 0;
    // The filter finds a call by binary search.
    seccomp_attr_set(context_.get(), SCMP_FLTATR_CTL_OPTIMIZE, 2);
  }

  void AllowAll(const std::string& names) {
    std::istringstream words(names);
    for (std::string name; words >> name;) Allow(name.c_str(), {});
  }
  void Allow(const char* name, std::initializer_list<scmp_arg_cmp> only_if) {
    AllowNumber(seccomp_syscall_resolve_name(name), only_if);
  }
  void AllowNumber(int number, std::initializer_list<scmp_arg_cmp> only_if = {}) {
    if (!good_ || number < 0) return;
    good_ = seccomp_rule_add_array(context_.get(), SCMP_ACT_ALLOW, number,
                                   static_cast<unsigned>(only_if.size()), only_if.begin()) == 0;
  }
  bool Enter() { return good_ && seccomp_load(context_.get()) == 0; }

 private:
  Context context_;
  bool good_ = false;
};

// Requires that the bits of `mask` in argument `index`, an int, have the value `bits`.
scmp_arg_cmp Has(unsigned index, std::uint32_t mask, std::uint32_t bits) {
  return {index, SCMP_CMP_MASKED_EQ, mask, bits};
}
scmp_arg_cmp Is(unsigned index, std::uint32_t value) { return Has(index, UINT32_MAX, value); }

// Calls that are allowed only with certain arguments.
void AllowPartly(List* list) {
  for (const char* name : {"mmap", "mprotect"}) list->Allow(name, {Has(2, PROT_EXEC, 0)});
  for (const std::uint32_t command : {F_GETFD, F_SETFD, F_GETFL, F_SETFL})
    for (const char* name : {"fcntl", "fcntl64"}) list->Allow(name, {Is(1, command)});
  for (const std::uint32_t command : {FIONBIO, FIONREAD}) list->Allow("ioctl", {Is(1, command)});
  // Data may be sent only to the peer to which the socket is connected. Without this rule, sending
  // on a TCP socket could also open a connection.
  list->Allow("sendto", {Has(3, MSG_FASTOPEN, 0), {4, SCMP_CMP_EQ, 0, 0}});
  list->Allow("sendmsg", {Has(2, MSG_FASTOPEN, 0)});
  // abort() signals its own thread.
  list->Allow("tgkill", {Is(0, static_cast<std::uint32_t>(getpid()))});
}

void AllowOpening(bool writing, List* list) {
  constexpr std::uint32_t kChanging = O_ACCMODE | O_CREAT | O_TRUNC;
  if (writing) {
    list->Allow("openat", {});
    list->Allow("open", {});
  } else {
    list->Allow("openat", {Has(2, kChanging, O_RDONLY)});
    list->Allow("open", {Has(1, kChanging, O_RDONLY)});
  }
}

void AllowPreparation(const Preparation& may, List* list) {
  list->AllowAll(kReadingFiles);
  if (!may.read.empty() || !may.write.empty()) AllowOpening(!may.write.empty(), list);
  if (!may.write.empty()) list->AllowAll(kWritingFiles);
  if (may.listen) {
    list->AllowAll(kListening);
    constexpr std::uint32_t kType = 0xf;  // mask that excludes the flags
    for (const std::uint32_t domain : {AF_INET, AF_INET6})
      list->Allow("socket", {Is(0, domain), Has(1, kType, SOCK_STREAM)});
  }
  if (may.give_up_more) {
    list->AllowAll(kGivingUpMore);
    list->Allow("prlimit64", {Is(0, 0)});  // the process itself
    for (const int number : kLandlockCalls) list->AllowNumber(number);
  }
}

enum class SandboxStage { kFirst, kSecond };

std::string EnterStage(SandboxStage stage, const Preparation& may) {
  std::string missing;
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (!EnterLandlock(may)) missing = "Landlock (Linux 5.13 or newer)";
  List list;
  list.AllowAll(kServing);
  AllowPartly(&list);
  if (stage == SandboxStage::kFirst) AllowPreparation(may, &list);
  if (!list.Enter())
    missing += std::string(missing.empty() ? "" : ", ") + "the filter of system calls (seccomp)";
  return missing;
}

}  // namespace

std::string EnterPreparation(const Preparation& may) {
  return EnterStage(SandboxStage::kFirst, may);
}

std::string EnterSandbox() { return EnterStage(SandboxStage::kSecond, {}); }

}  // namespace predictor
