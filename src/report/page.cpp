#include "report/page.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/error.h"
#include "core/text.h"
#include "report/svg.h"

namespace predictor {

// Embedded at build time.
std::string_view ReportStyleFile(std::string_view name);
std::string_view ReportScriptFile(std::string_view name);

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKinds[] = {"line", "path", "markers", "bars"};
constexpr const char* kStyles[] = {"solid", "dashed", "dotted"};

Json Optional(const std::optional<double>& x) { return x ? Json(*x) : Json(nullptr); }

Json ToJson(const PlotAxis& axis) {
  return {{"title", AxisTitle(axis)},  {"unit", axis.unit},
          {"low", Optional(axis.low)}, {"high", Optional(axis.high)},
          {"zero", axis.zero},         {"log", axis.log},
          {"least", axis.least},       {"categories", axis.categories}};
}

Json ToJson(const PlotSeries& series, double x_step, PageData* data) {
  Json json = {{"label", series.label},
               {"kind", kKinds[static_cast<int>(series.kind)]},
               {"color", series.color % kPlotColors},
               {"style", kStyles[static_cast<int>(series.style)]},
               {"x", data->Add(series.x, x_step)},
               {"y", data->Add(series.y, series.resolution)}};
  if (series.error) json["error"] = data->Add(series.error, series.resolution);
  if (series.x_detail && !series.x_detail->empty()) {
    json["xDetail"] = data->Add(series.x_detail, x_step);
    json["yDetail"] = data->Add(series.y_detail, series.resolution);
  }
  if (series.kind == SeriesKind::kBars) json["barWidth"] = series.bar_width;
  return json;
}

template <class Items, class Function>
Json List(const Items& items, Function function) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(function(item));
  return list;
}

// Times are of ticks: to a tenth of a millisecond, so that none moves by a pixel; what is
// logarithmic begins small.
double StepOfX(const Plot& plot) { return plot.x.unit == "s" || plot.x.log ? 1e-4 : 0; }

Json ToJson(const Plot& plot, PageData* data) {
  PlotRange x = RangeOfX(plot);
  if (plot.equal_axes) {
    const double padding = 0.04 * (x.high - x.low);
    x = {x.low - padding, x.high + padding};
  }
  Json json = {{"id", plot.id},
               {"x", ToJson(plot.x)},
               {"range", {x.low, x.high}},
               {"equal", plot.equal_axes},
               {"group", plot.group}};
  json["spans"] = List(plot.spans, [](const PlotSpan& s) {
    return Json{{"from", s.from}, {"to", s.to}, {"label", s.label}};
  });
  json["notes"] = List(plot.notes, [](const PlotNote& n) {
    return Json{{"x", n.x}, {"label", n.label}};
  });
  json["panels"] = List(plot.panels, [&](const PlotPanel& panel) {
    const PlotRange y = RangeOfY(panel, x);
    Json p = {{"title", panel.title},
              {"y", ToJson(panel.y)},
              {"range", {y.low, y.high}},
              {"height", panel.height}};
    p["series"] =
        List(panel.series, [&](const PlotSeries& s) { return ToJson(s, StepOfX(plot), data); });
    p["limits"] = List(panel.limits, [](const PlotLimit& l) {
      return Json{{"value", l.value}, {"label", l.label}};
    });
    p["marks"] = List(panel.marks, [](const PlotMark& m) {
      return Json{{"x", m.x}, {"y", m.y}, {"label", m.label}};
    });
    return p;
  });
  return json;
}

// A script element ends at "</": in JSON the slash may be escaped.
std::string WithinScript(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
    text.replace(at, 2, "<\\/");
  return text;
}

std::string Dump(const Json& json) {
  return WithinScript(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

// An ISO 8601-free name of a file: letters, digits, '-' and '_'.
std::string FileName(const std::string& id) {
  std::string name;
  for (const char c : id) name += std::isalnum(static_cast<unsigned char>(c)) || c == '-' ? c : '_';
  return name;
}

}  // namespace

ReportPage::ReportPage(std::string title, std::string words)
    : title_(std::move(title)), words_(std::move(words)) {}

void ReportPage::Close() {
  if (open_) body_ += "</section>\n";
  open_ = false;
}

void ReportPage::Section(const std::string& id, const std::string& title) {
  Close();
  open_ = true;
  navigation_ += "<a href=\"#" + EscapeMarkup(id) + "\">" + EscapeMarkup(title) + "</a>\n";
  body_ += "<section id=\"" + EscapeMarkup(id) + "\"><h2>" + EscapeMarkup(title) + "</h2>\n";
}

void ReportPage::Html(const std::string& html) { body_ += html; }

void ReportPage::Paragraph(const std::string& text) {
  body_ += "<p>" + EscapeMarkup(text) + "</p>\n";
}

void ReportPage::Figure(const Plot& plot) {
  SvgOptions options;
  options.colors = SvgColors::kPage;
  body_ += "<figure class=\"plot\" id=\"" + EscapeMarkup(plot.id) + "\"><figcaption>" +
           EscapeMarkup(plot.title) + "</figcaption>\n<div class=\"drawing\">" +
           ToSvg(plot, options) + "</div>\n";
  if (!plot.caption.empty())
    body_ += "<p class=\"caption\">" + EscapeMarkup(plot.caption) + "</p>\n";
  body_ += "</figure>\n";
  description_ += (description_.empty() ? "" : ",\n") + Dump(ToJson(plot, &data_));
  plots_.push_back(plot);
}

void ReportPage::Folded(const std::string& title, const std::string& text) {
  body_ += "<details><summary>" + EscapeMarkup(title) + "</summary><pre>" + EscapeMarkup(text) +
           "</pre></details>\n";
}

std::string ReportPage::Finish() {
  Close();
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      // Nothing is fetched, whatever a recording's text says.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action "
      "'none'\">\n<title>" +
      EscapeMarkup(title_) + "</title>\n<style>\n";
  html += ReportStyleFile("report.css");
  html += "</style>\n</head>\n<body>\n<header><h1>" + EscapeMarkup(title_) + "</h1>\n" + words_ +
          "</header>\n<nav>" + navigation_ +
          "<button type=\"button\" id=\"theme\" hidden>Dark or light</button></nav>\n<main>\n";
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

void WriteSvgs(const std::vector<Plot>& plots, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const Plot& plot : plots) {
    const std::filesystem::path file = std::filesystem::path(folder) / (FileName(plot.id) + ".svg");
    std::ofstream out(file, std::ios::binary);
    out << ToSvg(plot);
    if (!out.flush()) throw InputError(file.string(), "cannot be written.");
  }
}

}  // namespace predictor
