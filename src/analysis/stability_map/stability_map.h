// The stability map of a scenario shows the stiffness up to which the haptic loop does not
// oscillate. The map shows this stiffness for the hands as a function of masses, delay, bandwidth
// and lead, and also shows this stiffness for a wall. The linearised loop predicts these
// stiffnesses. For the hands, a simulation also determines these stiffnesses.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/check/contact.h"
#include "analysis/stability_map/extent.h"
#include "analysis/stability_map/variant.h"
#include "report/plot.h"

namespace predictor {

inline constexpr double kAgreement = 0.2;  // relative difference up to which found and predicted
                                           // boundaries agree, if the assumptions hold
// Largest share of ticks in which a limit may act on the stable side of a boundary. The prediction
// does not model limits, so a boundary with a larger share is not compared with the prediction.
inline constexpr double kLimitedShare = 0.01;

// The smallest rate of the loop and of the sensors' readings at which the continuous prediction is
// compared with the simulation [Hz].
inline constexpr double kMinMapRate = 500;

// If the uncertainty of a found boundary exceeds this value, which is half of kAgreement, the
// boundary cannot be judged.
inline constexpr double kMaxUncertainty = 0.1;

struct MapPoint {
  double value = 0;        // value on the axis, SI
  std::string impossible;  // why the point is empty: the cobot cannot carry the object
  StableExtent predicted;
  bool simulated = false;
  FoundExtent found;  // if it was simulated
};

struct MapPicture {
  MapAxis axis = MapAxis::kObjectMass;
  std::vector<MapPoint> points;  // ascending
};

// The largest stable stiffness of a wall that the object touches, as a function of the mass of each
// hand, for several delays of the arms' velocity loops. It is predicted only.
struct WallLine {
  double delay = 0;              // [s]
  double lead = 0;               // that a run with this delay uses [s]
  std::vector<MapPoint> points;  // by hand mass [kg], ascending; `predicted` concerns the wall
};
struct WallPicture {
  ContactWall at;               // no surfaces: it is assumed
  std::vector<WallLine> lines;  // ascending
};

struct StabilityMap {
  MapBase base;
  StiffnessRange range;
  std::array<MapPicture, kMapAxes> pictures;  // without points if only walls are mapped
  std::vector<WallPicture> walls;
  std::vector<std::string> departures;  // deviations from the prediction's assumptions that concern
                                        // the whole scenario
  double growth_time = kGrowthTime;     // simulated time per growth rate [s]
  int kept = 0;                         // points that were loaded from an earlier run

  bool has_hands() const { return !pictures[0].points.empty(); }
};

struct MapOptions {
  std::filesystem::path folder;  // folder of results and pictures; created if necessary
  StiffnessRange range;
  double growth_time = kGrowthTime;  // [s]
  bool only_walls = false;           // takes seconds instead of minutes
  // Only the caller's thread calls this.
  std::function<void(double share, const std::string& what)> progress = [](double,
                                                                           const std::string&) {};
};

// Computes the points that are not in the folder yet. Each finished point is stored immediately
// under a key of the scenario's content and the program's behaviour. An interrupted map can
// therefore be continued, and no outdated point is reused. Throws InputError.
StabilityMap MakeStabilityMap(const Scenario& scenario, const MapOptions& options);

// Returns reasons why the prediction may be wrong for the whole scenario, as sentences. If there
// are no reasons, the prediction must be correct.
std::vector<std::string> DeparturesOf(const Scenario& scenario);

// Returns reasons why the prediction may be wrong for a found boundary, as text. If there are no
// reasons, the prediction must be correct. The reasons are derived only from the simulations near
// the boundary, never from the difference between prediction and simulation. The possible reasons
// are limits that act on the stable side, limits that noise alone reaches on the other side, and a
// growth rate that depends too weakly on the stiffness.
std::vector<std::string> DeparturesAt(const FoundExtent& found, const Boundary& boundary);
// Returns the reasons why the prediction may be wrong if no stable stiffness was found.
std::vector<std::string> DeparturesEverywhere(const FoundExtent& found);
// Returns the relative uncertainty of a found boundary (two standard errors), derived from the
// deviations of the nearby growth rates from a straight line. Returns no value if there are fewer
// than three growth rates.
std::optional<double> UncertaintyOf(const FoundExtent& found, const Boundary& boundary);

// A boundary that was predicted, found, or both.
struct BoundaryPair {
  bool critical = true;  // concerns the stiffest hand; otherwise the softest
  const Boundary* predicted = nullptr;
  const Boundary* found = nullptr;
  std::vector<std::string> departures;  // deviations at the found boundary

  double ratio() const { return found->stiffness / predicted->stiffness; }
  bool agrees() const { return predicted && found && std::abs(ratio() - 1) <= kAgreement; }
};
std::vector<BoundaryPair> PairsOf(const MapPoint& point);

// The agreement of prediction and simulation over all boundaries of a map. Each boundary counts
// only once, although the scenario's own values are in every picture.
struct MapAgreement {
  int held = 0, held_agree = 0;    // boundaries for which the assumptions hold
  int other = 0, other_agree = 0;  // boundaries for which they do not hold
  int one_sided = 0;               // only predicted or only found
  double worst_ratio = 1;          // among `held`
};
MapAgreement AgreementOf(const StabilityMap& map);

// These functions return one plot, the page with all plots (a single HTML file), and a few lines
// for the terminal.
Plot MapPlot(const StabilityMap& map, const MapPicture& picture);
std::string MapPage(const StabilityMap& map);
std::string MapText(const StabilityMap& map);

// Writes index.html into the folder. Throws InputError.
void WriteStabilityMap(const StabilityMap& map, const std::filesystem::path& folder);

}  // namespace predictor
