// Describes a plot by its curves, units and limits. The file page.h writes the description into a
// page, and the page's script (web/report) draws the plot.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace predictor {

// Numbers that several series may share, for example the times of a run.
using Samples = std::shared_ptr<const std::vector<double>>;
inline Samples MakeSamples(std::vector<double> values) {
  return std::make_shared<const std::vector<double>>(std::move(values));
}

enum class SeriesKind {
  kLine,     // through the points, with ascending x; interrupted where y is not finite
  kPath,     // through the points, in the order given
  kMarkers,  // points only
  kArea,     // between y and `base`, with ascending x; interrupted where a value is not finite
  kBars,     // from zero (or the lower end of a logarithmic axis) to y
};
enum class LineStyle { kSolid, kDashed, kDotted };
// Shape of a marker.
enum class PlotSymbol {
  kDot,
  kRing,
  kDiamond,
  kHollowDiamond,
  kTriangle,
  kSquare,
  kCross,
  kPlus,
};

inline constexpr int kPlotColors = 8;  // distinguishable by colour-blind people

struct PlotSeries {
  std::string label;
  SeriesKind kind = SeriesKind::kLine;
  int color = 0;  // index into the kPlotColors colours; starts again after the last one
  LineStyle style = LineStyle::kSolid;
  Samples x, y;  // of the same length; in the axes' units
  PlotSymbol symbol = PlotSymbol::kDot;
  Samples base;   // lower edge of an area
  Samples error;  // of markers: half the length of the error bars; null: none
  // All samples of some parts of a line. The page draws these samples when the reader zooms in.
  Samples x_detail, y_detail;
  double resolution = 0;   // step to which the page rounds y; 0: 1/50000 of the range
  double bar_width = 0.8;  // of kBars, in x's unit; for a logarithmic axis, a ratio above 1

  void SetPoints(std::vector<double> at, std::vector<double> values) {
    x = MakeSamples(std::move(at));
    y = MakeSamples(std::move(values));
  }
};

// A permitted value, which is drawn as a line across the panel.
struct PlotLimit {
  double value = 0;
  std::string label;
};

// A shaded range of x.
struct PlotSpan {
  double from = 0, to = 0;
  std::string label;
};

// A labelled position on x, drawn as a line across all panels.
struct PlotNote {
  double x = 0;
  std::string label;
};

struct PlotAxis {
  std::string label, unit;          // "Force", "N"; an empty unit means a plain number
  std::optional<double> low, high;  // if empty, the range of the data
  bool zero = false;                // include zero in the range
  bool log = false;                 // logarithmic: values that are not positive are not drawn
  double least = 0;                 // smallest range, so that noise does not fill the panel
  // The labels of the values `first`, `first` + 1, ..., which appear instead of numbers.
  std::vector<std::string> names;
  double first = 0;
};

struct PlotPanel {
  std::string title;
  PlotAxis y;
  std::vector<PlotSeries> series;
  std::vector<PlotLimit> limits;
  double height = 1;  // relative to other panels
};

// The panels are stacked vertically and share an x-axis.
struct Plot {
  std::string id;     // of the figure and of the file to which it is saved: letters, digits, '-'
  std::string title;  // description of the content
  std::string caption;
  PlotAxis x;
  std::vector<PlotPanel> panels;
  std::vector<PlotSpan> spans;
  std::vector<PlotNote> notes;
  bool equal_axes = false;  // x and y have the same scale; one panel only
  std::string group;        // plots of the same group zoom together; empty: independent
};

// Returns a label such as "Force [N]".
std::string AxisTitle(const PlotAxis& axis);

// Formats `x` with `digits` significant digits and at most `decimals` digits after the decimal
// point, without an exponent ("0.0123", "12.3").
std::string Significant(double x, int digits = 3, int decimals = 6);
// Formats `x` without trailing zeros, for values chosen by people ("30", "0.3").
std::string Round(double x, int digits = 4);

}  // namespace predictor
