// Makes the parts of the sentences that instruct a person.
#pragma once

#include <string>

#include "core/types.h"

namespace predictor {

std::string InCentimetres(double length);              // [m] → "30 cm"
std::string InDegrees(double angle);                   // [rad] → "20°"
std::string WithUnit(double value, const char* unit);  // three digits: "8 s"
std::string HandlesOf(const std::string& hand);        // "the handles", "the left handle"
// Returns "Lift the object by 10 cm and move it 30 cm to the left." `by` is in W [m].
std::string MoveSentence(const Vector3& by, double facing);
// Returns "down", "forward" or "to the left" for a unit vector along such a direction, seen by a
// person who faces `facing` [rad], and "" for any other unit vector. `direction` is in W.
std::string DirectionWords(const Vector3& direction, double facing);

}  // namespace predictor
