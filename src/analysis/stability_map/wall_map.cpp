#include "analysis/stability_map/wall_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/format.h"
#include "core/text.h"
#include "models/object_model.h"

namespace predictor {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::quiet_NaN();
constexpr int kAlone = 7;             // colour of points that belong to no line
constexpr double kKilonewton = 1000;  // the plot and the tables show kN/m

const MapAxisText& Mass() { return TextOf(MapAxis::kHandMass); }
const MapAxisText& Delay() { return TextOf(MapAxis::kDelay); }

std::string DelayText(double delay) {
  return Formatted("%.3g %s", Delay().per_si * delay, Delay().unit);
}

std::string LeadText(double lead) { return Formatted("%.1f ms", 1000 * lead); }

std::string MassText(double mass) { return Formatted("%.3g %s", mass, Mass().unit); }

ContactWall AssumedWall(const MapBase& base) {
  const Scenario& s = base.scenario;
  ContactWall assumed;
  assumed.yields = true;
  assumed.wall.hand = *s.hands().begin();
  assumed.wall.p_DC = base.X_WO.p - base.X_WO * HandlePose(s, assumed.wall.hand).p;
  return assumed;
}

// Returns the lead that a run with this delay uses [s].
double LeadFor(const MapBase& base, double delay) {
  if (IsOwn(base, MapAxis::kDelay, delay)) return base.lead;
  const Scenario s = VariantOf(base, MapAxis::kDelay, delay).scenario;
  return ChooseLead(HapticLoop(base.world, s, 1 / s.rate), s, 1 / s.rate).lead;
}

// Returns the largest stable stiffness [kN/m], or a gap if no stiffness is stable or no limit was
// found.
double Largest(const MapPoint& point) {
  const Boundary* critical = point.predicted.critical();
  return critical ? critical->stiffness / kKilonewton : kNoLimit;
}

std::string LargestText(const MapPoint& point) {
  if (point.predicted.nothing_stable()) return "none";
  if (point.predicted.everything_stable()) return Formatted("> %.0f", kStiffestWall / kKilonewton);
  return Formatted("%.3g", Largest(point));
}

PlotSeries LineOf(const MapBase& base, const WallLine& line, int color) {
  std::vector<double> mass, stiffness;
  for (const MapPoint& point : line.points) {
    mass.push_back(point.value);
    stiffness.push_back(Largest(point));
  }
  const bool is_own = IsOwn(base, MapAxis::kDelay, line.delay);
  PlotSeries series{
      .label = "delay " + DelayText(line.delay) + ", lead " + LeadText(line.lead) +
               (is_own ? " (the scenario)" : ""),
      .color = color,
      .style = is_own ? LineStyle::kSolid : LineStyle::kDashed,
  };
  series.SetPoints(std::move(mass), std::move(stiffness));
  return series;
}

// Collects the points that have no neighbour and are therefore invisible as part of a line. Returns
// whether there are such points.
bool PointsAlone(const WallPicture& picture, PlotSeries* alone) {
  std::vector<double> mass, stiffness;
  for (const WallLine& line : picture.lines)
    for (std::size_t k = 0; k < line.points.size(); ++k) {
      const auto has_limit = [&](std::size_t i) {
        return i < line.points.size() && line.points[i].predicted.critical() != nullptr;
      };
      if (!has_limit(k) || has_limit(k + 1) || (k > 0 && has_limit(k - 1))) continue;
      mass.push_back(line.points[k].value);
      stiffness.push_back(Largest(line.points[k]));
    }
  const bool any = !mass.empty();
  alone->SetPoints(std::move(mass), std::move(stiffness));
  return any;
}

// Sets the range of the axis to the powers of ten around all values.
void SetRange(const WallPicture& picture, PlotAxis* axis) {
  double low = kStiffestWall / kKilonewton, high = kSoftestWall / kKilonewton;
  for (const WallLine& line : picture.lines)
    for (const MapPoint& point : line.points)
      if (const double largest = Largest(point); std::isfinite(largest)) {
        low = std::min(low, largest);
        high = std::max(high, largest);
      }
  axis->low = std::pow(10, std::floor(std::log10(std::min(low, high))));
  axis->high = std::pow(10, std::ceil(std::log10(std::max(low, high))));
}

// Returns a list of the hands whose points meet a condition, for example "at 4 ms: 0.375, 6 kg; at
// 8 ms: 6 kg".
std::string HandsThat(bool (StableExtent::*meet)() const, const WallPicture& picture) {
  std::vector<std::string> lines;
  for (const WallLine& line : picture.lines) {
    std::vector<std::string> masses;
    for (const MapPoint& point : line.points)
      if ((point.predicted.*meet)()) masses.push_back(Formatted("%.3g", point.value));
    if (!masses.empty())
      lines.push_back("at " + DelayText(line.delay) + ": " + Join(masses) + " " + Mass().unit);
  }
  return Join(lines, "; ");
}

// Returns a list of the hands for which there is no limit to draw.
std::string Caption(const WallPicture& picture) {
  const std::string nothing = HandsThat(&StableExtent::nothing_stable, picture);
  const std::string everything = HandsThat(&StableExtent::everything_stable, picture);
  std::string caption;
  if (!nothing.empty())
    caption += "Hands with which the loop oscillates even without a wall: " + nothing + ". ";
  if (!everything.empty())
    caption += Formatted("Hands for which every wall up to %.0f kN/m is stable: ",
                         kStiffestWall / kKilonewton) +
               everything + ". ";
  return caption;
}

using Cells = std::vector<std::string>;

std::string Table(const WallPicture& picture) {
  std::vector<Cells> rows = {{"delay"}, {"lead"}};
  for (const WallLine& line : picture.lines) {
    rows[0].push_back(DelayText(line.delay));
    rows[1].push_back(LeadText(line.lead));
  }
  for (std::size_t k = 0; k < picture.lines.front().points.size(); ++k) {
    rows.push_back({"hand of " + MassText(picture.lines.front().points[k].value)});
    for (const WallLine& line : picture.lines) rows.back().push_back(LargestText(line.points[k]));
  }
  return "<p>Largest stable stiffness [kN/m]:</p>\n" + HtmlTable(rows);
}

}  // namespace

std::vector<WallPicture> WallPicturesOf(const MapBase& base) {
  std::vector<WallLine> lines;
  for (const double delay : MapValues(base, MapAxis::kDelay)) {
    lines.push_back({delay, LeadFor(base, delay), {}});
    for (const double mass : MapValues(base, MapAxis::kHandMass)) {
      lines.back().points.emplace_back();
      lines.back().points.back().value = mass;
    }
  }
  std::vector<ContactWall> walls = WallsOf(base.scenario, base.untouched, base.X_WO, false);
  std::erase_if(
      walls, [](const ContactWall& at) { return at.surfaces[0].kind == Surface::Kind::kMovable; });
  if (walls.empty()) walls.push_back(AssumedWall(base));
  std::vector<WallPicture> pictures;
  for (const ContactWall& at : walls) pictures.push_back({at, lines});
  return pictures;
}

Variant WallVariantOf(const MapBase& base, const WallLine& line, double hand_mass) {
  Variant variant = VariantOf(base, MapAxis::kDelay, line.delay);
  variant.scenario.operator_.hand.mass = hand_mass;
  variant.lead = line.lead;
  return variant;
}

StableExtent PredictWall(const MapBase& base, const Variant& variant, const ContactWall& at) {
  const WallLimit limit =
      StiffestStableWall(base.untouched, variant.scenario, variant.scenario.operator_.hand,
                         variant.lead, at.Varying(), LoopModel::kExact);
  StableExtent extent;
  extent.stable_at_softest = limit.stiffness > 0;
  if (limit.reached && limit.stiffness > 0)
    extent.boundaries = {{limit.stiffness, true, limit.frequency}};
  return extent;
}

std::string WallInWords(const WallPicture& picture) {
  const ContactWall& at = picture.at;
  const Wall wall = at.Varying();
  const std::string place =
      Formatted("normal [%.2f, %.2f, %.2f], ", wall.normal.x(), wall.normal.y(), wall.normal.z());
  const std::string damping =
      wall.damping > 0 ? Formatted("damping %.3g N·s/m", wall.damping) : "no damping";
  if (at.surfaces.empty()) return "assumed wall below the object, " + place + damping;
  return PhraseOf(at.surfaces) + ", " + place + damping;
}

Plot WallPlot(const StabilityMap& map, std::size_t wall) {
  const WallPicture& picture = map.walls[wall];
  Plot plot;
  plot.id = "wall" + (wall == 0 ? "" : std::to_string(wall + 1));
  plot.title = "Largest stable stiffness of a wall: " + WallInWords(picture);
  plot.caption = Caption(picture);
  plot.x = {.label = Mass().quantity, .unit = Mass().unit, .log = true};
  plot.x.low = picture.lines.front().points.front().value / 1.12;
  plot.x.high = picture.lines.front().points.back().value * 1.12;
  PlotPanel panel;
  panel.y = {.label = "Largest stiffness of the wall", .unit = "kN/m", .log = true};
  SetRange(picture, &panel.y);
  panel.height = 2;
  int color = 0;
  for (const WallLine& line : picture.lines) {
    PlotSeries series = LineOf(map.base, line, color++);
    if (std::any_of(series.y->begin(), series.y->end(), [](double y) { return std::isfinite(y); }))
      panel.series.push_back(std::move(series));
  }
  PlotSeries alone{.label = "for one mass only", .kind = SeriesKind::kMarkers, .color = kAlone};
  if (PointsAlone(picture, &alone)) panel.series.push_back(std::move(alone));
  const double requested = picture.at.wall.stiffness / kKilonewton;
  if (picture.at.yields && requested >= *panel.y.low && requested <= *panel.y.high)
    panel.limits.push_back({requested, "the fixture, at one point"});
  plot.panels.push_back(std::move(panel));
  plot.notes.push_back({OwnValue(map.base, MapAxis::kHandMass), "the scenario's hand"});
  return plot;
}

std::string WallText(const StabilityMap& map) {
  std::string text;
  for (const WallPicture& picture : map.walls) {
    AppendLine(&text, "Largest stable wall [kN/m], predicted: %s", WallInWords(picture).c_str());
    Append(&text, "  %-13s", "delay");
    for (const WallLine& line : picture.lines) Append(&text, "%9s", DelayText(line.delay).c_str());
    Append(&text, "\n  %-13s", "lead");
    for (const WallLine& line : picture.lines) Append(&text, "%9s", LeadText(line.lead).c_str());
    text += '\n';
    for (std::size_t k = 0; k < picture.lines.front().points.size(); ++k) {
      Append(&text, "  hand %-8s", MassText(picture.lines.front().points[k].value).c_str());
      for (const WallLine& line : picture.lines)
        Append(&text, "%9s", LargestText(line.points[k]).c_str());
      text += '\n';
    }
  }
  return text;
}

void AddWalls(const StabilityMap& map, ReportPage* page) {
  if (map.walls.empty()) return;
  page->Section("walls", "Largest stable wall");
  page->Html(
      "<p>Stiffness of a wall up to which the haptic loop is stable while the object touches it. "
      "Against a stiffer wall, a disturbance grows: the arms cannot render it. The lines belong to "
      "delays of the arms' velocity loops, from the command to the motion.</p>\n<p>These values "
      "are <b>predicted</b> for small motions that stay in contact, at one point. The lead is the "
      "one that a run with the delay of the line uses. A body without a given stiffness is "
      "replaced by springs without damping. A test compares such predictions with simulations. "
      "<code>predictor check</code> states smaller values, because it adds 1.5 ticks of delay as a "
      "reserve for real devices.</p>\n");
  for (std::size_t k = 0; k < map.walls.size(); ++k) {
    page->Figure(WallPlot(map, k));
    page->Html(Table(map.walls[k]));
  }
}

}  // namespace predictor
