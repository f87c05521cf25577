// The two groups for which published tables of bodies and strength give separate figures.
#pragma once

namespace predictor {

enum class Sex { kFemale, kMale };

}  // namespace predictor
