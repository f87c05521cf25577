#include <gtest/gtest.h>

#include "simulation/mujoco/library.h"

namespace predictor {
namespace {

// By default, an error in the engine would end the process.
TEST(Engine, ReturnsFromAnError) {
  SilenceMujoco();
  const auto fail = [](const mjModel*, mjData*) { mju_error("arena overflow"); };
  const auto pass = [](const mjModel*, mjData*) { mju_warning("of no weight"); };
  EXPECT_FALSE(Guarded(fail, nullptr, nullptr));
  EXPECT_TRUE(Guarded(pass, nullptr, nullptr));
  EXPECT_FALSE(Guarded(fail, nullptr, nullptr));
}

}  // namespace
}  // namespace predictor
