// A plot as a description: what is drawn, in which units, within which limits. svg.h draws it as a
// file, page.h in a page where one can zoom; neither knows what the numbers are about.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace predictor {

// Numbers that several series may share, as the times of a run.
using Samples = std::shared_ptr<const std::vector<double>>;
inline Samples MakeSamples(std::vector<double> values) {
  return std::make_shared<const std::vector<double>>(std::move(values));
}

enum class SeriesKind {
  kLine,     // through the points, x ascending; a y that is not finite breaks it
  kPath,     // through the points, x as it comes: for plots with equal axes
  kMarkers,  // the points alone
  kBars,     // from zero (of a logarithmic axis: from its lower end) to y
};
enum class LineStyle { kSolid, kDashed, kDotted };

inline constexpr int kPlotColors = 8;  // told apart by the colour-blind as well

struct PlotSeries {
  std::string label;
  SeriesKind kind = SeriesKind::kLine;
  int color = 0;  // of kPlotColors, beyond them again from the first
  LineStyle style = LineStyle::kSolid;
  Samples x, y;   // as many; in the axes' units
  Samples error;  // markers and bars: half the length of each error bar; null: none
  // Of a line: every sample of parts of it. The page draws them where its view is narrow.
  Samples x_detail, y_detail;
  double resolution = 0;   // to which the page rounds y; 0: a 50000th of the range
  double bar_width = 0.8;  // of kBars, in x's unit; on a logarithmic axis a ratio above 1
};

// A value that is allowed, across the panel.
struct PlotLimit {
  double value = 0;
  std::string label;
};

// A part of x, shaded.
struct PlotSpan {
  double from = 0, to = 0;
  std::string label;
};

// A place on x with words: a line across all panels.
struct PlotNote {
  double x = 0;
  std::string label;
};

// A place in a panel with words.
struct PlotMark {
  double x = 0, y = 0;
  std::string label;
};

struct PlotAxis {
  std::string label, unit;              // "Force", "N"; no unit: a number
  std::optional<double> low, high;      // else what the data need, rounded up to a tick
  bool zero = false;                    // the axis shows zero
  bool log = false;                     // logarithmic: what is not positive is not drawn
  double least = 0;                     // smallest range, so that noise does not fill the panel
  std::vector<std::string> categories;  // names of x = 0, 1, ...: instead of numbers
};

struct PlotPanel {
  std::string title;
  PlotAxis y;
  std::vector<PlotSeries> series;
  std::vector<PlotLimit> limits;
  std::vector<PlotMark> marks;
  double height = 1;  // relative to other panels
};

// Panels one above another with one x-axis.
struct Plot {
  std::string id;     // of the figure and of its file: letters, digits, '-'
  std::string title;  // what it shows
  std::string caption;
  PlotAxis x;
  std::vector<PlotPanel> panels;
  std::vector<PlotSpan> spans;
  std::vector<PlotNote> notes;
  bool equal_axes = false;  // a metre is as long in x as in y; one panel
  std::string group;        // plots of the same group are zoomed together; empty: alone
};

// Of one axis: its ends and where numbers stand.
struct AxisTicks {
  double low = 0, high = 1;
  std::vector<double> at;
  std::vector<std::string> text;
};

// Round numbers, about `count` of them, whose range covers [low, high]; `exact`: the range is kept.
AxisTicks LinearTicks(double low, double high, int count, bool exact = false);
// Powers of ten, with 2 and 5 between where there is room.
AxisTicks LogTicks(double low, double high, int count);

// The range that a panel's data, and the limits near to them, take: of y, finite, low < high.
struct PlotRange {
  double low = 0, high = 1;
};
PlotRange RangeOfX(const Plot& plot);
PlotRange RangeOfY(const PlotPanel& panel, const PlotRange& x);
// Whether a limit lies in the panel's range: far ones are told in words instead.
bool Shown(const PlotLimit& limit, const PlotRange& y);

// "Force [N]".
std::string AxisTitle(const PlotAxis& axis);

// `x` with `digits` significant digits and at most `decimals` behind the point, without exponent
// ("0.0123", "12.3").
std::string Significant(double x, int digits = 3, int decimals = 6);
// The same without zeros at the end, for what was chosen by people ("30", "0.3").
std::string Round(double x, int digits = 4);

}  // namespace predictor
