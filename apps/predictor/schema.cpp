#include "commands.h"
#include "scenario/machine.h"
#include "scenario/scenario_io.h"

namespace predictor {

int SchemaCommand(bool machine) {
  WriteOut(machine ? MachineSchema() : ScenarioSchema());
  return kFinished;
}

}  // namespace predictor
