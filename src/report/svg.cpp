#include "report/svg.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/text.h"

namespace predictor {
namespace {

// Okabe and Ito's colours, the light ones darkened to be seen on white.
constexpr std::array<const char*, kPlotColors> kColors = {
    "#0072b2", "#d55e00", "#008a65", "#b0569a", "#a87900", "#3a9bd1", "#6b4c9a", "#555555"};
constexpr std::array<const char*, 3> kDashes = {"", "6 3", "2 2.5"};

// [px]
constexpr double kLeft = 62, kRight = 14, kFont = 12, kRow = 16, kBottom = 40, kBetween = 14;
constexpr double kCharacter = 6.3;  // mean width of one at this size, rather too much
constexpr double kPadding = 0.04;   // of a path, left and right
constexpr double kKey = 22;         // of a legend's sample of line
constexpr double kGap = 10;         // between two entries of it

double WidthOf(const std::string& text) {
  const auto letters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  });
  return kCharacter * static_cast<double>(letters);
}

// `words`, or as much of them as takes no more than so wide.
std::string Fitting(const std::string& words, double width) {
  if (WidthOf(words) <= width) return words;
  std::string fitting = words;
  while (!fitting.empty() && WidthOf(fitting + "…") > width) {
    while ((static_cast<unsigned char>(fitting.back()) & 0xC0) == 0x80) fitting.pop_back();
    fitting.pop_back();
  }
  return fitting + "…";
}

struct LegendEntry {
  const PlotSeries* series;  // null: a limit
  std::string words;
  double x;
  int row;
  double Width() const { return (series ? kKey + 4 : 0) + WidthOf(words) + kGap; }
};

struct Legend {
  std::vector<LegendEntry> entries;
  int rows = 1;  // with that of the title
};

struct Box {
  double left, top, width, height;
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

// A value's place between two ends [px].
struct Scale {
  double low, high, from, to;
  bool log;
  double operator()(double value) const {
    const double share =
        log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return from + share * (to - from);
  }
};

// Where the words of the line at `py` stand: above or below it, within the box, where no other line
// runs through them and no others stand; where there is no such place, above.
double HeightOfWords(double py, const std::vector<double>& lines, const std::vector<double>& words,
                     const Box& box) {
  for (const double at : {py - 4, py + kFont + 1}) {
    const double top = at - kFont + 2, bottom = at + 3;
    bool free = top >= box.top && bottom <= box.bottom();
    for (const double line : lines) free = free && (line == py || line < top || line > bottom);
    for (const double other : words) free = free && std::abs(other - at) >= kRow - 3;
    if (free) return at;
  }
  return py - box.top > kRow ? py - 4 : py + kFont + 1;
}

class Drawing {
 public:
  Drawing(const Plot& plot, const SvgOptions& options) : plot_(plot), options_(options) {}
  std::string Make();

 private:
  std::string Ink(const char* name, const char* on_white) const {
    return options_.colors == SvgColors::kPage ? std::string("var(--") + name + ")" : on_white;
  }
  std::string Color(int index) const {
    const int i = index % kPlotColors;
    return Ink(("c" + std::to_string(i)).c_str(), kColors[static_cast<std::size_t>(i)]);
  }
  void Words(double x, double y, const char* anchor, const std::string& words, const char* ink,
             const char* on_white);
  void Line(double x1, double y1, double x2, double y2, const std::string& color, const char* more);
  void Layout();
  double NoteRows();
  void XAxis(const Box& box, const Scale& x, bool numbers);
  void YAxis(const PlotPanel& panel, const Box& box, const Scale& y, const AxisTicks& ticks);
  void Panel(const PlotPanel& panel, const Legend& legend, const Box& box, bool last);
  Legend LegendOf(const PlotPanel& panel) const;
  void Key(const PlotSeries& series, double x, double y);
  void DrawLegend(const PlotPanel& panel, const Legend& legend, const Box& box);
  void Limits(const PlotPanel& panel, const Box& box, const Scale& y);
  void Marks(const PlotPanel& panel, const Box& box, const Scale& x, const Scale& y);
  void Spans(const Box& box, const Scale& x);
  void SpanWords(const Box& box, const Scale& x);
  bool NoteShown(std::size_t i, double* px) const;
  double NoteHeight(std::size_t i) const;
  void NoteLines();
  void NoteWords();
  void Series(const PlotSeries& series, const Scale& x, const Scale& y);
  std::string LinePoints(const PlotSeries& series, const Scale& x, const Scale& y) const;
  std::string PathPoints(const PlotSeries& series, const Scale& x, const Scale& y) const;
  void Points(const PlotSeries& series, const Scale& x, const Scale& y);
  void ErrorBar(double px, double low, double high, const std::string& color);

  const Plot& plot_;
  const SvgOptions& options_;
  PlotRange x_range_;
  AxisTicks x_ticks_;
  std::vector<Box> boxes_;
  std::vector<Legend> legends_;
  std::vector<std::size_t> note_rows_;
  double height_ = 0, notes_top_ = 0;
  std::string svg_;
};

void Drawing::Words(double x, double y, const char* anchor, const std::string& words,
                    const char* ink, const char* on_white) {
  // With a rim, so that lines do not run through the words.
  Append(&svg_,
         "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" paint-order=\"stroke\" "
         "style=\"fill:%s;stroke:%s;stroke-width:3.5\">",
         x, y, anchor, Ink(ink, on_white).c_str(), Ink("surface", "#ffffff").c_str());
  svg_ += EscapeMarkup(words) + "</text>\n";
}

void Drawing::Line(double x1, double y1, double x2, double y2, const std::string& color,
                   const char* more) {
  Append(&svg_, "<path d=\"M%.1f %.1fL%.1f %.1f\" style=\"stroke:%s\"%s/>\n", x1, y1, x2, y2,
         color.c_str(), more);
}

// Rows above the first panel so that no two notes' words overlap.
double Drawing::NoteRows() {
  const Scale x{x_range_.low, x_range_.high, kLeft, options_.width - kRight, plot_.x.log};
  std::vector<double> ends;
  for (const PlotNote& note : plot_.notes) {
    const double width = WidthOf(note.label) + 8;
    const double at =
        std::clamp(x(note.x), kLeft, std::max(kLeft, options_.width - kRight - width));
    std::size_t row = 0;
    while (row < ends.size() && ends[row] > at) ++row;
    if (row == ends.size()) ends.push_back(0);
    ends[row] = at + width;
    note_rows_.push_back(row);
  }
  return kRow * static_cast<double>(ends.size());
}

void Drawing::Layout() {
  x_range_ = RangeOfX(plot_);
  if (plot_.equal_axes) {
    const double padding = kPadding * (x_range_.high - x_range_.low);
    x_range_ = {x_range_.low - padding, x_range_.high + padding};
  }
  const double width = options_.width - kLeft - kRight;
  const bool exact = !plot_.equal_axes;
  x_ticks_ = plot_.x.log ? LogTicks(x_range_.low, x_range_.high, 10)
                         : LinearTicks(x_range_.low, x_range_.high, 10, exact);
  notes_top_ = 22;
  double top = notes_top_ + NoteRows();
  for (const PlotPanel& panel : plot_.panels) {
    legends_.push_back(LegendOf(panel));
    top += kRow * legends_.back().rows + 6;
    double height = panel.height * options_.panel_height;
    if (plot_.equal_axes) {
      const PlotRange y = RangeOfY(panel, x_range_);
      const double scale = width / (x_ticks_.high - x_ticks_.low);
      height = std::clamp((y.high - y.low) * scale, 120.0, 0.62 * options_.width);
    }
    boxes_.push_back({kLeft, top, width, height});
    top += height + kBetween;
  }
  height_ = top - kBetween + kBottom;
}

void Drawing::XAxis(const Box& box, const Scale& x, bool numbers) {
  const std::string grid = Ink("grid", "#e3e6ea");
  const bool categories = !plot_.x.categories.empty();
  const std::size_t count = categories ? plot_.x.categories.size() : x_ticks_.at.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double at = categories ? static_cast<double>(i) : x_ticks_.at[i];
    const double px = x(at);
    if (px < box.left - 0.5 || px > box.right() + 0.5) continue;
    if (!categories) Line(px, box.top, px, box.bottom(), grid, "");
    if (numbers)
      Words(px, box.bottom() + kRow, "middle",
            categories ? plot_.x.categories[i] : x_ticks_.text[i], "quiet", "#4d5763");
  }
  if (numbers)
    Words(box.left + box.width / 2, box.bottom() + 2 * kRow + 2, "middle", AxisTitle(plot_.x),
          "ink", "#1c232c");
}

void Drawing::YAxis(const PlotPanel& panel, const Box& box, const Scale& y,
                    const AxisTicks& ticks) {
  const std::string grid = Ink("grid", "#e3e6ea");
  for (std::size_t i = 0; i < ticks.at.size(); ++i) {
    const double py = y(ticks.at[i]);
    if (py < box.top - 0.5 || py > box.bottom() + 0.5) continue;
    Line(box.left, py, box.right(), py, grid, "");
    Words(box.left - 6, py + 4, "end", ticks.text[i], "quiet", "#4d5763");
  }
  Append(&svg_, "<g transform=\"translate(13 %.1f) rotate(-90)\">", box.top + box.height / 2);
  Words(0, 0, "middle", AxisTitle(panel.y), "ink", "#1c232c");
  svg_ += "</g>\n";
}

void Drawing::Spans(const Box& box, const Scale& x) {
  for (const PlotSpan& span : plot_.spans) {
    const double from = std::max(x(span.from), box.left), to = std::min(x(span.to), box.right());
    if (!(from < to)) continue;
    Append(&svg_,
           "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" style=\"fill:%s\"/>\n", from,
           box.top, to - from, box.height, Ink("shade", "#f1f2f4").c_str());
  }
}

// In the first panel, above its lines.
void Drawing::SpanWords(const Box& box, const Scale& x) {
  for (const PlotSpan& span : plot_.spans) {
    const double from = std::max(x(span.from), box.left), to = std::min(x(span.to), box.right());
    if (to - from > WidthOf(span.label))
      Words((from + to) / 2, box.top + 13, "middle", span.label, "quiet", "#4d5763");
  }
}

// Lines with their keys, then the limits that are too far away to be drawn. Beside the panel's
// title if there is room for all, else in rows below it.
Legend Drawing::LegendOf(const PlotPanel& panel) const {
  Legend legend;
  const PlotRange range = RangeOfY(panel, x_range_);
  const double room = options_.width - kLeft - kRight;
  double length = 0;
  const auto add = [&](const PlotSeries* series, const std::string& words) {
    const double key = series ? kKey + 4 : 0;
    legend.entries.push_back({series, Fitting(words, room - key), 0, 0});
    length += legend.entries.back().Width();
  };
  for (const PlotSeries& series : panel.series)
    if (!series.label.empty()) add(&series, series.label);
  for (const PlotLimit& limit : panel.limits)
    if (!Shown(limit, range)) add(nullptr, limit.label + (limit.value > range.high ? " ↑" : " ↓"));
  const bool beside = length <= room - WidthOf(panel.title);
  double x = beside ? room - length : 0;
  legend.rows = beside || legend.entries.empty() ? 1 : 2;
  for (LegendEntry& entry : legend.entries) {
    if (!beside && x > 0 && x + entry.Width() - kGap > room) {
      x = 0;
      ++legend.rows;
    }
    entry.x = kLeft + x + (beside ? kGap : 0);
    entry.row = legend.rows - 1;
    x += entry.Width();
  }
  return legend;
}

void Drawing::Key(const PlotSeries& series, double x, double y) {
  const std::string color = Color(series.color);
  if (series.kind == SeriesKind::kBars)
    Append(&svg_, "<rect x=\"%.1f\" y=\"%.1f\" width=\"12\" height=\"9\" style=\"fill:%s\"/>\n",
           x + 8, y - 8, color.c_str());
  else if (series.kind == SeriesKind::kMarkers)
    Append(&svg_, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" style=\"fill:%s\"/>\n", x + 14, y - 4,
           color.c_str());
  else
    Line(x, y - 4, x + kKey, y - 4, color,
         series.style == LineStyle::kSolid ? " stroke-width=\"2\""
                                           : " stroke-width=\"2\" stroke-dasharray=\"6 3\"");
}

void Drawing::DrawLegend(const PlotPanel& panel, const Legend& legend, const Box& box) {
  const double top = box.top - 7 - kRow * (legend.rows - 1);
  Words(box.left, top, "start", panel.title, "ink", "#1c232c");
  for (const LegendEntry& entry : legend.entries) {
    const double y = top + kRow * entry.row;
    if (entry.series) Key(*entry.series, entry.x, y);
    if (entry.series)
      Words(entry.x + kKey + 4, y, "start", entry.words, "ink", "#1c232c");
    else
      Words(entry.x, y, "start", entry.words, "limit", "#b3122f");
  }
}

// All lines before all words, whose rim interrupts those that it meets.
void Drawing::Limits(const PlotPanel& panel, const Box& box, const Scale& y) {
  std::vector<double> lines, words;
  const auto inside = [&](double py) { return py >= box.top - 0.5 && py <= box.bottom() + 0.5; };
  for (const PlotLimit& limit : panel.limits) {
    const double py = y(limit.value);
    if (!inside(py)) continue;
    Line(box.left, py, box.right(), py, Ink("limit", "#b3122f"), " stroke-dasharray=\"7 4\"");
    lines.push_back(py);
  }
  for (const PlotLimit& limit : panel.limits) {
    if (!inside(y(limit.value))) continue;
    words.push_back(HeightOfWords(y(limit.value), lines, words, box));
    Words(box.right() - 4, words.back(), "end", limit.label, "limit", "#b3122f");
  }
}

void Drawing::Marks(const PlotPanel& panel, const Box& box, const Scale& x, const Scale& y) {
  for (const PlotMark& mark : panel.marks) {
    const double px = x(mark.x), py = y(mark.y);
    if (px < box.left || px > box.right() || py < box.top || py > box.bottom()) continue;
    Append(&svg_, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" style=\"fill:none;stroke:%s\"/>\n", px,
           py, Ink("ink", "#1c232c").c_str());
    const bool left = px + 8 + WidthOf(mark.label) > box.right();
    Words(px + (left ? -7 : 7), std::max(py - 5, box.top + kFont), left ? "end" : "start",
          mark.label, "ink", "#1c232c");
  }
}

// The lowest and highest point of each half pixel, in their order.
std::string Drawing::LinePoints(const PlotSeries& series, const Scale& x, const Scale& y) const {
  std::string d;
  struct Point {
    double x, y;
  };
  Point low{}, high{};
  long column = -1;
  bool pen = false, low_first = true;
  const auto put = [&](const Point& p) {
    Append(&d, "%c%.1f %.1f", pen ? 'L' : 'M', p.x, p.y);
    pen = true;
  };
  const auto flush = [&] {
    if (column < 0) return;
    put(low_first ? low : high);
    if (low.y != high.y) put(low_first ? high : low);
    column = -1;
  };
  for (std::size_t i = 0; i < series.y->size(); ++i) {
    const double value = (*series.y)[i], at = (*series.x)[i];
    if (!std::isfinite(value) || (y.log && value <= 0) || (x.log && at <= 0)) {
      flush();
      pen = false;
      continue;
    }
    const Point p{x(at), y(value)};
    if (p.x < x.from - 1 || p.x > x.to + 1) continue;
    const long c = std::lround(2 * p.x);
    if (c != column) flush();
    if (column < 0) {
      low = high = p;
      column = c;
    } else if (p.y < low.y) {
      low = p;
      low_first = false;
    } else if (p.y > high.y) {
      high = p;
      low_first = true;
    }
  }
  flush();
  return d;
}

std::string Drawing::PathPoints(const PlotSeries& series, const Scale& x, const Scale& y) const {
  constexpr double kStep = 0.6;  // [px]
  std::string d;
  bool pen = false;
  double px = 0, py = 0;
  for (std::size_t i = 0; i < series.y->size(); ++i) {
    const double qx = x((*series.x)[i]), qy = y((*series.y)[i]);
    if (!std::isfinite(qx) || !std::isfinite(qy)) {
      pen = false;
      continue;
    }
    if (pen && std::hypot(qx - px, qy - py) < kStep) continue;
    Append(&d, "%c%.1f %.1f", pen ? 'L' : 'M', qx, qy);
    pen = true;
    px = qx;
    py = qy;
  }
  return d;
}

void Drawing::ErrorBar(double px, double low, double high, const std::string& color) {
  Append(&svg_,
         "<path d=\"M%.1f %.1fh8m-4 0V%.1fm-4 0h8\" style=\"stroke:%s\" stroke-width=\"1.4\"/>\n",
         px - 4, high, low, color.c_str());
}

void Drawing::Points(const PlotSeries& series, const Scale& x, const Scale& y) {
  const std::string color = Color(series.color);
  for (std::size_t i = 0; i < series.y->size(); ++i) {
    const double at = (*series.x)[i], value = (*series.y)[i];
    if (!std::isfinite(value) || (y.log && value <= 0)) continue;
    const double px = x(at), py = y(value);
    if (series.kind == SeriesKind::kBars) {
      const double w = series.bar_width;
      const double from = x.log ? x(at / std::sqrt(w)) : x(at - w / 2);
      const double to = x.log ? x(at * std::sqrt(w)) : x(at + w / 2);
      const double zero = y.log ? y.from : std::clamp(y(0), y.to, y.from);
      Append(&svg_,
             "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" style=\"fill:%s\"/>\n",
             from, std::min(py, zero), std::max(to - from - 0.5, 0.5), std::abs(zero - py),
             color.c_str());
    } else {
      Append(&svg_, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" style=\"fill:%s\"/>\n", px, py,
             color.c_str());
    }
    if (series.error && std::isfinite((*series.error)[i]) && (*series.error)[i] > 0)
      ErrorBar(px, y(value - (*series.error)[i]), y(value + (*series.error)[i]),
               series.kind == SeriesKind::kBars ? Ink("ink", "#1c232c") : color);
  }
}

void Drawing::Series(const PlotSeries& series, const Scale& x, const Scale& y) {
  if (series.kind == SeriesKind::kBars || series.kind == SeriesKind::kMarkers)
    return Points(series, x, y);
  const char* dash = kDashes[static_cast<std::size_t>(series.style)];
  Append(&svg_,
         "<path stroke-width=\"1.3\" stroke-linejoin=\"round\"%s%s%s style=\"stroke:%s\" d=\"",
         *dash ? " stroke-dasharray=\"" : "", dash, *dash ? "\"" : "", Color(series.color).c_str());
  svg_ += (series.kind == SeriesKind::kPath ? PathPoints(series, x, y) : LinePoints(series, x, y)) +
          "\"/>\n";
}

void Drawing::Panel(const PlotPanel& panel, const Legend& legend, const Box& box, bool last) {
  PlotRange range = RangeOfY(panel, x_range_);
  double x_low = plot_.equal_axes ? x_ticks_.low : x_range_.low;
  double x_high = plot_.equal_axes ? x_ticks_.high : x_range_.high;
  if (plot_.equal_axes) {  // the panel's proportions decide which of the two is widened
    const double a_px =
        std::max((x_high - x_low) / box.width, (range.high - range.low) / box.height);
    const double wider = (a_px * box.width - (x_high - x_low)) / 2;
    const double higher = (a_px * box.height - (range.high - range.low)) / 2;
    x_low -= wider;
    x_high += wider;
    range = {range.low - higher, range.high + higher};
    x_ticks_ = LinearTicks(x_low, x_high, 10, true);
  }
  const int count = std::max(2, static_cast<int>(box.height / (plot_.equal_axes ? 60 : 34)));
  const AxisTicks ticks = panel.y.log ? LogTicks(range.low, range.high, count)
                                      : LinearTicks(range.low, range.high, count, true);
  const Scale x{x_low, x_high, box.left, box.right(), plot_.x.log};
  const Scale y{range.low, range.high, box.bottom(), box.top, panel.y.log};
  XAxis(box, x, last);
  YAxis(panel, box, y, ticks);
  Append(&svg_,
         "<svg x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" viewBox=\"%.1f %.1f %.1f "
         "%.1f\">\n",
         box.left, box.top, box.width, box.height, box.left, box.top, box.width, box.height);
  for (const PlotSeries& series : panel.series) Series(series, x, y);
  svg_ += "</svg>\n";
  Limits(panel, box, y);
  Marks(panel, box, x, y);
  Append(&svg_,
         "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" "
         "style=\"fill:none;stroke:%s\"/>\n",
         box.left, box.top, box.width, box.height, Ink("frame", "#9aa4b0").c_str());
  DrawLegend(panel, legend, box);
}

bool Drawing::NoteShown(std::size_t i, double* px) const {
  const Scale x{x_range_.low, x_range_.high, kLeft, options_.width - kRight, plot_.x.log};
  *px = x(plot_.notes[i].x);
  return *px >= kLeft - 0.5 && *px <= options_.width - kRight + 0.5;
}

double Drawing::NoteHeight(std::size_t i) const {
  return notes_top_ + kRow * (static_cast<double>(note_rows_[i]) + 0.8);
}

// Before all words, so that they lie above the lines.
void Drawing::NoteLines() {
  for (std::size_t i = 0; i < plot_.notes.size(); ++i) {
    double px = 0;
    if (!NoteShown(i, &px)) continue;
    for (const Box& box : boxes_)
      Line(px, box.top, px, box.bottom(), Ink("quiet", "#4d5763"), " stroke-dasharray=\"3 3\"");
    Line(px, NoteHeight(i) - 9, px, boxes_.front().top, Ink("frame", "#9aa4b0"),
         " stroke-opacity=\"0.6\"");
  }
}

void Drawing::NoteWords() {
  for (std::size_t i = 0; i < plot_.notes.size(); ++i) {
    double px = 0;
    if (!NoteShown(i, &px)) continue;
    const double width = WidthOf(plot_.notes[i].label) + 8;
    const double at = std::clamp(px, kLeft, std::max(kLeft, options_.width - kRight - width));
    Words(at + 4, NoteHeight(i), "start", plot_.notes[i].label, "quiet", "#4d5763");
  }
}

std::string Drawing::Make() {
  Layout();
  Append(&svg_,
         "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" role=\"img\" "
         "font-family=\"system-ui, 'Segoe UI', Helvetica, Arial, sans-serif\" "
         "font-size=\"%.0f\" fill=\"none\" stroke-width=\"1\"",
         options_.width, height_, kFont);
  if (options_.colors == SvgColors::kFile)
    Append(&svg_, " width=\"%.0f\" height=\"%.0f\"", options_.width, height_);
  svg_ += ">\n<title>" + EscapeMarkup(plot_.title) + "</title>\n";
  if (options_.colors == SvgColors::kFile) {
    Append(&svg_, "<rect width=\"%.0f\" height=\"%.0f\" style=\"fill:#ffffff\"/>\n", options_.width,
           height_);
    Append(&svg_, "<g font-weight=\"600\">");
    Words(kLeft, 16, "start", plot_.title, "ink", "#1c232c");
    svg_ += "</g>\n";
  }
  const auto scale = [this](const Box& box) {
    return Scale{x_range_.low, x_range_.high, box.left, box.right(), plot_.x.log};
  };
  for (const Box& box : boxes_) Spans(box, scale(box));
  NoteLines();
  for (std::size_t i = 0; i < plot_.panels.size(); ++i)
    Panel(plot_.panels[i], legends_[i], boxes_[i], i + 1 == plot_.panels.size());
  if (!boxes_.empty()) SpanWords(boxes_.front(), scale(boxes_.front()));
  NoteWords();
  svg_ += "</svg>\n";
  return std::move(svg_);
}

}  // namespace

std::string ToSvg(const Plot& plot, const SvgOptions& options) {
  return Drawing(plot, options).Make();
}

const char* PlotColor(int index) { return kColors[static_cast<std::size_t>(index % kPlotColors)]; }

}  // namespace predictor
