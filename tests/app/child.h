// Runs the program as a separate process and provides scenarios for it.
#pragma once

#include "app/child_process.h"

namespace predictor {

inline std::string Scenario(const std::string& name) {
  return std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name + ".yaml";
}

}  // namespace predictor
