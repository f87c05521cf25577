#include "simulation/engine_version.h"

#include "simulation/dart/dart_process.h"
#include "simulation/mujoco/library.h"

namespace predictor {

std::string EngineVersion(EngineKind engine) {
  if (engine == EngineKind::kDart) return DartVersion();
  return std::string("MuJoCo ") + mj_versionString();
}

}  // namespace predictor
