// The test program also serves as the watchdog's process, as `predictor` does.
#include <gtest/gtest.h>

#include <cstring>

#include "watchdog/watchdog_process.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], predictor::watchdog::kWatchdogSubcommand) == 0)
    return predictor::watchdog::WatchdogMain();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
