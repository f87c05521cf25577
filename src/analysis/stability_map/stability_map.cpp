#include "analysis/stability_map/stability_map.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <system_error>

#include "analysis/check/check.h"
#include "analysis/json_line_store.h"
#include "analysis/parallel.h"
#include "analysis/stability_map/point_json.h"
#include "analysis/stability_map/wall_map.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "scenario/located.h"
#include "scenario/scenario_io.h"
#include "simulation/world.h"

namespace predictor {
namespace {

constexpr const char* kFormat =
    "stability map 1";  // format of the stored points; changing it invalidates them
constexpr const char* kStoreFile = "points.jsonl";
constexpr const char* kPageFile = "index.html";
constexpr double kSimulatedWork = 12;   // work for a simulated point relative to a point that is
                                        // only predicted
constexpr double kNearBoundary = 0.3;   // samples within this range show how growth depends on
                                        // ln(stiffness)
constexpr double kFingerprintTime = 1;  // [s]

std::string Exactly(double x) { return Formatted("%a ", x); }

// Returns a hash that identifies the behaviour of this program for a scenario. The hash covers the
// exact bits of one simulated second with a tap, and of the predicted growth. Programs or models
// whose behaviour differs must not share points.
std::string FingerprintOf(const MapBase& base) {
  std::string text = kFormat;
  const Scenario hold = HoldScenario(base.scenario, base.lead, true);
  Emulator emulator(hold);
  Simulate(&emulator, kFingerprintTime, [](const TickRecord&) {});
  const TickRecord& record = emulator.record();
  for (const HandRecord& hand : record.hands)
    if (hand.present)
      for (const double x : hand.real.twist) text += Exactly(x);
  for (const double x : record.object.pose.p) text += Exactly(x);
  const World world(hold);
  const HapticLoop loop(world.Linearise(), hold, 1 / hold.rate, LoopModel::kExact);
  text += Exactly(loop.GrowthRate(hold.operator_.hand, base.lead, 1));
  return HexHash(text);
}

// The points of all pictures as a list of jobs.
class Work {
 public:
  Work(StabilityMap* map, const MapOptions& options)
      : map_(*map),
        options_(options),
        fingerprint_(FingerprintOf(map->base)),
        store_(options.folder / kStoreFile) {
    MapPoint* own = nullptr;  // the unchanged scenario: shown in every picture but computed only
                              // once
    for (MapPicture& picture : map->pictures)
      for (MapPoint& point : picture.points) {
        const bool is_own = IsOwn(map->base, picture.axis, point.value);
        if (is_own && own) {
          copies_.push_back({own, &point});
          continue;
        }
        if (is_own) own = &point;
        items_.push_back({&point, picture.axis});
      }
    for (WallPicture& picture : map->walls)
      for (WallLine& line : picture.lines)
        for (MapPoint& point : line.points)
          items_.push_back({&point, MapAxis::kHandMass, &picture.at, &line});
    // Long jobs come first, so that no core is still busy with a long job at the end.
    std::stable_sort(items_.begin(), items_.end(), [](const Item& a, const Item& b) {
      return a.point->simulated > b.point->simulated;
    });
    for (const Item& item : items_) total_ += WorkOf(*item.point);
  }

  void Do() {
    DoInParallel(
        items_.size(), 0, [this](std::size_t i) { DoOne(items_[i]); },
        [this] { options_.progress(static_cast<double>(done_) / total_, "stability map"); });
    for (const auto& [from, to] : copies_) {
      const double value = to->value;
      *to = *from;
      to->value = value;
    }
    map_.kept = kept_;
  }

 private:
  struct Item {
    MapPoint* point;
    MapAxis axis;                       // of its value
    const ContactWall* wall = nullptr;  // for a point about a wall
    const WallLine* line = nullptr;     // likewise
  };

  static int WorkOf(const MapPoint& point) { return point.simulated ? int(kSimulatedWork) : 1; }

  void DoOne(const Item& item) {
    std::optional<std::string> key;
    try {
      key = Compute(item);
    } catch (const InputError& error) {  // every other error is a problem of the program, not of
                                         // the point
      item.point->impossible = error.what();
    }
    if (key) store_.Add(*key, JsonOf(*item.point));
    done_ += WorkOf(*item.point);
  }

  // Returns the key under which a new point must be stored, or no value if the point is already
  // stored.
  std::optional<std::string> Compute(const Item& item) {
    MapPoint& point = *item.point;
    const Variant variant = item.wall ? WallVariantOf(map_.base, *item.line, point.value)
                                      : VariantOf(map_.base, item.axis, point.value);
    const std::string key =
        item.wall ? KeyOf(variant, item.wall->Varying()) : KeyOf(variant, point.simulated);
    const double value = point.value;
    if (const auto* stored = store_.Find(key); stored && ReadPoint(*stored, &point)) {
      point.value = value;
      ++kept_;
      return {};
    }
    if (item.wall)
      point.predicted = PredictWall(map_.base, variant, *item.wall);
    else
      Predict(variant, &point);
    if (point.simulated) Find(variant, &point);
    return key;
  }

  std::string KeyOf(const Variant& variant, bool simulated) const {
    return HexHash(fingerprint_ + SaveScenario(variant.scenario) + Exactly(variant.lead) +
                   Exactly(map_.range.softest) + Exactly(map_.range.stiffest) +
                   Exactly(simulated ? map_.growth_time : 0));
  }

  std::string KeyOf(const Variant& variant, const Wall& wall) const {
    std::string text = fingerprint_ + "wall" + SaveScenario(variant.scenario);
    for (const double x :
         {variant.lead, static_cast<double>(wall.hand), wall.p_DC.x(), wall.p_DC.y(), wall.p_DC.z(),
          wall.normal.x(), wall.normal.y(), wall.normal.z(), wall.damping, kStiffestWall})
      text += Exactly(x);
    return HexHash(text);
  }

  void Predict(const Variant& variant, MapPoint* point) const {
    const Scenario& s = variant.scenario;
    const World world(s);
    const HapticLoop loop(world.Linearise(), s, 1 / s.rate, LoopModel::kExact);
    point->predicted = PredictExtent(loop, s.operator_.hand, variant.lead, map_.range);
  }

  void Find(const Variant& variant, MapPoint* point) const {
    std::vector<double> hints;
    for (const Boundary& b : point->predicted.boundaries) hints.push_back(b.stiffness);
    point->found = FindExtent(hints, map_.range, [&](double stiffness) {
      Scenario s = variant.scenario;
      s.operator_.hand = Varied(s.operator_.hand, s.operator_.hand.mass, stiffness);
      return MeasureGrowth(s, variant.lead, map_.growth_time);
    });
  }

  StabilityMap& map_;
  const MapOptions& options_;
  std::string fingerprint_;
  JsonLineStore store_;
  std::vector<Item> items_;
  std::vector<std::pair<const MapPoint*, MapPoint*>> copies_;  // source, destination
  int total_ = 0;
  std::atomic<int> done_ = 0, kept_ = 0;
};

// Returns the simulated values, and predicted values between the simulated values.
std::vector<MapPoint> PointsOf(const MapBase& base, MapAxis axis) {
  std::vector<MapPoint> points;
  for (const double value : MapValues(base, axis)) {
    if (!points.empty()) {
      const double before = points.back().value;
      MapPoint between;
      between.value = TextOf(axis).logarithmic ? std::sqrt(before * value) : (before + value) / 2;
      points.push_back(between);
    }
    MapPoint point;
    point.value = value;
    point.simulated = true;
    points.push_back(point);
  }
  return points;
}

}  // namespace

// Returns effects that the linearised loop does not model at all.
std::vector<std::string> DeparturesOf(const Scenario& s) {
  std::vector<std::string> departures;
  const auto& coulomb = s.cobot.joint_friction.coulomb;
  if (std::any_of(coulomb.begin(), coulomb.end(), [](double x) { return x > 0; }))
    departures.emplace_back(
        "The cobot's joints have Coulomb friction (cobot.joint_friction.coulomb). This friction "
        "damps small motions, but the linear loop does not include this friction.");
  if (s.rig.loop || s.rig.computation_delay > 0)
    departures.emplace_back(
        "The simulated arms differ from the assumed ones (rig.loop, rig.computation_delay). The "
        "prediction uses the assumed values.");
  const YamlNode* trajectory = s.cobot.controller.parameters.Find("trajectory");
  if (trajectory && !trajectory->items.empty())
    departures.emplace_back(
        "The cobot's set-point moves (cobot.controller.trajectory). Prediction and simulation "
        "apply to the start of the trajectory.");
  if (s.rate < kMinMapRate)
    departures.push_back(
        Formatted("The loop runs at %.3g Hz (rate). Below %.0f Hz, the time steps of the loop "
                  "lower the boundary, but the prediction assumes a continuous loop.",
                  s.rate, kMinMapRate));
  for (const int i : s.hands()) {
    const double slowest = std::min(s.arm(i).sample_rate, s.arm(i).sensor.sample_rate);
    if (slowest >= kMinMapRate) continue;
    departures.push_back(
        Formatted("The sensor sends readings at only %.3g Hz (sample_rate). The prediction and the "
                  "simulation assume that newer readings are available.",
                  slowest));
    break;
  }
  return departures;
}

std::optional<double> UncertaintyOf(const FoundExtent& found, const Boundary& boundary) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (const GrowthAt& sample : found.samples) {
    const double at = std::log(sample.stiffness / boundary.stiffness);
    if (std::abs(at) > kNearBoundary || !sample.growth.rate) continue;
    const double rate = *sample.growth.rate;
    n += 1, x += at, y += rate, xx += at * at, xy += at * rate, yy += rate * rate;
  }
  const double spread = n * xx - x * x;
  if (n < 3 || spread <= 0) return {};
  const double slope = (n * xy - x * y) / spread;
  const double variance = std::max(0.0, (n * yy - y * y - slope * slope * spread) / (n * (n - 2)));
  return 2 * std::sqrt(variance / n) / std::abs(slope);
}

namespace {

// Returns the sample that is closest to a boundary, either on the side where the oscillation grows
// or on the other side.
const Growth* NearestTo(const FoundExtent& found, const Boundary& boundary, bool grows) {
  const GrowthAt* nearest = nullptr;
  const auto far = [&](const GrowthAt& g) {
    return std::abs(std::log(g.stiffness / boundary.stiffness));
  };
  for (const GrowthAt& sample : found.samples) {
    const bool is_below = sample.stiffness < boundary.stiffness;
    if (sample.growth.grows != grows || is_below != (boundary.stable_below != grows)) continue;
    if (!nearest || far(sample) < far(*nearest)) nearest = &sample;
  }
  return nearest ? &nearest->growth : nullptr;
}

// Returns the limit that acts in the most ticks.
const char* WorstLimit(const Growth& growth) {
  const auto worst = std::max_element(growth.limited.begin(), growth.limited.end());
  return Name(static_cast<Limiting>(worst - growth.limited.begin()));
}

}  // namespace

std::vector<std::string> DeparturesAt(const FoundExtent& found, const Boundary& boundary) {
  std::vector<std::string> departures;
  if (const Growth* stable = NearestTo(found, boundary, false))
    for (int k = 0; k < kLimitings; ++k) {
      const double share = stable->limited[static_cast<std::size_t>(k)];
      if (share > kLimitedShare)
        departures.push_back(Formatted("on the stable side, %s is active %.0f %% of the time",
                                       Name(static_cast<Limiting>(k)), 100 * share));
    }
  const Growth* unstable = NearestTo(found, boundary, true);
  if (unstable && !unstable->rate)
    departures.push_back(Formatted("noise alone reaches %s before the growth can be measured",
                                   WorstLimit(*unstable)));
  const std::optional<double> uncertainty = UncertaintyOf(found, boundary);
  if (!uncertainty)
    departures.emplace_back(
        "growth was measured too rarely near the boundary to estimate its uncertainty");
  else if (*uncertainty > kMaxUncertainty)
    departures.push_back(
        Formatted("growth depends so little on stiffness here that noise makes the boundary "
                  "uncertain by %.0f %%",
                  100 * *uncertainty));
  return departures;
}

std::vector<std::string> DeparturesEverywhere(const FoundExtent& found) {
  std::vector<std::string> departures;
  for (const GrowthAt& sample : found.samples)
    if (sample.growth.grows && sample.growth.rate) return departures;
  if (!found.extent.nothing_stable()) return departures;
  departures.push_back(Formatted("noise alone reaches %s before the growth can be measured",
                                 WorstLimit(found.samples.front().growth)));
  return departures;
}

std::vector<BoundaryPair> PairsOf(const MapPoint& point) {
  std::vector<BoundaryPair> pairs;
  if (!point.simulated || !point.impossible.empty()) return pairs;
  const StableExtent &a = point.predicted, &b = point.found.extent;
  for (const bool critical : {true, false}) {
    BoundaryPair pair;
    pair.critical = critical;
    pair.predicted = critical ? a.critical() : a.least();
    pair.found = critical ? b.critical() : b.least();
    if (!pair.predicted && !pair.found) continue;
    pair.departures =
        pair.found ? DeparturesAt(point.found, *pair.found) : DeparturesEverywhere(point.found);
    pairs.push_back(pair);
  }
  return pairs;
}

MapAgreement AgreementOf(const StabilityMap& map) {
  MapAgreement agreement;
  bool own_counted = false;
  for (const MapPicture& picture : map.pictures) {
    for (const MapPoint& point : picture.points) {
      const bool is_own = IsOwn(map.base, picture.axis, point.value);
      if (is_own && own_counted) continue;
      for (const BoundaryPair& pair : PairsOf(point)) {
        own_counted |= is_own;
        const bool holds = pair.departures.empty() && map.departures.empty();
        if (!pair.predicted || !pair.found) {
          ++(holds ? agreement.one_sided : agreement.other);
        } else if (holds) {
          ++agreement.held;
          agreement.held_agree += pair.agrees();
          if (std::abs(std::log(pair.ratio())) > std::abs(std::log(agreement.worst_ratio)))
            agreement.worst_ratio = pair.ratio();
        } else {
          ++agreement.other;
          agreement.other_agree += pair.agrees();
        }
      }
    }
  }
  return agreement;
}

StabilityMap MakeStabilityMap(const Scenario& scenario, const MapOptions& options) try {
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (!std::filesystem::is_directory(options.folder, error))
    throw InputError("--map: '" + options.folder.string() +
                     "' is not a folder and could not be created. Give a writable folder.");
  StabilityMap map;
  map.base = BaseOf(scenario);
  map.range = options.range;
  map.growth_time = options.growth_time;
  map.departures = DeparturesOf(scenario);
  for (int k = 0; k < kMapAxes; ++k) {
    MapPicture& picture = map.pictures[static_cast<std::size_t>(k)];
    picture.axis = static_cast<MapAxis>(k);
    if (!options.only_walls) picture.points = PointsOf(map.base, picture.axis);
  }
  map.walls = WallPicturesOf(map.base);
  Work(&map, options).Do();
  return map;
} catch (const InputError& error) {
  throw Located(error, scenario);
}

void WriteStabilityMap(const StabilityMap& map, const std::filesystem::path& folder) {
  WriteWholeFile(folder / kPageFile, MapPage(map));
}

}  // namespace predictor
