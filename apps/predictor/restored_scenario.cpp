#include "restored_scenario.h"

#include "core/error.h"
#include "models/arm_model.h"
#include "recording/provenance.h"

namespace predictor {

RestoredScenario::RestoredScenario(const RecordingHeader& header) {
  try {
    scenario_ = RestoreScenario(header, folder_.path());
  } catch (const InputError& error) {
    problem_ = error.what();
  }
}

std::vector<bool> RestoredScenario::PrismaticJoints() const try {
  return scenario_ ? predictor::PrismaticJoints(*scenario_) : std::vector<bool>();
} catch (const InputError&) {
  return {};
}

}  // namespace predictor
