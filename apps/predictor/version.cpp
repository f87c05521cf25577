#include <string>

#include "command_line.h"
#include "recording/preamble.h"

namespace predictor {

std::string VersionText() {
  const std::string commit =
#include "commit.inc"
      ;
  return std::string("predictor ") + PREDICTOR_VERSION +
         (commit.empty() ? "" : " (" + commit + ")") + ", recording format " + recording::kFormat;
}

}  // namespace predictor
