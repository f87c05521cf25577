// The test program also serves as the viewer's process, as `predictor` does.
#include <gtest/gtest.h>

#include <cstring>

#include "viewer/viewer_process.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], predictor::viewer::kViewerSubcommand) == 0)
    return predictor::viewer::ViewerMain();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
