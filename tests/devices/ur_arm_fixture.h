// The fixture of the UR driver's tests. Each test runs for both generations of controllers.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "devices/ur_bench.h"

namespace predictor {

class UrArmTest : public testing::TestWithParam<FakeUrOptions> {
 protected:
  int period() const { return GetParam().version.major == 3 ? 8 : 2; }  // sample period [ms]
};

inline auto UrControllers() { return testing::Values(ESeries(), Cb3(3)); }
inline std::string NameOfController(const FakeUrOptions& options) {
  return options.version.major == 3 ? "Cb3" : "ESeries";
}

}  // namespace predictor
