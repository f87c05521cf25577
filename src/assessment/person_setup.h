// The person in a recorded run: the body, the stance, the grips, and a list of unknown values.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/record.h"
#include "person/body_sample.h"
#include "scenario/scenario.h"

namespace predictor::assessment {

// A result that could not be computed, and the reason.
struct NotEvaluable {
  std::string what, why;
};

// Returns instructions that state which keys the scenario needs before a posture can be judged. The
// list is empty if nothing is missing.
std::vector<std::string> MissingForPosture(const Scenario& scenario);

struct PersonSetup {
  BodySpec body;
  person::Stance stance;
  std::array<person::Grip, kHands> grips;
};

// `handles` contains the poses X_WD at the start. The wrists are on the person's side of the
// handles. Throws InputError if something is missing or no adult has such a body.
PersonSetup SetupOf(const Scenario& scenario, const std::array<Pose, kHands>& handles);
// `first` is a record with the initial places of the handles.
PersonSetup SetupOf(const Scenario& scenario, const TickRecord& first);

}  // namespace predictor::assessment
