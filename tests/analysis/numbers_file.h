// Compares docs/numbers.csv, which the documents quote, with the values that the program computes.
#pragma once

#include "analysis/reproduce/reproduce.h"

namespace predictor {

// Fails unless the file has exactly this experiment's numbers: mean and deviation within 2 %, the
// largest value within 20 %. Under the paper's conditions the loop is unstable, so rounding errors
// grow with it, and the mathematical libraries of different processors round differently; there the
// tolerances are 15 % and 40 %. The time to rest ends with the last step that counts as motion, on
// a slow tail; its tolerance is 10 %.
void ExpectAsInNumbersFile(const ReproducedExperiment& experiment);

// The file's mean for a number of the experiment with this condition, quantity and unit; NaN if it
// has none.
double MeanInNumbersFile(const std::string& experiment, const ReproducedNumber& n);

}  // namespace predictor
