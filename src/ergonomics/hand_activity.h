// The hand activity level (HAL) of ACGIH for tasks with one hand that last at least four hours a
// day: how often and for how long a hand exerts itself, compared with the force that it needs.
//
// The constants are those of the edition of 2001. ACGIH revised the limits in 2018, and we found no
// open source for the later limits. The limits are therefore in a file of the user.
#pragma once

namespace predictor::ergonomics {

// Returns the hand activity level, 0 … 10, from the frequency F of exertions [1/s] and the duty
// cycle `duty`, 0 … 1, which is D as a share: 6.56 ln D F^1.31 / (1 + 3.18 F^1.31) with D in %
// (Radwin et al. 2015, equation 3; verified in two abstracts, and with 11 cells of the paper's
// table 3 in an independent transcription). Results below 0 and above 10 are set to 0 and 10
// (design choice).
double HandActivityLevel(double frequency, double duty);

// Returns whether the equation was fitted to data for these values: 0.125 … 1.67 exertions per
// second and a duty cycle of 11 … 100 % (from one transcription of the paper). Other results are
// extrapolated.
bool HandActivityWasStudied(double frequency, double duty);

// Returns the ratio that is compared with the limits, NPF / (10 − HAL) (worksheet of Bernard and
// ACGIH 2002; verified). `normalized_force` is the normalized peak force NPF, 0 … 10, where 10 is
// the strength of the person or population. If `level` is 10, the ratio of a positive force is
// infinite.
double HandActivityRatio(double normalized_force, double level);

}  // namespace predictor::ergonomics
