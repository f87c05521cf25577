// Draws one plot of a stability map.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "analysis/stability_map/stability_map.h"

namespace predictor {
namespace {

constexpr int kPredictedColor = 0, kFoundColor = 1, kOwnColor = 7;  // indices into kPlotColors
constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

// The points of a series that is being built. The series is a line, a set of markers or, with
// `base`, an area.
struct Curve {
  std::vector<double> x, y, base;

  void Add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
  void AddEdges(double at, double low, double high) {
    Add(at, high);
    base.push_back(low);
  }
  void Break() {
    if (!base.empty()) base.push_back(kGap);
    Add(x.empty() ? 0 : x.back(), kGap);
  }
};

class MapDrawing {
 public:
  MapDrawing(const StabilityMap& map, const MapPicture& picture)
      : map_(map), picture_(picture), text_(TextOf(picture.axis)) {
    const double low = At(picture.points.front()), high = At(picture.points.back());
    const double margin = 0.04 * (high - low);
    left_ = text_.logarithmic ? low / 1.12 : low - margin;
    right_ = text_.logarithmic ? high * 1.12 : high + margin;
  }

  Plot Make() {
    Areas();
    Lines();
    Markers();
    Own();
    Plot plot;
    plot.id = text_.file;
    plot.title =
        std::string("Largest stable hand stiffness as a function of the ") + text_.quantity;
    plot.x = {.label = text_.quantity, .unit = text_.unit, .log = text_.logarithmic};
    plot.x.low = left_;
    plot.x.high = right_;
    panel_.y = {.label = "Largest stiffness of the hand", .unit = "N/m", .log = true};
    panel_.y.low = map_.range.softest;
    panel_.y.high = map_.range.stiffest;
    panel_.height = 2;
    plot.panels.push_back(std::move(panel_));
    return plot;
  }

 private:
  double At(const MapPoint& point) const { return text_.per_si * point.value; }

  // A series without points is not added, so it does not appear in the legend.
  void Put(PlotSeries series, Curve curve) {
    if (curve.x.empty()) return;
    series.SetPoints(std::move(curve.x), std::move(curve.y));
    if (!curve.base.empty()) series.base = MakeSamples(std::move(curve.base));
    panel_.series.push_back(std::move(series));
  }

  static const Boundary* CriticalOf(const MapPoint& p) {
    return p.impossible.empty() ? p.predicted.critical() : nullptr;
  }
  static const Boundary* LowestOf(const MapPoint& p) {
    return p.impossible.empty() ? p.predicted.least() : nullptr;
  }

  // Draws the area in which the loop is predicted to be unstable, and the band in which a found
  // boundary agrees with the prediction. The area and the band connect neighbouring points if both
  // points have a boundary. Otherwise, each point covers half of the distance to its neighbour.
  void Areas() {
    const auto& points = picture_.points;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const double x1 = At(points[k]), x2 = At(points[k + 1]);
      const double middle = text_.logarithmic ? std::sqrt(x1 * x2) : (x1 + x2) / 2;
      const Boundary *a = CriticalOf(points[k]), *b = CriticalOf(points[k + 1]);
      if (a && b) {
        Strip(x1, a->stiffness, Top(), x2, b->stiffness, Top(), &unstable_);
        Strip(x1, (1 - kAgreement) * a->stiffness, (1 + kAgreement) * a->stiffness, x2,
              (1 - kAgreement) * b->stiffness, (1 + kAgreement) * b->stiffness, &band_);
      } else {
        HalfArea(points[k], x1, middle);
        HalfArea(points[k + 1], middle, x2);
      }
      const Boundary *c = LowestOf(points[k]), *d = LowestOf(points[k + 1]);
      if (c && d) Strip(x1, Bottom(), c->stiffness, x2, Bottom(), d->stiffness, &unstable_);
    }
    HalfArea(points.front(), left_, At(points.front()));
    HalfArea(points.back(), At(points.back()), right_);
    const auto area = [](const char* label, int color) {
      return PlotSeries{.label = label, .kind = SeriesKind::kArea, .color = color};
    };
    Put(area("predicted: unstable", kFoundColor), std::move(unstable_));
    Put(area("within 20 % of it", kPredictedColor), std::move(band_));
    Put(area("impossible variant (see the table)", kOwnColor), std::move(nowhere_));
  }
  double Bottom() const { return map_.range.softest; }
  double Top() const { return map_.range.stiffest; }
  void Strip(double x1, double low1, double high1, double x2, double low2, double high2,
             Curve* area) const {
    area->AddEdges(x1, std::max(low1, Bottom()), std::min(high1, Top()));
    area->AddEdges(x2, std::max(low2, Bottom()), std::min(high2, Top()));
    area->Break();
  }
  void HalfArea(const MapPoint& point, double x1, double x2) {
    const Boundary* b = CriticalOf(point);
    if (!point.impossible.empty())
      Strip(x1, Bottom(), Top(), x2, Bottom(), Top(), &nowhere_);
    else if (point.predicted.nothing_stable())
      Strip(x1, Bottom(), Top(), x2, Bottom(), Top(), &unstable_);
    else if (b)
      Strip(x1, b->stiffness, Top(), x2, b->stiffness, Top(), &unstable_);
  }

  void Lines() {
    Curve stiffest, softest;
    for (const MapPoint& point : picture_.points) {
      const Boundary *critical = CriticalOf(point), *least = LowestOf(point);
      stiffest.Add(At(point), critical ? critical->stiffness : kGap);
      softest.Add(At(point), least ? least->stiffness : kGap);
    }
    PlotSeries line{.label = "predicted: stiffest stable hand", .color = kPredictedColor};
    Put(line, std::move(stiffest));
    line.label = "predicted: softest stable hand";
    line.style = LineStyle::kDashed;
    const auto known = [](double y) { return std::isfinite(y); };
    if (std::any_of(softest.y.begin(), softest.y.end(), known)) Put(line, std::move(softest));
  }

  void Markers() {
    std::array<Curve, 4> found;  // by kind of boundary: critical or least, and held or limited
    Curve nothing, everything;
    const double edge = std::pow(Top() / Bottom(), 0.025);
    for (const MapPoint& point : picture_.points) {
      if (!point.simulated || !point.impossible.empty()) continue;
      if (point.found.extent.nothing_stable()) nothing.Add(At(point), Bottom() * edge);
      if (point.found.extent.everything_stable()) everything.Add(At(point), Top() / edge);
      for (const BoundaryPair& pair : PairsOf(point)) {
        if (!pair.found) continue;
        const bool limited = !pair.departures.empty() || !map_.departures.empty();
        found[(pair.critical ? 0U : 1U) + (limited ? 2U : 0U)].Add(At(point),
                                                                   pair.found->stiffness);
      }
    }
    const auto markers = [this](const char* label, PlotSymbol symbol, Curve curve) {
      Put({.label = label, .kind = SeriesKind::kMarkers, .color = kFoundColor, .symbol = symbol},
          std::move(curve));
    };
    markers("simulated, assumptions hold", PlotSymbol::kDot, std::move(found[0]));
    markers("the same, softest hand", PlotSymbol::kDiamond, std::move(found[1]));
    markers("simulated, a limit interferes", PlotSymbol::kRing, std::move(found[2]));
    markers("a limit interferes, softest hand", PlotSymbol::kHollowDiamond, std::move(found[3]));
    markers("simulated: nothing is stable", PlotSymbol::kCross, std::move(nothing));
    markers("simulated: all stable up to here", PlotSymbol::kTriangle, std::move(everything));
  }

  // Marks the unchanged scenario with two lines: one line at the scenario's value on the axis, and
  // one line at the stiffness of the scenario's hand.
  void Own() {
    Curve own;
    const double x = text_.per_si * OwnValue(map_.base, picture_.axis);
    own.Add(x, Bottom());
    own.Add(x, Top());
    own.Break();
    const double stiffness = map_.base.scenario.operator_.hand.stiffness.maxCoeff();
    if (stiffness >= Bottom() && stiffness <= Top()) {
      own.Add(left_, stiffness);
      own.Add(right_, stiffness);
    }
    Put({.label = "the scenario as it is",
         .kind = SeriesKind::kPath,
         .color = kOwnColor,
         .style = LineStyle::kDashed},
        std::move(own));
  }

  const StabilityMap& map_;
  const MapPicture& picture_;
  const MapAxisText& text_;
  double left_ = 0, right_ = 1;  // displayed ends of x
  Curve unstable_, band_, nowhere_;
  PlotPanel panel_;
};

}  // namespace

Plot MapPlot(const StabilityMap& map, const MapPicture& picture) {
  return MapDrawing(map, picture).Make();
}

}  // namespace predictor
