// Maps the stiffest walls against which a haptic loop is stable.
#pragma once

#include <string>
#include <vector>

#include "analysis/stability_map/stability_map.h"
#include "report/page.h"

namespace predictor {

// Returns the pictures without their predictions. There is one picture for each wall that the
// scenario's fixtures and table form or, without such walls, one picture for an assumed wall
// without damping below the object.
std::vector<WallPicture> WallPicturesOf(const MapBase& base);

// Returns the scenario with the delay and lead of a line, and with another mass of the hands [kg].
Variant WallVariantOf(const MapBase& base, const WallLine& line, double hand_mass);

// Predicts the stiffnesses of a wall, up to kStiffestWall, for which the loop is stable.
StableExtent PredictWall(const MapBase& base, const Variant& variant, const ContactWall& at);

// Returns a description of a wall, for example "fixtures 0 and 2, normal [0, 0, 1], damping 60
// N·s/m".
std::string WallInWords(const WallPicture& picture);

// These functions return the plot of one wall, and the lines about all walls for the terminal.
Plot WallPlot(const StabilityMap& map, std::size_t wall);
std::string WallText(const StabilityMap& map);
// Adds the chapter about the walls.
void AddWalls(const StabilityMap& map, ReportPage* page);

}  // namespace predictor
