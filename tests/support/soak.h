// Long variants of tests: ./dev soak sets PREDICTOR_SOAK, and tests named *Soak* then run in full.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace predictor {

inline bool InFull() { return std::getenv("PREDICTOR_SOAK") != nullptr; }

// Returns `full` in ./dev soak, which reads this value for docs/soak-record.csv, otherwise
// `sample`.
inline long Count(long sample, long full) {
  if (!InFull()) return sample;
  std::printf("soak: count=%ld\n", full);
  return full;
}

// Ends a test if this computer never kept real time. The test is skipped in a sample. The test
// fails in a full run, and if PREDICTOR_REAL_TIME=required promises a quiet computer.
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
