// Ends a command when the program receives a signal.
#pragma once

#include <atomic>
#include <csignal>
#include <initializer_list>

namespace predictor {

inline std::atomic<bool> quit{false};  // a signal requested the end

// If the reader of the output disappears, the program continues, because the arms must still come
// to rest.
inline void QuitOn(std::initializer_list<int> signals) {
  for (const int signal : signals) std::signal(signal, [](int) { quit.store(true); });
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace predictor
