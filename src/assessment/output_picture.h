// Pictures of the body as HTML with SVG, coloured by load.
#pragma once

#include <string>

#include "assessment/assessment.h"

namespace predictor::assessment {

// "#rrggbb" of a load between 0 and 1 and above: light green, amber, dark red. The colours become
// darker, so that they can be distinguished without seeing red and green.
std::string LoadColor(double share);

// The body at the worst moment from the side and from the front, its loads as a table, and the
// course of the run in small pictures.
std::string PicturesHtml(const Assessment& a);

}  // namespace predictor::assessment
