// Opens recordings of the emulator and of other systems for the commands that judge the person.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "assessment/assessment.h"
#include "commands.h"

namespace predictor {

struct EvaluatedRun {
  std::string file;
  Scenario scenario;
  std::optional<ParticipantSpec> participant;         // empty: not known
  std::optional<double> object_mass;                  // [kg]; empty: not known
  std::optional<assessment::SceneMasses> masses;      // empty: not known
  std::optional<assessment::SafetyCollector> safety;  // empty: of another system
  assessment::PersonRun run;
  std::vector<tracks::BodyTrack> tracks;  // in the recording, then those of the command line
  double start_unix = 0;                  // of the recording [s]; 0: not known
  std::vector<std::string> notes;         // what an import could not find

  assessment::AssessOptions Options() const;
};

// Throws InputError if the person or the person's place is unknown, or if a track cannot be read.
EvaluatedRun OpenRun(const std::string& file, const PersonOptions& options,
                     const std::vector<std::string>& tracks);

}  // namespace predictor
