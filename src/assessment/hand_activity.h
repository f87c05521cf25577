// The hand activity level of ACGIH for each hand of a run, from its measured force.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assessment/hand_samples.h"
#include "assessment/person_chain.h"
#include "assessment/quantities.h"

namespace predictor::assessment {

// A hand exerts itself from the time at which its measured force exceeds kExertionBegins until the
// force falls below kExertionEnds. A pause shorter than kShortestPause does not end the exertion
// (design choices). A tight grip without a force on the handle is not measured, so it is not an
// exertion.
inline constexpr double kExertionBegins = 5, kExertionEnds = 2.5;  // [N]
inline constexpr double kShortestPause = 0.5;                      // [s]

struct HandActivity {
  int hand = 0;
  std::size_t exertions = 0;
  double frequency = 0;   // exertions per second of the run
  double duty = 0;        // share of the run in which the hand exerts itself
  double level = 0;       // HAL, 0 … 10
  bool studied = true;    // see HandActivityWasStudied
  double peak_force = 0;  // 90th percentile of the measured force during the exertions [N]
  // The normalized peak force, 0 … 10. If the effort of the grip was stated, it is this effort.
  // Otherwise it is the 90th percentile, during the exertions, of the larger share of strength of
  // elbow and shoulder, times 10. This value is a lower bound, because the grip itself is not
  // measured. Not a number if no posture is known during the exertions.
  double normalized_force = 0;
  bool stated = false;
  double ratio = 0;          // NPF / (10 − HAL); a lower bound if not `stated`
  std::vector<bool> exerts;  // at each sample in which a hand holds a handle
};

// `all` are all samples of the run, and `nominal` is the nominal person at the samples in which a
// hand holds a handle.
HandActivity HandActivityOf(int hand, std::span<const PersonSample> all,
                            const NominalChain& nominal, std::optional<double> grip_effort);

// Returns the kind of the ratio in a file of limits, "hands.left.activity_ratio". The ratio has one
// value for the whole run, so `of` is null.
const QuantityKind& ActivityRatioKind(int hand);

std::string Sentence(const HandActivity& activity);

}  // namespace predictor::assessment
