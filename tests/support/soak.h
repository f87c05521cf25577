// Supports long variants of tests. ./dev soak sets PREDICTOR_SOAK, and tests named *Soak* then run
// in full.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace predictor {

inline bool InFull() { return std::getenv("PREDICTOR_SOAK") != nullptr; }

// Returns `full` in ./dev soak, and `sample` otherwise. ./dev soak copies the value into
// docs/soak-record.csv.
inline long Count(long sample, long full) {
  if (!InFull()) return sample;
  std::printf("soak: count=%ld\n", full);
  return full;
}

// Ends a test if this computer never kept real time. In a sample, the test is skipped. In a full
// run, or if PREDICTOR_REAL_TIME=required states that the computer is quiet, the test fails.
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
