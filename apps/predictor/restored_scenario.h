// The scenario of a recording, for commands that also work without it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recorded_run.h"
#include "recording/reader.h"
#include "scenario/scenario.h"

namespace predictor {

// The recorded scenario, with those of its model files that the recording still contains.
class RestoredScenario {
 public:
  explicit RestoredScenario(const RecordingHeader& header);

  const std::optional<Scenario>& scenario() const { return scenario_; }
  const std::string& problem() const { return problem_; }
  // Returns which joints of the recorded cobot are prismatic. If the recording has lost the model
  // of the cobot, the list is empty.
  std::vector<bool> PrismaticJoints() const;

 private:
  TemporaryFolder folder_;
  std::optional<Scenario> scenario_;
  std::string problem_;
};

}  // namespace predictor
