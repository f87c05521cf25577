// What the stability map varies of a scenario, one thing at a time.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

enum class MapAxis : int { kObjectMass, kHandMass, kDelay, kBandwidth, kLead };
inline constexpr int kMapAxes = 5;

struct MapAxisText {
  const char* file;      // as in object_mass.svg
  const char* quantity;  // as in "mass of the object"
  const char* unit;      // as shown
  double per_si;         // shown = per_si × SI
  bool logarithmic;
};
const MapAxisText& TextOf(MapAxis axis);

// What a map starts from: the scenario, the lead that its runs use and what follows of its models.
struct MapBase {
  Scenario scenario;
  double lead = 0;         // chosen by `auto`, or the scenario's [s]
  double lag = 0;          // of the arms [s]
  double object_mass = 0;  // [kg]
};
// Throws InputError: a scenario that cannot be run, or that has no arms (mode: direct).
MapBase BaseOf(const Scenario& scenario);

// The scenario's own value along an axis, SI.
double OwnValue(const MapBase& base, MapAxis axis);
bool IsOwn(const MapBase& base, MapAxis axis, double value);

// Values along an axis to be mapped, ascending, SI; the scenario's own is one of them.
std::vector<double> MapValues(const MapBase& base, MapAxis axis);

// The scenario with another value, and the lead that goes with it [s]. An object of another mass
// keeps its shape, so that its inertia changes in proportion; it sags by another length, and the
// arms' bases follow its handles. Throws InputError, also where a cobot cannot carry the object.
struct Variant {
  Scenario scenario;
  double lead = 0;  // [s]
};
Variant VariantOf(const MapBase& base, MapAxis axis, double value);

}  // namespace predictor
