// The tests' program is also the viewer's process, as `predictor` is.
#include <gtest/gtest.h>

#include <cstring>

#include "viewer/viewer_process.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], predictor::kViewerSubcommand) == 0)
    return predictor::ViewerMain();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
