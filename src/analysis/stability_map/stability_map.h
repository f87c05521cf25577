// The stability map of a scenario: how stiff a hand may be before the haptic loop oscillates,
// against masses, delay, bandwidth and lead; predicted by the linearised loop and found by
// simulation.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/stability_map/extent.h"
#include "analysis/stability_map/variant.h"

namespace predictor {

inline constexpr double kAgreement = 0.2;  // of found with predicted, where the assumptions hold
// Share of ticks in which a limit may act on the stable side of a boundary that the prediction,
// which knows no limits, is still held to.
inline constexpr double kLimitedShare = 0.01;

// Rate of the loop and of its readings below which the prediction, which is continuous, is not held
// against the simulation [Hz].
inline constexpr double kLeastMapRate = 500;

// Uncertainty of a found boundary beyond which it cannot be judged: half of kAgreement.
inline constexpr double kMostUncertain = 0.1;

struct MapPoint {
  double value = 0;        // along the axis, SI
  std::string impossible;  // why there is nothing here: a cobot that cannot carry the object
  StableExtent predicted;
  bool simulated = false;
  FoundExtent found;  // if simulated
};

struct MapPicture {
  MapAxis axis = MapAxis::kObjectMass;
  std::vector<MapPoint> points;  // ascending
};

struct StabilityMap {
  MapBase base;
  StiffnessRange range;
  std::array<MapPicture, kMapAxes> pictures;
  std::vector<std::string> departures;  // from the prediction's assumptions, of the whole scenario
  double growth_time = kGrowthTime;     // simulated for each sign [s]
  int kept = 0;                         // points that were taken from an earlier run
};

struct MapOptions {
  std::filesystem::path folder;  // of results and pictures; made if it is not there
  StiffnessRange range;
  double growth_time = kGrowthTime;  // [s]
  int workers = 0;                   // 0: as many as the machine has cores
  // Called from the caller's thread alone.
  std::function<void(double share, const std::string& what)> progress = [](double,
                                                                           const std::string&) {};
};

// Computes what is not in the folder yet. Each finished point is written down at once, under a key
// of the scenario's content and of what this program makes of it, so that a map that was
// interrupted goes on where it was and nothing outdated is taken over. Throws InputError.
StabilityMap MakeStabilityMap(const Scenario& scenario, const MapOptions& options);

// Why the prediction need not hold for a scenario as a whole, in sentences; empty: it must.
std::vector<std::string> DeparturesOf(const Scenario& scenario);

// Why the prediction need not hold for a boundary that was found, in words; empty: it must. By what
// was seen in the simulations beside the boundary, and never by how far the two are apart: limits
// that act on its stable side, limits that noise alone reaches on the other, and a growth that says
// too little about the stiffness.
std::vector<std::string> DeparturesAt(const FoundExtent& found, const Boundary& boundary);
// The same where no stiffness was found to be stable.
std::vector<std::string> DeparturesEverywhere(const FoundExtent& found);
// Relative uncertainty of a found boundary (two standard errors), from how far the growth rates
// beside it lie off a line through them; nothing if there are fewer than three.
std::optional<double> UncertaintyOf(const FoundExtent& found, const Boundary& boundary);

// A boundary that was predicted or found, or both.
struct BoundaryPair {
  bool critical = true;  // the stiffest hand; else the softest
  const Boundary* predicted = nullptr;
  const Boundary* found = nullptr;
  std::vector<std::string> departures;  // of the found one

  double ratio() const { return found->stiffness / predicted->stiffness; }
  bool agrees() const { return predicted && found && std::abs(ratio() - 1) <= kAgreement; }
};
std::vector<BoundaryPair> PairsOf(const MapPoint& point);

// How prediction and simulation agree, over all boundaries of a map; each is counted once, though
// the scenario's own values are in every picture.
struct MapAgreement {
  int held = 0, held_agree = 0;    // where the assumptions hold
  int other = 0, other_agree = 0;  // where they do not
  int one_sided = 0;               // predicted or found only
  double worst_ratio = 1;          // of `held`
};
MapAgreement AgreementOf(const StabilityMap& map);

// One picture (SVG that goes with light and dark), the page with all of them (HTML that needs no
// other file), and a few lines for a terminal.
std::string MapSvg(const StabilityMap& map, const MapPicture& picture);
std::string MapPage(const StabilityMap& map);
std::string MapText(const StabilityMap& map);

// Writes index.html and the pictures into the folder. Throws InputError.
void WriteStabilityMap(const StabilityMap& map, const std::filesystem::path& folder);

}  // namespace predictor
