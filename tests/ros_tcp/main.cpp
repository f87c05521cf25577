// The tests' program is also the server's process, as `predictor` is.
#include <gtest/gtest.h>

#include <cstring>

#include "ros_tcp/ros_tcp_process.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], predictor::kRosTcpSubcommand) == 0)
    return predictor::RosTcpMain();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
