// The two groups for which the sources give separate figures.
#pragma once

namespace predictor::ergonomics {

enum class Sex { kFemale, kMale };

}  // namespace predictor::ergonomics
