// Whether a person holds a key of a terminal, which tells letters and nothing else.
#pragma once

namespace predictor {

// What the letters of a key tell, each once.
enum class KeySign {
  kNone,
  kTouched,  // it came, and had not for kFirstRepeat
  kHeld,     // it came again: from now on it counts as held
  kGoesOn,   // it came again while it is held
  kNotHeld,  // it was touched, and did not come again for kFirstRepeat
  kLate,     // its letters came together, and none after them for kFirstRepeat
};

// A key that is held sends its letter again and again; it is held from the second one on, until it
// has been silent.
//
// Letters tell when they come, not when they were pressed: what stood in line (a network that
// stalled, a busy computer) comes all at once, maybe after the hand has gone elsewhere. No hand and
// no terminal is as quick as kTogether, so letters so near to one another are a backlog, and none
// of them counts. Hence a letter counts only once nothing has followed it for as long: the first of
// a backlog looks like any other. A key that is held already is not let go by them (two letters
// come together now and then where a computer is busy), but they are one sign, and they came within
// kSilence of the one before.
class HeldKey {
 public:
  static constexpr double kFirstRepeat = 0.8;  // before a terminal repeats a key [s]
  static constexpr double kSilence = 0.1;      // of a key that was let go [s]
  static constexpr double kTogether = 0.01;    // [s]

  explicit HeldKey(char key) : key_(key) {}

  // To be called often: at least every kTogether, and with each key that came, or 0. Another key
  // lets go. now [s]: when it was read; the same for what was read at once.
  KeySign Update(char key, double now);
  bool held() const { return letters_ >= 2; }
  char key() const { return key_; }

 private:
  void LetGo() { letters_ = 0, waits_ = open_ = false; }
  KeySign Settle(double now);
  KeySign Take(double now);

  char key_;
  double last_ = -1e9;  // letter [s]
  double sign_ = -1e9;  // of being held, the last [s]
  int letters_ = 0;     // that count, since it was let go
  bool waits_ = false;  // the last letter: whether another follows
  bool fresh_ = false;  // the last letter is the first for kFirstRepeat
  bool open_ = false;   // letters came, and it is not held
  bool late_ = false;   // they came together
};

}  // namespace predictor
