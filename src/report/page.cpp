#include "report/page.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/text.h"

namespace predictor {

// This file is embedded by the build.
std::string_view ReportStyleFile(std::string_view name);
std::string_view ReportScriptFile(std::string_view name);

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKinds[] = {"line", "path", "markers", "area", "bars"};
constexpr const char* kSymbols[] = {"dot",      "ring",   "diamond", "hollow diamond",
                                    "triangle", "square", "cross",   "plus"};
constexpr const char* kStyles[] = {"solid", "dashed", "dotted"};

Json Optional(const std::optional<double>& x) { return x ? Json(*x) : Json(nullptr); }

Json ToJson(const PlotAxis& axis) {
  return {{"title", AxisTitle(axis)},    {"unit", axis.unit},   {"low", Optional(axis.low)},
          {"high", Optional(axis.high)}, {"zero", axis.zero},   {"log", axis.log},
          {"least", axis.least},         {"names", axis.names}, {"first", axis.first}};
}

Json ToJson(const PlotSeries& series, double x_step, PageData* data) {
  Json json = {{"label", series.label},
               {"kind", kKinds[static_cast<int>(series.kind)]},
               {"color", series.color % kPlotColors},
               {"style", kStyles[static_cast<int>(series.style)]},
               {"x", data->Add(series.x, x_step)},
               {"y", data->Add(series.y, series.resolution)}};
  if (series.x_detail && !series.x_detail->empty()) {
    json["xDetail"] = data->Add(series.x_detail, x_step);
    json["yDetail"] = data->Add(series.y_detail, series.resolution);
  }
  if (series.base) json["base"] = data->Add(series.base, series.resolution);
  if (series.error) json["error"] = data->Add(series.error, series.resolution);
  if (series.kind == SeriesKind::kMarkers)
    json["symbol"] = kSymbols[static_cast<int>(series.symbol)];
  if (series.kind == SeriesKind::kBars) json["barWidth"] = series.bar_width;
  return json;
}

template <class Items, class Function>
Json List(const Items& items, Function function) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(function(item));
  return list;
}

// Time axes have a resolution of 0.1 ms, so that rounding moves no point by a pixel. Logarithmic
// axes need the same resolution, because their smallest values are small.
double StepOfX(const Plot& plot) { return plot.x.unit == "s" || plot.x.log ? 1e-4 : 0; }

Json ToJson(const Plot& plot, PageData* data) {
  Json json = {{"id", plot.id},
               {"title", plot.title},
               {"x", ToJson(plot.x)},
               {"equal", plot.equal_axes},
               {"group", plot.group}};
  json["spans"] = List(plot.spans, [](const PlotSpan& s) {
    return Json{{"from", s.from}, {"to", s.to}, {"label", s.label}};
  });
  json["notes"] = List(plot.notes, [](const PlotNote& n) {
    return Json{{"x", n.x}, {"label", n.label}};
  });
  json["panels"] = List(plot.panels, [&](const PlotPanel& panel) {
    Json p = {{"title", panel.title}, {"y", ToJson(panel.y)}, {"height", panel.height}};
    p["series"] =
        List(panel.series, [&](const PlotSeries& s) { return ToJson(s, StepOfX(plot), data); });
    p["limits"] = List(panel.limits, [](const PlotLimit& l) {
      return Json{{"value", l.value}, {"label", l.label}};
    });
    return p;
  });
  return json;
}

std::string Dump(const Json& json) {
  return JsonInScript(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

// In a browser, larger numbers are not stored as exact integers.
constexpr double kMaxSteps = 4e15;

double StepOf(const std::vector<double>& values, double step) {
  double low = INFINITY, high = -INFINITY;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  if (!(low <= high)) return 1;
  if (step <= 0) step = high > low ? (high - low) / 50000 : std::max(std::abs(high), 1.0) / 50000;
  const double least = std::max(std::abs(low), std::abs(high)) / kMaxSteps;
  return std::max(step, least);
}

// Titles may come from files, so control characters in them are made visible to the reader.
std::string Heading(const std::string& title) { return EscapeMarkup(Printable(title)); }

}  // namespace

std::string EncodeSteps(const std::vector<double>& values, double step) {
  std::string bytes;
  bytes.reserve(values.size() + values.size() / 4);
  std::int64_t last = 0;
  for (const double v : values) {
    if (!std::isfinite(v)) {
      bytes += '\0';
      continue;
    }
    const std::int64_t now = std::llround(v / step);
    const std::int64_t difference = now - last;
    last = now;
    std::uint64_t code = (static_cast<std::uint64_t>(difference) << 1U) ^
                         static_cast<std::uint64_t>(difference >> 63);
    ++code;
    for (; code >= 128; code >>= 7U) bytes += static_cast<char>(code | 128U);
    bytes += static_cast<char>(code);
  }
  return bytes;
}

std::string Base64(const std::string& bytes) {
  static constexpr char kLetters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8U | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= n ? kLetters[three >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

int PageData::Add(const Samples& values, double step) {
  const auto [it, added] = numbers_.try_emplace(values.get(), static_cast<int>(kept_.size()));
  if (!added) return it->second;
  kept_.push_back(values);
  const double used = StepOf(*values, step);
  html_ += "<script type=\"text/plain\" id=\"data-" + std::to_string(it->second) +
           "\" data-count=\"" + std::to_string(values->size()) + "\" data-step=\"" +
           FormatNumber(used) + "\">" + Base64(EncodeSteps(*values, used)) + "</script>\n";
  return it->second;
}

ReportPage::ReportPage(std::string title, std::string words)
    : title_(std::move(title)), words_(std::move(words)) {}

void ReportPage::Close() {
  if (open_) body_ += "</section>\n";
  open_ = false;
}

void ReportPage::Section(const std::string& id, const std::string& title) {
  Close();
  open_ = true;
  navigation_ += "<a href=\"#" + EscapeMarkup(id) + "\">" + Heading(title) + "</a>\n";
  body_ += "<section id=\"" + EscapeMarkup(id) + "\"><h2>" + Heading(title) + "</h2>\n";
}

void ReportPage::Html(const std::string& html) { body_ += html; }

void ReportPage::Paragraph(const std::string& text) {
  body_ += "<p>" + EscapeMarkup(text) + "</p>\n";
}

void ReportPage::Figure(const Plot& plot) {
  body_ += "<figure class=\"plot\" id=\"" + EscapeMarkup(plot.id) + "\"><figcaption>" +
           Heading(plot.title) + "</figcaption>\n<div class=\"drawing\"></div>\n";
  if (!plot.caption.empty())
    body_ += "<p class=\"caption\">" + EscapeMarkup(plot.caption) + "</p>\n";
  body_ += "</figure>\n";
  description_ += (description_.empty() ? "" : ",\n") + Dump(ToJson(plot, &data_));
  plots_.push_back(plot);
}

void ReportPage::Folded(const std::string& title, const std::string& text) {
  body_ += "<details><summary>" + Heading(title) + "</summary><pre>" + EscapeMarkup(text) +
           "</pre></details>\n";
}

std::string ReportPage::Finish() {
  Close();
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      // The page may not load anything, whatever text a recording contains.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action "
      "'none'\">\n<title>" +
      Heading(title_) + "</title>\n<style>\n";
  html += ReportStyleFile("report.css");
  html += "</style>\n</head>\n<body>\n<header><h1>" + Heading(title_) + "</h1>\n" + words_ +
          "</header>\n<nav>" + navigation_ +
          "<button type=\"button\" id=\"theme\" hidden>Dark or light</button></nav>\n<main>\n"
          "<noscript><p class=\"warning\">The plots need JavaScript, which is switched off "
          "here.</p></noscript>\n";
  html += body_ + "</main>\n" + data_.Html();
  html +=
      "<script type=\"application/json\" id=\"plots\">[" + description_ + "]</script>\n<script>";
  html += ReportScriptFile("report.js");
  html += "</script>\n</body>\n</html>\n";
  return html;
}

std::string HtmlTable(const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<div class=\"table\"><table>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    html += "<tr>";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const char* tag = r == 0 || c == 0 ? "th" : "td";
      html += std::string("<") + tag + ">" + rows[r][c] + "</" + tag + ">";
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

}  // namespace predictor
