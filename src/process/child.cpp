#include "process/child.h"

#include <grp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

#include "core/error.h"
#include "process/attached_run.h"
#include "process/sandbox.h"

namespace predictor {
namespace {

enum : int { kEnded = 0, kBadInput = 2, kFailed = 3 };  // exit codes

constexpr uid_t kNobody = 65534;
constexpr rlim_t kMaxDescriptors = 512;
constexpr rlim_t kMaxChildMemory = 3ul << 30;  // address space [bytes]

void Limit(int resource, rlim_t most) {
  const rlimit limit{most, most};
  if (setrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0)
    throw std::runtime_error("The process cannot limit its resources.");
}

// Makes this process end when the run ends, for whatever reason the run ends. (The kernel discards
// this setting when the user changes.)
void DieWithParent(const Json& start) {
  if (start.contains(kOutlivesTheRun)) return;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != start["parent"].get<pid_t>()) std::_Exit(kEnded);
}

// Call this function before any input is read.
void LimitResources(const char* name) {
  prctl(PR_SET_NAME, name);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  prctl(PR_SET_DUMPABLE, 0);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_NOFILE, kMaxDescriptors);
  if (!kSanitized) Limit(RLIMIT_AS, kMaxChildMemory);
}

Json ReadStart() {
  LineReader lines;
  for (;;) {
    if (const auto line = lines.Next()) return *line;
    if (!lines.Read(kControlDescriptor)) std::_Exit(kEnded);
  }
}

}  // namespace

void Prepare(const Preparation& may) {
  if (kSanitized) return;
  Preparation then = may;
  then.give_up_more = true;
  EnterPreparation(then);
}

void GiveUpRoot(const Json& start) {
  if (geteuid() == 0 && (setgroups(0, nullptr) != 0 || setresgid(kNobody, kNobody, kNobody) != 0 ||
                         setresuid(kNobody, kNobody, kNobody) != 0))
    throw std::runtime_error("The process cannot give up its root privileges.");
  Limit(RLIMIT_FSIZE, 0);
  DieWithParent(start);
}

void GiveUpRights(const Json& start, const std::string& who) {
  GiveUpRoot(start);
  if (kSanitized) return;
  Limit(RLIMIT_NPROC, 0);
  const std::string missing = EnterSandbox();
  if (missing.empty()) return;
  const std::string said =
      who + " keeps privileges that it does not need, because this system lacks " + missing + ".";
  SendLine(kControlDescriptor, {{"say", said}}, false);
}

int ChildMain(const char* name, const std::function<void(const Json& start)>& serve) {
  try {
    const Json start = ReadStart();
    DieWithParent(start);
    LimitResources(name);
    serve(start);
    return kEnded;
  } catch (const InputError& error) {
    SendLine(kControlDescriptor, {{"error", error.what()}}, false);
    return kBadInput;
  } catch (const std::exception& error) {
    SendLine(kControlDescriptor, {{"error", error.what()}}, false);
    return kFailed;
  }
}

}  // namespace predictor
