#include <cstdio>

#include "commands.h"
#include "scenario/scenario_io.h"

namespace predictor {

int SchemaCommand() {
  std::fputs(ScenarioSchema().c_str(), stdout);
  return kFinished;
}

}  // namespace predictor
