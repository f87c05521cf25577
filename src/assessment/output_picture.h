// Draws pictures of the body, coloured by load, as HTML with SVG.
#pragma once

#include <string>

#include "assessment/assessment.h"

namespace predictor::assessment {

// Returns the colour "#rrggbb" of a load: light green at 0, then amber, and dark red at 1 and
// above. The colours become steadily darker, so that colour-blind people can also distinguish the
// colours.
std::string LoadColor(double share);

// Shows the body at the worst time from the side and from the front, its loads as a table, and
// small pictures over the course of the run.
std::string PicturesHtml(const Assessment& a);

}  // namespace predictor::assessment
