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
  StopCause stopped = StopCause::kNone;  // what first stopped it; kNone: nothing
};

PersonRun RunOf(const SampleCollector& ticks);
// In a row, a hand counts as not holding if it is not measured or does not hold.
PersonRun RunOf(const tracks::PersonFile& file);

// Converts the statements of such a file about person, place and grips. The type of the operator is
// `virtual` if it was simulated, and otherwise `imported`.
Scenario ScenarioOf(const tracks::PersonHeader& header, const tracks::BodyTrack& track);

}  // namespace predictor::assessment
