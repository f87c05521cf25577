// One picture of a stability map.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "analysis/stability_map/stability_map.h"
#include "core/format.h"

namespace predictor {
namespace {

// Sizes in user units of the picture.
constexpr double kWidth = 900, kHeight = 470;
constexpr double kLeft = 84, kRight = 610, kTop = 54, kBottom = 400;
constexpr double kLegend = 636, kLine = 24;

// Colours for light and, where that is preferred, for dark. Told apart by shape as well.
constexpr const char* kStyle = R"(<style>
.sm-page{fill:#ffffff}.sm-text{fill:#1d2430;font:14px system-ui,sans-serif}
.sm-small{font-size:13px}.sm-title{font-size:16px;font-weight:600}
.sm-grid{stroke:#d9dee6;fill:none}.sm-frame{stroke:#5b6675;fill:none}
.sm-unstable{fill:#c2452d;fill-opacity:.13}.sm-band{fill:#1f6fb5;fill-opacity:.16}
.sm-predicted{stroke:#1f6fb5;stroke-width:2.5;fill:none}.sm-least{stroke-dasharray:3 5}
.sm-found{fill:#b5540a;stroke:#ffffff;stroke-width:1}
.sm-limited{fill:#ffffff;stroke:#b5540a;stroke-width:2}
.sm-cross{stroke:#b5540a;stroke-width:2.5;fill:none}
.sm-own{stroke:#5b6675;stroke-dasharray:7 4;fill:none}.sm-none{fill:#8a93a1;fill-opacity:.25}
@media(prefers-color-scheme:dark){
.sm-page{fill:#14171c}.sm-text{fill:#e4e8ee}.sm-grid{stroke:#2b323c}.sm-frame{stroke:#98a3b3}
.sm-unstable{fill:#ff7a5c;fill-opacity:.16}.sm-band{fill:#62b0f5;fill-opacity:.2}
.sm-predicted{stroke:#62b0f5}.sm-found{fill:#ffa45c;stroke:#14171c}
.sm-limited{fill:#14171c;stroke:#ffa45c}.sm-cross{stroke:#ffa45c}.sm-own{stroke:#98a3b3}
.sm-none{fill:#98a3b3;fill-opacity:.25}}
</style>
)";

// Maps a value onto a stretch of the picture.
struct Scale {
  double low, high, from, to;
  bool logarithmic;
  double operator()(double x) const {
    const double share =
        logarithmic ? std::log(x / low) / std::log(high / low) : (x - low) / (high - low);
    return from + std::clamp(share, 0.0, 1.0) * (to - from);
  }
};

// Round values within a scale; how many to a tenfold goes by how many tenfolds there are. Equal
// steps of 1, 2 or 5 if it is not logarithmic.
std::vector<double> Ticks(const Scale& scale) {
  std::vector<double> ticks;
  if (scale.logarithmic) {
    const std::vector<double> few = {1, 2, 5}, many = {1, 1.5, 2, 3, 4, 6, 8};
    for (double ten = 1e-3; ten < 1e6; ten *= 10)
      for (const double x : scale.high > 20 * scale.low ? few : many)
        if (x * ten >= scale.low * 0.999 && x * ten <= scale.high * 1.001) ticks.push_back(x * ten);
    return ticks;
  }
  const double about = (scale.high - scale.low) / 6;
  const double ten = std::pow(10, std::floor(std::log10(about)));
  const double step = about < 2 * ten ? 2 * ten : about < 5 * ten ? 5 * ten : 10 * ten;
  for (int k = 0; k * step <= scale.high * 1.001; ++k)
    if (k * step >= scale.low - 1e-9) ticks.push_back(k * step);
  return ticks;
}

class Picture {
 public:
  Picture(const StabilityMap& map, const MapPicture& picture)
      : map_(map),
        picture_(picture),
        text_(TextOf(picture.axis)),
        x_(ScaleOfX(picture)),
        y_{map.range.softest, map.range.stiffest, kBottom, kTop, true} {}

  std::string Draw() {
    Append(&svg_,
           "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" role=\"img\" "
           "aria-label=\"Critical hand stiffness against %s\">\n",
           kWidth, kHeight, text_.quantity);
    svg_ += kStyle;
    Append(&svg_, "<rect class=\"sm-page\" width=\"%.0f\" height=\"%.0f\"/>\n", kWidth, kHeight);
    Grid();
    Areas();
    Own();
    Lines();
    Marks();
    Append(&svg_,
           "<rect class=\"sm-frame\" x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\"/>\n",
           kLeft, kTop, kRight - kLeft, kBottom - kTop);
    Labels();
    Legend();
    return svg_ + "</svg>\n";
  }

 private:
  static Scale ScaleOfX(const MapPicture& picture) {
    const MapAxisText& text = TextOf(picture.axis);
    const double low = text.per_si * picture.points.front().value;
    const double high = text.per_si * picture.points.back().value;
    if (text.logarithmic) return {low / 1.12, high * 1.12, kLeft, kRight, true};
    const double margin = 0.04 * (high - low);
    return {low - margin, high + margin, kLeft, kRight, false};
  }
  double X(const MapPoint& point) const { return x_(text_.per_si * point.value); }
  double Y(double stiffness) const { return y_(stiffness); }

  void Text(double x, double y, const std::string& text, const char* anchor = "start",
            const char* more = "") {
    Append(&svg_, "<text class=\"sm-text %s\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", more, x,
           y, anchor);
    svg_ += text + "</text>\n";
  }
  void Line(const char* kind, double x1, double y1, double x2, double y2) {
    Append(&svg_, "<line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n", kind,
           x1, y1, x2, y2);
  }
  void Box(const char* kind, double x1, double y1, double x2, double y2) {
    Append(&svg_, "<rect class=\"%s\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
           kind, x1, std::min(y1, y2), x2 - x1, std::abs(y2 - y1));
  }
  // A strip between two curves over two points.
  void Strip(const char* kind, double x1, double low1, double high1, double x2, double low2,
             double high2) {
    Append(&svg_, "<polygon class=\"%s\" points=\"%.1f,%.1f %.1f,%.1f %.1f,%.1f %.1f,%.1f\"/>\n",
           kind, x1, low1, x1, high1, x2, high2, x2, low2);
  }

  void Grid() {
    for (const double x : Ticks(x_)) {
      Line("sm-grid", x_(x), kTop, x_(x), kBottom);
      char text[32];
      std::snprintf(text, sizeof text, "%g", x);
      Text(x_(x), kBottom + 20, text, "middle", "sm-small");
    }
    for (const double y : Ticks(y_)) {
      Line("sm-grid", kLeft, y_(y), kRight, y_(y));
      char text[32];
      std::snprintf(text, sizeof text, "%g", y);
      Text(kLeft - 8, y_(y) + 5, text, "end", "sm-small");
    }
  }

  // Where the loop is predicted to be unstable, and the band in which a found boundary agrees. From
  // point to point where both have a boundary; else each point stands for half the way.
  void Areas() {
    const auto& points = picture_.points;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const double x1 = X(points[k]), x2 = X(points[k + 1]), middle = (x1 + x2) / 2;
      const Boundary *a = CriticalOf(points[k]), *b = CriticalOf(points[k + 1]);
      if (a && b) {
        Strip("sm-unstable", x1, Y(a->stiffness), kTop, x2, Y(b->stiffness), kTop);
        Band(x1, a->stiffness, x2, b->stiffness);
      } else {
        HalfArea(points[k], x1, middle);
        HalfArea(points[k + 1], middle, x2);
      }
      const Boundary *c = LeastOf(points[k]), *d = LeastOf(points[k + 1]);
      if (c && d) Strip("sm-unstable", x1, kBottom, Y(c->stiffness), x2, kBottom, Y(d->stiffness));
    }
    if (points.empty()) return;
    HalfArea(points.front(), kLeft, X(points.front()));
    HalfArea(points.back(), X(points.back()), kRight);
  }
  void Band(double x1, double k1, double x2, double k2) {
    Strip("sm-band", x1, Y((1 - kAgreement) * k1), Y((1 + kAgreement) * k1), x2,
          Y((1 - kAgreement) * k2), Y((1 + kAgreement) * k2));
  }
  void HalfArea(const MapPoint& point, double x1, double x2) {
    if (!point.impossible.empty()) {
      Box("sm-none", x1, kTop, x2, kBottom);
      impossible_ = true;
    } else if (point.predicted.nothing_stable()) {
      Box("sm-unstable", x1, kTop, x2, kBottom);
    } else if (const Boundary* b = point.predicted.critical()) {
      Box("sm-unstable", x1, kTop, x2, Y(b->stiffness));
    }
  }
  static const Boundary* CriticalOf(const MapPoint& p) {
    return p.impossible.empty() ? p.predicted.critical() : nullptr;
  }
  static const Boundary* LeastOf(const MapPoint& p) {
    return p.impossible.empty() ? p.predicted.least() : nullptr;
  }

  void Lines() {
    const auto& points = picture_.points;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const double x1 = X(points[k]), x2 = X(points[k + 1]);
      const Boundary *a = CriticalOf(points[k]), *b = CriticalOf(points[k + 1]);
      if (a && b) Line("sm-predicted", x1, Y(a->stiffness), x2, Y(b->stiffness));
      const Boundary *c = LeastOf(points[k]), *d = LeastOf(points[k + 1]);
      if (!c || !d) continue;
      Line("sm-predicted sm-least", x1, Y(c->stiffness), x2, Y(d->stiffness));
      least_ = true;
    }
  }

  // The scenario as it is.
  void Own() {
    const double x = x_(text_.per_si * OwnValue(map_.base, picture_.axis));
    Line("sm-own", x, kTop, x, kBottom);
    const double own = map_.base.scenario.operator_.hand.stiffness.maxCoeff();
    if (own >= map_.range.softest && own <= map_.range.stiffest)
      Line("sm-own", kLeft, Y(own), kRight, Y(own));
  }

  void Marks() {
    for (const MapPoint& point : picture_.points) {
      if (!point.simulated || !point.impossible.empty()) continue;
      const double x = X(point);
      if (point.found.extent.nothing_stable()) Cross(x, kBottom - 9);
      if (point.found.extent.everything_stable()) Triangle(x, kTop + 9);
      for (const BoundaryPair& pair : PairsOf(point)) {
        if (!pair.found) continue;
        const bool limited = !pair.departures.empty() || !map_.departures.empty();
        Dot(x, Y(pair.found->stiffness), pair.critical, limited);
      }
    }
  }
  void Dot(double x, double y, bool critical, bool limited) {
    const char* kind = limited ? "sm-limited" : "sm-found";
    if (critical)
      Append(&svg_, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"5.5\"/>\n", kind, x, y);
    else
      Append(&svg_, "<path class=\"%s\" d=\"M%.1f %.1fl6 6l-6 6l-6 -6z\"/>\n", kind, x, y - 6);
  }
  void Cross(double x, double y) {
    Append(&svg_, "<path class=\"sm-cross\" d=\"M%.1f %.1fl10 10m0 -10l-10 10\"/>\n", x - 5, y - 5);
  }
  void Triangle(double x, double y) {
    Append(&svg_, "<path class=\"sm-found\" d=\"M%.1f %.1fl6 11h-12z\"/>\n", x, y - 6);
  }

  void Labels() {
    Text(kLeft, 24, std::string("How stiff a hand may be, against the ") + text_.quantity, "start",
         "sm-title");
    Text((kLeft + kRight) / 2, kBottom + 48, std::string(text_.quantity) + " [" + text_.unit + "]",
         "middle");
    Append(&svg_,
           "<text class=\"sm-text\" transform=\"translate(24 %.0f) rotate(-90)\" "
           "text-anchor=\"middle\">largest stiffness of the hand [N/m]</text>\n",
           (kTop + kBottom) / 2);
  }

  // Legend, a line a kind.
  void Legend() {
    double y = kTop + 12;
    const auto entry = [&](const std::string& text) {
      Text(kLegend + 34, y + 5, text, "start", "sm-small");
      y += kLine;
    };
    const double middle = kLegend + 13;
    Line("sm-predicted", kLegend, y, kLegend + 26, y);
    entry("predicted: stiffest stable hand");
    if (least_) {
      Line("sm-predicted sm-least", kLegend, y, kLegend + 26, y);
      entry("predicted: softest stable hand");
    }
    Box("sm-band", kLegend, y - 7, kLegend + 26, y + 7);
    entry("within 20 % of it");
    Box("sm-unstable", kLegend, y - 7, kLegend + 26, y + 7);
    entry("predicted: unstable");
    Dot(middle, y, true, false);
    entry("simulated, assumptions hold");
    Dot(middle, y, true, true);
    entry("simulated, a limit interferes");
    Cross(middle, y);
    entry("simulated: nothing is stable");
    Triangle(middle, y);
    entry("simulated: all stable up to here");
    if (impossible_) {
      Box("sm-none", kLegend, y - 7, kLegend + 26, y + 7);
      entry("no such world (see the table)");
    }
    Line("sm-own", kLegend, y, kLegend + 26, y);
    entry("the scenario as it is");
  }

  const StabilityMap& map_;
  const MapPicture& picture_;
  const MapAxisText& text_;
  Scale x_, y_;
  std::string svg_;
  bool least_ = false, impossible_ = false;  // something of this kind was drawn
};

}  // namespace

std::string MapSvg(const StabilityMap& map, const MapPicture& picture) {
  return Picture(map, picture).Draw();
}

}  // namespace predictor
