#include "rig_console.h"

#include <poll.h>
#include <time.h>
#include <unistd.h>

#include <utility>

#include "core/format.h"

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
  thread_ = std::thread([this] { Listen(); });
}

RigConsole::~RigConsole() {
  done_.store(true);
  thread_.join();
}

void RigConsole::Listen() {
  while (!done_) {
    pollfd ready{STDIN_FILENO, POLLIN, 0};
    if (poll(&ready, 1, 100) <= 0) {
      TellTouch(Now());
      continue;
    }
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
      return typed_.Show();
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
  told_ = false;
  if (!again) return;
  enabling_.fetch_add(1, std::memory_order_release);
  if (!asked) request_(event);
}

// A key that was meant to be held, and was not.
void RigConsole::TellTouch(double now) {
  if (held_ == 0 || repeats_ || told_ || enabling_device_ || now - since_ < kFirstRepeat) return;
  told_ = true;
  TheScreen().Tell(Formatted("Not done: %c was touched only. Hold it down.", held_));
}

// What is no part of a text (Esc, Tab, an arrow) stops here too.
void RigConsole::Type(char key) {
  if (typed_.Type(key)) return;
  typing_ = false;
  if (key == '\n') return line_(typed_.Take());
  request_(RunEvent::kStopRequested);
  typed_.Take(" (given up: stop)");
}

}  // namespace predictor
