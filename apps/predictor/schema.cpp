#include "commands.h"
#include "evaluation/summary.h"
#include "scenario/machine.h"
#include "scenario/scenario_io.h"

namespace predictor {

int ScenarioSchemaCommand() {
  WriteOut(ScenarioSchema());
  return kFinished;
}

int MachineSchemaCommand() {
  WriteOut(MachineSchema());
  return kFinished;
}

int SummarySchemaCommand() {
  WriteOut(SummarySchema());
  return kFinished;
}

}  // namespace predictor
