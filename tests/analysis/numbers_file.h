// Compares docs/numbers.csv, which the documents quote, with the values that the program computes.
#pragma once

#include "analysis/reproduce/reproduce.h"

namespace predictor {

// Fails unless the file has exactly this experiment's numbers. The mean and the deviation must
// agree within 2 %, the largest value within 20 %. Under the paper's conditions the loop is
// unstable, so rounding errors grow. The mathematical libraries of different processors round
// differently. For these conditions, the tolerances are therefore 15 % and 40 %. The tolerance of
// the time to rest is 10 %, because it ends with the last step that counts as motion, in a slow
// decay.
void ExpectAsInNumbersFile(const ReproducedExperiment& experiment);

// Returns the file's mean for a number of the experiment with this condition, quantity and unit, or
// NaN if the file has no such number.
double MeanInNumbersFile(const std::string& experiment, const ReproducedNumber& n);

}  // namespace predictor
