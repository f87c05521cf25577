#include "commands.h"
#include "scenario/scenario_io.h"

namespace predictor {

int SchemaCommand() {
  WriteOut(ScenarioSchema());
  return kFinished;
}

}  // namespace predictor
