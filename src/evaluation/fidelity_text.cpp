// Writes the comparison of two runs as text and numbers.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "core/format.h"
#include "core/json_schema.h"
#include "evaluation/fidelity.h"

namespace predictor {
namespace {

// Lengths are shown in millimetres.
double Shown(double value, const std::string& unit) { return unit == "m" ? 1e3 * value : value; }
const char* ShownUnit(const std::string& unit) { return unit == "m" ? "mm" : unit.c_str(); }

// Aligns a value to the right in a column of `width` characters. An undefined value becomes a dash.
std::string Figure(const char* format, double value, std::size_t width) {
  char buffer[48] = "-";
  if (value == value) std::snprintf(buffer, sizeof buffer, format, value);
  std::string text = buffer;
  // A value of zero must have no sign.
  if (const std::size_t sign = text.find_first_of("+-");
      sign != std::string::npos && text.find('0') != std::string::npos &&
      text.find_first_of("123456789") == std::string::npos)
    text.erase(sign, 1);
  return std::string(width > text.size() ? width - text.size() : 0, ' ') + text;
}

void AppendChannel(const ChannelFidelity& f, std::string* text) {
  const auto length = [&](double value) { return Figure("%.2f", Shown(value, f.unit), 9); };
  AppendLine(text, "  %-14s %-3s%s%s%s%s%s%s%s%s%s%s%s%s", f.name.c_str(), ShownUnit(f.unit),
             length(f.std_a).c_str(), length(f.std_b).c_str(), length(f.mean_b - f.mean_a).c_str(),
             length(f.rmse).c_str(), Figure("%.1f", 100 * f.relative_rmse, 7).c_str(),
             Figure("%.3f", f.correlation, 8).c_str(), Figure("%+.1f", 1e3 * f.lag, 9).c_str(),
             length(f.warped).c_str(), length(f.peak_b - f.peak_a).c_str(),
             Figure("%.2f", f.coherence.mean, 7).c_str(),
             Figure("(%.2f)", f.coherence.chance, 7).c_str(),
             Figure("%.2f", f.repeats.ratio, 7).c_str());
}

std::string JndText(const NoticeableDifference& jnd) {
  char text[32];
  if (jnd.low == jnd.high)
    std::snprintf(text, sizeof text, "%.0f", 100 * jnd.high);
  else
    std::snprintf(text, sizeof text, "%.0f to %.0f", 100 * jnd.low, 100 * jnd.high);
  return text;
}

void AppendPerceived(const PerceivedQuantity& q, std::string* text) {
  AppendLine(text, "  %-24s%s ±%s%s ±%s %-6s%s ±%s %12s  %s", q.name.c_str(),
             Figure("%.2f", q.a, 9).c_str(), Figure("%.2f", q.error_a, 7).c_str(),
             Figure("%.2f", q.b, 10).c_str(), Figure("%.2f", q.error_b, 7).c_str(), q.unit.c_str(),
             Figure("%+.1f", 100 * q.difference, 9).c_str(),
             Figure("%.1f", 100 * q.error, 7).c_str(), JndText(q.jnd).c_str(),
             (std::string(Name(q.noticed)) + (ErrorUnknown(q) ? ", error unknown" : "")).c_str());
}

using Json = nlohmann::ordered_json;

Json ChannelJson(const ChannelFidelity& f) {
  return {{"name", f.name},
          {"unit", f.unit},
          {"range", NumberOrNull(f.range)},
          {"mean_a", NumberOrNull(f.mean_a)},
          {"mean_b", NumberOrNull(f.mean_b)},
          {"std_a", NumberOrNull(f.std_a)},
          {"std_b", NumberOrNull(f.std_b)},
          {"rmse", NumberOrNull(f.rmse)},
          {"relative_rmse", NumberOrNull(f.relative_rmse)},
          {"correlation", NumberOrNull(f.correlation)},
          {"lag", NumberOrNull(f.lag)},
          {"warped", NumberOrNull(f.warped)},
          {"peak_a", NumberOrNull(f.peak_a)},
          {"peak_b", NumberOrNull(f.peak_b)},
          {"coherence", NumberOrNull(f.coherence.mean)},
          {"coherence_by_chance", NumberOrNull(f.coherence.chance)},
          {"within_repeats", NumberOrNull(f.repeats.within)},
          {"between_repeats", NumberOrNull(f.repeats.between)},
          {"repeat_ratio", NumberOrNull(f.repeats.ratio)}};
}

Json PerceivedJson(const PerceivedQuantity& q) {
  return {{"name", q.name},
          {"unit", q.unit},
          {"a", NumberOrNull(q.a)},
          {"b", NumberOrNull(q.b)},
          {"error_a", NumberOrNull(q.error_a)},
          {"error_b", NumberOrNull(q.error_b)},
          {"difference", NumberOrNull(q.difference)},
          {"error", NumberOrNull(q.error)},
          {"jnd", {q.jnd.low, q.jnd.high}},
          {"noticed", Name(q.noticed)}};
}

}  // namespace

std::string FidelityJson(const FidelityReport& report, const std::string& name_a,
                         const std::string& name_b) {
  Json json = {{"a", name_a},
               {"b", name_b},
               {"by_phase", report.by_phase},
               {"cycles", report.cycles},
               {"period_a", NumberOrNull(report.period_a)},
               {"period_b", NumberOrNull(report.period_b)},
               {"duration", NumberOrNull(report.duration)},
               {"repeats_a", report.repeats_a},
               {"repeats_b", report.repeats_b},
               {"channels", Json::array()},
               {"perceived", Json::array()},
               {"warnings", report.warnings}};
  for (const ChannelFidelity& channel : report.channels)
    json["channels"].push_back(ChannelJson(channel));
  for (const PerceivedQuantity& quantity : report.perceived)
    json["perceived"].push_back(PerceivedJson(quantity));
  return json.dump(2) + "\n";
}

std::string FidelityText(const FidelityReport& report, const std::string& name_a,
                         const std::string& name_b) {
  std::string text;
  if (report.by_phase)
    AppendLine(&text, "%s (a) against %s (b): %zu cycles by phase; %.2f and %.2f s each",
               name_a.c_str(), name_b.c_str(), report.cycles, report.period_a, report.period_b);
  else
    AppendLine(&text, "%s (a) against %s (b): %.1f s from the start", name_a.c_str(),
               name_b.c_str(), report.duration);
  for (const std::string& warning : report.warnings)
    AppendLine(&text, "Warning: %s", warning.c_str());
  AppendLine(&text,
             "%zu and %zu %s as repeats; ratio: differences between a and b, relative to those "
             "within a and within b",
             report.repeats_a, report.repeats_b, report.by_phase ? "cycles" : "runs");
  AppendLine(&text, "  %-14s %-3s%9s%9s%9s%9s%7s%8s%9s%9s%9s%14s%7s", "", "", "std a", "std b",
             "mean b-a", "rmse", "% of a", "r", "lag ms", "warped", "peak b-a", "coherence",
             "ratio");
  for (const ChannelFidelity& channel : report.channels) AppendChannel(channel, &text);
  if (report.perceived.empty()) return text;
  AppendLine(
      &text,
      "What a hand would feel: a and b (± standard error), b minus a and its JND in %% of a");
  for (const PerceivedQuantity& quantity : report.perceived) AppendPerceived(quantity, &text);
  return text;
}

}  // namespace predictor
