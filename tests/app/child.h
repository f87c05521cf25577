// The program as a process of its own, and the scenarios that it is given.
#pragma once

#include "app/child_process.h"

namespace predictor {

inline std::string Scenario(const std::string& name) {
  return std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name + ".yaml";
}

}  // namespace predictor
