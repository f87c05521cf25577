#include "rig_console.h"

#include <poll.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "core/contained_thread.h"
#include "core/format.h"
#include "safety/console_keys.h"

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
    return "Hold the enabling device. Key a aligns, then s starts; r recovers. Releasing the "
           "device stops the arms. Key z resets. Key : begins a command (Enter executes it; Esc "
           "stops the arms). Any other key stops the arms.";
  return "Keys: hold a to align, then hold s to start and run; hold r to recover. Releasing the "
         "key stops the arms. Key z resets. Key : begins a command (Enter executes it; Esc stops "
         "the arms). Any other key stops the arms.";
}

RigConsole::RigConsole(std::function<void(RunEvent)> request,
                       std::function<void(const std::string&)> line, bool enabling_device)
    : request_(std::move(request)),
      line_(std::move(line)),
      enabling_device_(enabling_device),
      askings_{AskingOf(kConsoleKeys[0]), AskingOf(kConsoleKeys[1]), AskingOf(kConsoleKeys[2]),
               AskingOf(kConsoleKeys[3])} {
  // A console that receives no keys is treated as an absent operator.
  thread_ = ContainedThread(
      "console", [this] { Listen(); },
      [this](const char* why) {
        request_(RunEvent::kStopRequested);
        TheScreen().Print(std::string("The console no longer receives keys (") + why +
                          "), so the arms are stopping. Ctrl-C ends the run.");
      });
}

RigConsole::~RigConsole() {
  done_.store(true);
  thread_.join();
}

void RigConsole::Listen() {
  constexpr int kPeriod = static_cast<int>(1e3 * HeldKey::kTogether);  // [ms]
  while (!done_) {
    pollfd ready{STDIN_FILENO, POLLIN, 0};
    std::array<char, 256> keys;
    ssize_t count = 0;
    if (poll(&ready, 1, kPeriod) > 0) {
      count = read(STDIN_FILENO, keys.data(), keys.size());
      // A closed terminal is treated as an absent operator.
      if (count <= 0) return request_(RunEvent::kStopRequested);
    }
    // Queued input was typed at unknown earlier times. The console reads all queued keys at once
    // and gives these keys the same time.
    const double now = Now();
    for (ssize_t i = 0; i < count; ++i) Key(RawKeys::Read(keys[static_cast<std::size_t>(i)]), now);
    for (Asking& asking : askings_) Hear(&asking, 0, now);
  }
}

void RigConsole::Key(char key, double now) {
  if (typing_) return Type(key);
  typing_ = key == kCommandKey;
  if (!typing_ && std::ranges::none_of(
                      askings_, [key](const Asking& asking) { return asking.key.key() == key; }))
    request_(RunEvent::kStopRequested);
  for (Asking& asking : askings_) Hear(&asking, key, now);
  if (typing_) typed_.Show();
}

void RigConsole::Hear(Asking* asking, char key, double now) {
  const KeySign sign = asking->key.Update(key, now);
  const bool asks = sign == (asking->by_touch ? KeySign::kTouched : KeySign::kHeld);
  if (asking->key.held() && !asking->by_touch && sign != KeySign::kNone)
    enabling_.fetch_add(1, std::memory_order_release);
  if (asks) request_(asking->event);
  ReportIgnored(*asking, sign);
}

// Prints why a key had no effect.
void RigConsole::ReportIgnored(const Asking& asking, KeySign sign) {
  const char key = asking.key.key();
  if (sign == KeySign::kHeld && asking.by_touch)
    TheScreen().Print(Formatted(
        "Key %c counts once, even if it is held longer. To repeat the request, release the "
        "key for a second, then tap it.",
        key));
  if (sign == KeySign::kNotHeld && !asking.by_touch)
    TheScreen().Print(
        Formatted("Key %c had no effect, because it was only tapped. Hold it down.", key));
  if (sign == KeySign::kLate)
    TheScreen().Print(
        Formatted("Key %c had no effect, because the presses of this key arrived late and all at "
                  "once. %s it again. If the connection stalls, use the keyboard of this computer.",
                  key, asking.by_touch ? "Tap" : "Hold"));
}

// While a command is typed, keys that do not belong to text (Esc, Tab, an arrow) stop the run, too.
void RigConsole::Type(char key) {
  if (typed_.Type(key)) return;
  typing_ = false;
  if (key == '\n') return line_(typed_.Take());
  request_(RunEvent::kStopRequested);
  typed_.Take(" (cancelled: stop)");
}

}  // namespace predictor
