// Keys of the terminal one by one.
#pragma once

#include <termios.h>
#include <unistd.h>

namespace predictor {

// While it lives, standard input gives each key at once and shows none; Ctrl-C stays a signal. The
// terminal is put back at the end. Standard input must be a terminal, and ours at the moment.
class RawKeys {
 public:
  // every: no key holds the output back or suspends the program (Ctrl-S, Ctrl-Z), as they would
  // while arms move: each is read.
  explicit RawKeys(bool every) {
    tcgetattr(STDIN_FILENO, &before_);
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    if (every) {
      keys.c_iflag &= ~static_cast<tcflag_t>(IXON);
      keys.c_lflag &= ~static_cast<tcflag_t>(IEXTEN);
      keys.c_cc[VSUSP] = _POSIX_VDISABLE;
    }
    tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  }
  ~RawKeys() { tcsetattr(STDIN_FILENO, TCSANOW, &before_); }
  RawKeys(const RawKeys&) = delete;
  RawKeys& operator=(const RawKeys&) = delete;

  // Ctrl-Space sends 0, which stands for no key elsewhere.
  static char Read(char byte) { return byte != 0 ? byte : '\x01'; }

 private:
  termios before_{};
};

}  // namespace predictor
