// The test program also runs as the processes that are supervised.
#include <gtest/gtest.h>

#include <cstring>

#include "process/supervised_child.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], predictor::kTestSubcommand) == 0)
    return predictor::SupervisedChildMain();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
