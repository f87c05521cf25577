// The test program also serves as the server's process, as `predictor` does.
#include <gtest/gtest.h>

#include <cstring>

#include "ros_tcp/ros_tcp_process.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], predictor::ros_tcp::kRosTcpSubcommand) == 0)
    return predictor::ros_tcp::RosTcpMain();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
