// Repeats attempts of tests that need real time. If lateness stopped a run, the test may repeat the
// run only if the process that runs the fakes detected at the same time that the computer was late.
// If the computer was not late, the program itself was late, and the test fails.
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "machine/rig_process.h"
#include "support/soak.h"

namespace predictor {

// The cause of the lateness, which Judge determines from the run's `screen`.
enum class Late { kNothing, kComputer, kProgram };

// Delays that stop the arms are longer than a computer's usual delays. Three missed deadlines in a
// row take at least 2 ms (Monitor::kMissedDeadlines). The thread that watches a processor wakes
// every half millisecond, so it may underestimate a delay by half a millisecond. Ten missed
// deadlines within a second also stop the arms (kMissedShare).
inline constexpr double kLateOnce = 2, kLateInSum = 6;  // [ms]
// The letters of a key arrive every 33 ms and pass through two threads of ordinary priority. After
// 100 ms without a letter, the key counts as released.
inline constexpr double kLetterLate = 30;                                            // [ms]
inline constexpr std::uint64_t kJustBefore = 500'000'000, kASecond = 1'500'000'000;  // [ns]

// `once` is the lateness within kJustBefore of the stop. `sum` is the lateness within kASecond.
inline Late Judge(const std::string& screen, bool letter_was_late, const RigLateness& once,
                  double sum) {
  if (screen.find("the stop 'enabling'") != std::string::npos)
    return letter_was_late || once.ordinary >= kLetterLate ? Late::kComputer : Late::kNothing;
  bool late = false;
  for (const char* sign : kLateSigns) late |= screen.find(sign) != std::string::npos;
  if (!late) return Late::kNothing;
  return once.processor >= kLateOnce || once.rig >= kLateOnce || sum >= kLateInSum ? Late::kComputer
                                                                                   : Late::kProgram;
}

// Returns the lines of the screen that report a stop, lateness, or the loop's own delays.
inline std::string StopWords(const std::string& screen) {
  std::istringstream lines(screen);
  std::string words;
  for (std::string line; std::getline(lines, line);) {
    bool relevant = line.find("the stop '") != std::string::npos || line.starts_with("Loop: ");
    for (const char* sign : kLateSigns) relevant |= line.find(sign) != std::string::npos;
    if (relevant) words += "\n  " + line.substr(0, line.find('\r'));
  }
  return words.empty() ? "\n  (no message about a stop)" : words;
}

class Attempts {
 public:
  static constexpr int kMax = 12;

  bool Next() { return count_++ < kMax; }
  // Waits until a second has passed without a delay that would stop the arms, but at most half a
  // minute. Tests that need many seconds without such a delay call this first.
  static void AwaitCalm(FakeRig* rig) {
    for (int i = 0; i < 300; ++i) {
      const std::uint64_t now = Terminal::Now();
      if (rig->Late(now - 1'000'000'000, now).processor < kLateOnce) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }

  // Returns whether the computer's lateness spoiled the attempt. The test fails if the program was
  // late but the computer was not.
  bool WasSpoiled(const Terminal& terminal, FakeRig* rig) {
    const std::uint64_t at = terminal.stop_seen();
    const RigLateness once = rig->Late(at - kJustBefore, at),
                      long_before = rig->Late(at - kASecond, at);
    const std::string screen = terminal.Screen();
    const Late late = Judge(screen, terminal.letter_was_late(), once, long_before.processor_sum);
    if (late != Late::kNothing) Note(screen, once, long_before.processor_sum);
    if (late == Late::kProgram)
      ADD_FAILURE() << "The program was late although the computer was not:" << words_ << "\n"
                    << screen;
    return late == Late::kComputer;
  }
  // Returns whether the computer has been late since `from` [ns]. Tests that kill the program use
  // this function, because the killed program cannot report its lateness.
  bool ComputerWasLate(FakeRig* rig, std::uint64_t from) {
    const RigLateness late = rig->Late(from, Terminal::Now());
    if (late.processor < kLateOnce && late.rig < kLateOnce) return false;
    Note("", late, late.processor_sum);
    return true;
  }
  // Ends a run that has stopped, and judges its cause. Returns true if the computer's lateness
  // spoiled the run. Otherwise, the function makes the test fail and returns false.
  bool EndedByComputer(Terminal* terminal, FakeRig* rig) {
    terminal->Let();
    terminal->Kill(SIGINT);
    const int code = terminal->Wait();
    if (WasSpoiled(*terminal, rig)) return true;
    ADD_FAILURE() << "It ended with " << code << ", and nothing was late:\n" << terminal->Screen();
    return false;
  }

  void Note(const std::string& words) { words_ += "\n  " + words; }
  // Returns why each attempt ended. A test prints these reasons when it has no attempts left.
  std::string Words() const {
    return std::to_string(kMax) + " attempts, each spoiled by this computer:" + words_;
  }

 private:
  void Note(const std::string& screen, const RigLateness& once, double sum) {
    std::array<char, 256> text{};
    std::snprintf(text.data(), text.size(),
                  "\n  Far end: a processor late by %.1f ms, by %.1f ms in 1.5 s; the rig by %.1f "
                  "ms, a thread of ordinary priority by %.1f ms; the program silent for %.1f ms.",
                  once.processor, sum, once.rig, once.ordinary, once.silence);
    words_ += (screen.empty() ? "" : StopWords(screen)) + text.data();
  }

  int count_ = 0;
  std::string words_;
};

}  // namespace predictor
