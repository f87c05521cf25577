// States what two compared designs differ in, so that a difference of their results is not
// attributed to a single one of these changes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor::assessment {

struct ComparedDesign {
  std::string name;
  std::optional<Scenario> scenario;   // empty: not known, because another system made the recording
  std::optional<double> object_mass;  // [kg]; empty: not known
  double handle_height = 0;  // of the point midway between the handles above the ground, at the
                             // start [m]
};

inline constexpr const char* kDesignsDiffer =
    "The designs differ in the following. The results show the effect of all of it together.";
// Returns one line for each difference: the object's mass, the height of the handles, and the keys
// of the scenario.
std::vector<std::string> DesignDifferences(const ComparedDesign& a, const ComparedDesign& b);

// Above this difference of the handles' heights, the posture changes so much that the results
// hardly show the effect of other changes (design choice) [m].
inline constexpr double kSameHandleHeight = 0.05;
// Returns a warning, or "" if the handles start at about the same height.
std::string HandleHeightWarning(const ComparedDesign& a, const ComparedDesign& b);

}  // namespace predictor::assessment
