#include <string>

#include "command_line.h"
#include "recording/preamble.h"
#include "simulation/engine_version.h"

namespace predictor {

std::string VersionText() {
  const std::string commit =
#include "commit.inc"
      ;
  std::string text = std::string("predictor ") + PREDICTOR_VERSION +
                     (commit.empty() ? "" : " (" + commit + ")") + ", recording format " +
                     recording::kFormat;
  for (const EngineKind engine : {EngineKind::kMujoco, EngineKind::kDart})
    if (const std::string version = EngineVersion(engine); !version.empty()) text += ", " + version;
  return text;
}

}  // namespace predictor
