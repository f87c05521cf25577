// Varies the quantities of a scenario for the stability map, one at a time.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

enum class MapAxis : int { kObjectMass, kHandMass, kDelay, kBandwidth, kLead };
inline constexpr int kMapAxes = 5;

struct MapAxisText {
  const char* file;      // file name of the plot, for example object_mass
  const char* quantity;  // for example "mass of the object"
  const char* unit;      // displayed unit
  double per_si;         // displayed value = per_si × SI value
  bool logarithmic;
};
const MapAxisText& TextOf(MapAxis axis);

// The basis of a map: the scenario, the lead of its runs and the values derived from its models.
struct MapBase {
  Scenario scenario;
  double lead = 0;         // chosen by `auto` or set by the scenario [s]
  double lag = 0;          // lag of the arms [s]
  double object_mass = 0;  // [kg]
  LinearModel world;       // of the virtual world, at the start
  Pose X_WO;               // of the object, at the start
  LinearModel untouched;   // `world` without contacts
};
// Throws InputError for a scenario that cannot be run or has no arms (mode: direct).
MapBase BaseOf(const Scenario& scenario);

// Returns the scenario's own value along an axis, in SI units.
double OwnValue(const MapBase& base, MapAxis axis);
bool IsOwn(const MapBase& base, MapAxis axis, double value);

// Returns the values to be mapped along an axis, in ascending order and in SI units. The values
// include the scenario's own value.
std::vector<double> MapValues(const MapBase& base, MapAxis axis);

// The scenario with another value of the varied quantity, and the corresponding lead [s]. An object
// with another mass keeps its shape, and its inertia changes in proportion. The sag of the object
// changes, and the arms' bases follow the object's handles. Throws InputError, for example if the
// cobot cannot carry the object.
struct Variant {
  Scenario scenario;
  double lead = 0;  // [s]
};
Variant VariantOf(const MapBase& base, MapAxis axis, double value);

}  // namespace predictor
