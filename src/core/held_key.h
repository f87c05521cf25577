// Detects whether a person holds a key at a terminal, which reports only the letters it receives.
#pragma once

namespace predictor {

// Events of a key, each reported once.
enum class KeySign {
  kNone,
  kTouched,    // a letter arrived after at least kFirstRepeat without one
  kHeld,       // a second letter arrived: the key now counts as held
  kContinues,  // another letter arrived while the key is held
  kNotHeld,    // the key was only tapped; no second letter arrived within kFirstRepeat
  kLate,       // the letters arrived together, and none followed within kFirstRepeat
};

// A key that is held sends its letter repeatedly. The key counts as held from the second letter
// until no letter has arrived for kSilence.
//
// The program knows when a letter arrived, but not when its key was pressed. After a delay (a
// stalled network or a busy computer), the queued letters arrive together, perhaps after the hand
// has moved elsewhere. Neither a person nor a terminal repeats a letter within kTogether. Letters
// that follow each other so closely are therefore a backlog and do not count. The first letter of a
// backlog cannot be distinguished from another letter. Therefore, a letter counts only if no other
// letter follows within kTogether.
//
// A backlog does not release a key that is already held, because on a busy computer two letters
// sometimes arrive together. These letters count as one event, provided that they arrived within
// kSilence of the previous letter.
class HeldKey {
 public:
  static constexpr double kFirstRepeat = 0.8;  // delay before a terminal repeats a key [s]
  static constexpr double kSilence = 0.1;      // silence after which a key counts as released [s]
  static constexpr double kTogether = 0.01;    // [s]

  explicit HeldKey(char key) : key_(key) {}

  // Call this function at least every kTogether, and with each received key. If no key was
  // received, `key` is 0. Any other key releases the held key. `now` is the time at which the key
  // was read [s]. Keys that were read together have the same time.
  KeySign Update(char key, double now);
  bool held() const { return letters_ >= 2; }
  char key() const { return key_; }

 private:
  void LetGo() { letters_ = 0, waits_ = open_ = false; }
  KeySign Settle(double now);
  KeySign Take(double now);

  char key_;
  double last_ = -1e9;  // time of the last letter [s]
  double sign_ = -1e9;  // time of the last event of a held key [s]
  int letters_ = 0;     // letters that count since the key was released
  bool waits_ = false;  // the last letter may still be followed by another
  bool fresh_ = false;  // the last letter is the first one within kFirstRepeat
  bool open_ = false;   // letters arrived, but the key is not held
  bool late_ = false;   // the letters arrived together
};

}  // namespace predictor
