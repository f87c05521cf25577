// The long counts: ./dev soak sets PREDICTOR_SOAK; tests named *Soak* then run in full.
#pragma once

#include <cstdlib>
#include <string_view>

namespace predictor {

inline bool InFull() { return std::getenv("PREDICTOR_SOAK") != nullptr; }

// `full` in ./dev soak, `sample` otherwise.
inline long Count(long sample, long full) { return InFull() ? full : sample; }

// Ends a test that found no time in which this computer kept real time: skipped in a sample, failed
// in full and where PREDICTOR_REAL_TIME=required says that this computer is quiet.
inline bool RealTimeIsRequired() {
  const char* says = std::getenv("PREDICTOR_REAL_TIME");
  return InFull() || (says && std::string_view(says) == "required");
}
#define GIVE_UP_BUSY(what)                                                       \
  do {                                                                           \
    if (RealTimeIsRequired()) FAIL() << "This computer is too busy: " << (what); \
    GTEST_SKIP() << "This computer is too busy for real time: " << (what);       \
  } while (false)

}  // namespace predictor
