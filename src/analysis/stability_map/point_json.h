// The form in which a stability map stores its finished points.
#pragma once

#include <nlohmann/json.hpp>

#include "analysis/stability_map/stability_map.h"

namespace predictor {

nlohmann::ordered_json JsonOf(const MapPoint& point);
// Returns false if the point is damaged or from another version of the program. In this case,
// `point` is unchanged.
bool ReadPoint(const nlohmann::ordered_json& json, MapPoint* point);

}  // namespace predictor
