// Made-up results of the search for the stable stiffnesses.
#pragma once

#include <cmath>

#include "analysis/stability_map/stability_map.h"

namespace predictor {

// Returns samples around a boundary at 1000 N/m. The growth rates of the samples lie on a line,
// apart from `scatter`.
inline FoundExtent AboutAThousand(double scatter) {
  FoundExtent found;
  int sign = 1;
  for (const double k : {800.0, 950.0, 985.0, 1015.0, 1050.0, 1250.0}) {
    Growth growth;
    growth.rate = 2 * std::log(k / 1000) + scatter * sign;
    growth.grows = k > 1000;
    found.samples.push_back({k, growth});
    sign = -sign;
  }
  found.extent.boundaries = {{1000, true, 2}};
  return found;
}

}  // namespace predictor
