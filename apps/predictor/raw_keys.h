// Reads single keys from the terminal.
#pragma once

#include <termios.h>
#include <unistd.h>

#include <atomic>

namespace predictor {

// While this object exists, standard input returns each key at once without showing it. Ctrl-C
// still raises its signal. The destructor restores the terminal. Standard input must be a terminal,
// and this program must be in its foreground.
class RawKeys {
 public:
  // `every` reads all keys, including those that normally stop the output or suspend the program
  // (Ctrl-S, Ctrl-Z), because arms may be moving.
  explicit RawKeys(bool every) {
    tcgetattr(STDIN_FILENO, &before_);
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    if (every) {
      keys.c_iflag &= ~static_cast<tcflag_t>(IXON);
      keys.c_lflag &= ~static_cast<tcflag_t>(IEXTEN);
      keys.c_cc[VSUSP] = _POSIX_VDISABLE;
    }
    changed_ = true;
    tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  }
  ~RawKeys() {
    changed_ = false;
    tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawKeys(const RawKeys&) = delete;
  RawKeys& operator=(const RawKeys&) = delete;

  // Restores the terminal before the program ends without destructors. A signal handler may call
  // this function. In the background, the function does nothing, because the system would suspend
  // the program.
  static void RestoreAtOnce() noexcept {
    if (changed_ && tcgetpgrp(STDIN_FILENO) == getpgrp())
      tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }

  // The key Ctrl-Space sends the value 0, but elsewhere in the program 0 means that no key was
  // pressed.
  static char Read(char byte) { return byte != 0 ? byte : '\x01'; }

 private:
  // At most one object of this class may exist at a time.
  static inline termios before_{};
  static inline std::atomic<bool> changed_{false};
};

}  // namespace predictor
