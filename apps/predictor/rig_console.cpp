#include "rig_console.h"

#include <poll.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace predictor {
namespace {

double Now() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

const char* RigConsole::Help() const {
  if (enabling_device_)
    return "Hold the enabling device; a aligns, then s starts, r recovers; letting go of the "
           "device stops. z resets, : begins a command (Enter does it, Esc stops meanwhile), any "
           "other key stops.";
  return "Keys: hold a to align, then hold s to start and run, hold r to recover; letting go "
         "stops. z resets, : begins a command (Enter does it, Esc stops meanwhile), any other key "
         "stops.";
}

RigConsole::RigConsole(std::function<void(RunEvent)> request,
                       std::function<void(const std::string&)> line, bool enabling_device)
    : request_(std::move(request)), line_(std::move(line)), enabling_device_(enabling_device) {
  tcgetattr(STDIN_FILENO, &before_);
  termios keys = before_;
  keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C stays a signal
  tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  thread_ = std::thread([this] { Listen(); });
}

RigConsole::~RigConsole() {
  done_.store(true);
  thread_.join();
  tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void RigConsole::Listen() {
  while (!done_) {
    pollfd ready{STDIN_FILENO, POLLIN, 0};
    if (poll(&ready, 1, 100) <= 0) continue;
    char key = 0;
    // A terminal that is gone is a person who is gone.
    if (read(STDIN_FILENO, &key, 1) <= 0) return request_(RunEvent::kStopRequested);
    Key(key, Now());
  }
}

void RigConsole::Key(char key, double now) {
  if (typing_) return Type(key);
  switch (key) {
    case 'a':
      return Held(key, RunEvent::kAlignRequested, now);
    case 's':
      return Held(key, RunEvent::kStartRequested, now);
    case 'r':
      return Held(key, RunEvent::kRecoverRequested, now);
    case 'z':
      held_ = 0;
      return request_(RunEvent::kReset);
    case ':':
      held_ = 0;
      typing_ = true;
      std::fputs(": ", stderr);
      return;
    default:
      held_ = 0;
      request_(RunEvent::kStopRequested);
  }
}

// The first letter is a touch; from the second on the key is held, and what it stands for is asked
// for once.
void RigConsole::Held(char key, RunEvent event, double now) {
  if (enabling_device_) return request_(event);
  const bool again = key == held_ && now - since_ < kFirstRepeat;
  const bool asked = again && repeats_;
  held_ = key;
  since_ = now;
  repeats_ = again;
  if (!again) return;
  enabling_.fetch_add(1, std::memory_order_release);
  if (!asked) request_(event);
}

// What is no part of a text (Esc, Tab, an arrow) stops here too.
void RigConsole::Type(char key) {
  constexpr char kDelete = 127;
  const bool erases = key == kDelete || key == '\b';
  if (key == '\n') {
    typing_ = false;
    std::fputs("\n", stderr);
    line_(std::exchange(typed_, ""));
  } else if (erases) {
    if (typed_.empty()) return;
    typed_.pop_back();
    std::fputs("\b \b", stderr);
  } else if (static_cast<unsigned char>(key) < ' ') {
    typing_ = false;
    typed_.clear();
    std::fputs(" (given up: stop)\n", stderr);
    request_(RunEvent::kStopRequested);
  } else if (typed_.size() < 80) {
    typed_.push_back(key);
    std::fputc(key, stderr);
  }
}

}  // namespace predictor
