#include "crash_message.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <string_view>

#include "open_recording.h"
#include "process/sandbox.h"
#include "raw_keys.h"
#include "simulation/plugin_calls.h"

namespace predictor {
namespace {

constexpr std::array kCrashes = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr int kReaderPatience = 1000;  // for the reader of standard error [ms]

// The text is composed without allocating memory on the heap. A pipe accepts this many bytes at
// once (PIPE_BUF).
class CrashText {
 public:
  CrashText& operator<<(std::string_view more) {
    const std::size_t n = std::min(more.size(), bytes_.size() - size_);
    std::memcpy(bytes_.data() + size_, more.data(), n);
    size_ += n;
    return *this;
  }
  // The function waits only briefly for the reader of the text, because the watchdog stops the arms
  // only when this process ends.
  void Write() const {
    pollfd ready{STDERR_FILENO, POLLOUT, 0};
    if (poll(&ready, 1, kReaderPatience) <= 0) return;
    [[maybe_unused]] const ssize_t n = write(STDERR_FILENO, bytes_.data(), size_);
  }

 private:
  std::array<char, 4096> bytes_;
  std::size_t size_ = 0;
};

pid_t own_pid = 0;             // children of a fork report their crash differently
bool at_terminal = false;      // a progress bar may be on the screen
std::atomic_flag has_crashed;  // in another thread, or while the message was written

const char* NameOfCrash(int signal) {
  switch (signal) {
    case SIGSEGV:
      return "SIGSEGV, an invalid access to memory";
    case SIGBUS:
      return "SIGBUS, an access to memory that does not exist";
    case SIGFPE:
      return "SIGFPE, an invalid computation with integers";
    case SIGILL:
      return "SIGILL, an invalid instruction";
    default:
      return "SIGABRT, a deliberate abort";
  }
}

void WriteMessage(int signal) {
  CrashText text;
  const PluginCall::Place place = PluginCall::Current();
  text << (at_terminal ? "\r\033[K" : "") << "predictor: error: The program crashed ("
       << NameOfCrash(signal) << ")";
  if (place.library)
    text << " in the function " << place.function << " of the controller's library "
         << place.library
         << ". Correct the library. To run a controller that may crash, use "
            "cobot.controller.type: process.\n";
  else
    text << ". This is a defect of the program. Please report it.\n";
  const std::string_view remedy = OpenRecording::Remedy();
  if (!remedy.empty()) text << remedy << "\n";
  text.Write();
}

// This handler may call only functions that POSIX allows in a signal handler.
void OnCrash(int signal, siginfo_t* info, void*) {
  if (getpid() == own_pid && !has_crashed.test_and_set()) {
    WriteMessage(signal);
    RawKeys::RestoreAtOnce();
  }
  // The flag SA_RESETHAND has restored the signal's default action. After the handler returns, the
  // processor repeats a faulty instruction, so a core dump shows this instruction. A signal that
  // another process sent must be raised again.
  if (info->si_code <= 0) raise(signal);
}

}  // namespace

void PrintMessageOnCrash() {
  if (kSanitized) return;
  own_pid = getpid();
  at_terminal = isatty(STDERR_FILENO) == 1;
  // The handler needs a stack of its own, because the stack of the main thread, in which
  // controllers run, may be exhausted.
  static std::array<char, 1 << 16> memory;
  stack_t stack{};
  stack.ss_sp = memory.data();
  stack.ss_size = memory.size();
  sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_sigaction = OnCrash;
  action.sa_flags = static_cast<int>(SA_SIGINFO | SA_ONSTACK | SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (const int signal : kCrashes) sigaction(signal, &action, nullptr);
}

}  // namespace predictor
