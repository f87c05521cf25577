#include "restored_scenario.h"

#include <cstdlib>
#include <stdexcept>

#include "core/error.h"
#include "models/arm_model.h"
#include "recording/provenance.h"

namespace predictor {

RestoredScenario::TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "predictor-XXXXXX").string();
  if (!mkdtemp(name.data()))
    throw std::runtime_error("a temporary folder could not be created in " +
                             std::filesystem::temp_directory_path().string());
  path_ = name;
}

RestoredScenario::TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

RestoredScenario::RestoredScenario(const RecordingHeader& header) {
  try {
    scenario_ = RestoreScenario(header, folder_.path());
  } catch (const InputError&) {
    error_ = std::current_exception();
  }
}

const Scenario& RestoredScenario::Get() const {
  if (error_) std::rethrow_exception(error_);
  return *scenario_;
}

std::vector<bool> RestoredScenario::PrismaticJoints() const try {
  return scenario_ ? predictor::PrismaticJoints(*scenario_) : std::vector<bool>();
} catch (const InputError&) {
  return {};
}

}  // namespace predictor
