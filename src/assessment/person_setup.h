// The person of a recorded run: body, stance and grips, and what of them is not known.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/record.h"
#include "person/body_sample.h"
#include "scenario/scenario.h"

namespace predictor::assessment {

// Something that could not be computed, and why.
struct NotEvaluable {
  std::string what, why;
};

// What the scenario must say before a posture can be judged and does not, as sentences that say
// what to do. Empty: nothing is missing.
std::vector<std::string> MissingForPosture(const Scenario& scenario);

struct PersonSetup {
  BodySpec body;
  person::Stance stance;
  std::array<person::Grip, kHands> grips;
};

// `first`: a record in which the handles have their places at the start; the wrists are on the
// person's side of them. Throws InputError if something is missing or no adult has such a body.
PersonSetup SetupOf(const Scenario& scenario, const TickRecord& first);

}  // namespace predictor::assessment
