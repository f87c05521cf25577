// Restores the scenario of a recording.
#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <vector>

#include "recording/header.h"
#include "scenario/scenario.h"

namespace predictor {

// The recorded scenario, with those of its model files that the recording still contains. The model
// files are in a temporary folder, which the destructor removes.
class RestoredScenario {
 public:
  // Throws std::runtime_error if the temporary folder cannot be created.
  explicit RestoredScenario(const RecordingHeader& header);

  // Throws InputError if the recording has lost the scenario or a model.
  const Scenario& Get() const;

  // Returns which joints of the recorded cobot are prismatic. If the recording has lost the model
  // of the cobot, the list is empty.
  std::vector<bool> PrismaticJoints() const;

 private:
  class TemporaryFolder {
   public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

   private:
    std::filesystem::path path_;
  };

  TemporaryFolder folder_;
  std::optional<Scenario> scenario_;
  std::exception_ptr error_;  // an InputError; null if there is a scenario
};

}  // namespace predictor
