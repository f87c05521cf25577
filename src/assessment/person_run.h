// The part of a run that the evaluation uses: the samples of the hands, from a recording of the
// emulator or of another system.
#pragma once

#include <array>
#include <vector>

#include "assessment/hand_samples.h"
#include "scenario/scenario.h"
#include "tracks/person_file.h"

namespace predictor::assessment {

struct PersonRun {
  std::vector<PersonSample> samples;
  std::array<Pose, kHands> handles;      // X_WD at the start, of existing handles
  StopCause stopped = StopCause::kNone;  // first cause of a stop; kNone: not stopped
};

PersonRun RunOf(const SampleCollector& ticks);
// A hand counts as holding a handle only in rows that contain a measurement of the hand and state
// that the hand holds a handle.
PersonRun RunOf(const tracks::PersonFile& file);

// Returns a scenario made from the person, place and grips of an imported recording. The type of
// the operator is `virtual` if the operator was simulated, and otherwise `imported`.
Scenario ScenarioOf(const tracks::PersonHeader& header, const tracks::BodyTrack& track);

}  // namespace predictor::assessment
