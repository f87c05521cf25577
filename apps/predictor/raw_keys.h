// Keys of the terminal one by one.
#pragma once

#include <termios.h>
#include <unistd.h>

namespace predictor {

// While it lives, standard input gives each key at once and shows none; Ctrl-C stays a signal. The
// terminal is put back at the end. Standard input must be a terminal, and ours at the moment.
class RawKeys {
 public:
  RawKeys() {
    tcgetattr(STDIN_FILENO, &before_);
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  }
  ~RawKeys() { tcsetattr(STDIN_FILENO, TCSANOW, &before_); }
  RawKeys(const RawKeys&) = delete;
  RawKeys& operator=(const RawKeys&) = delete;

 private:
  termios before_{};
};

}  // namespace predictor
