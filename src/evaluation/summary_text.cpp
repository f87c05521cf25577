// The summary as JSON for scripts and as a table for people.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/format.h"
#include "core/text.h"
#include "core/units.h"
#include "core/words.h"
#include "evaluation/summary.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

Json Number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json ToJson(const Statistics& s) {
  return {{"mean", Number(s.mean())}, {"std", Number(s.std())}, {"max", Number(s.max())}};
}

Json ToJson(const PairStatistics& p, const char* translation, const char* rotation) {
  if (p.translation.count() == 0) return nullptr;
  return {{translation, ToJson(p.translation)}, {rotation, ToJson(p.rotation)}};
}

Json ToJson(const TrackingStatistics& t) {
  Json relative = ToJson(t.relative, "distance_m", "angle_rad");
  if (!relative.is_null()) relative["right_from_left_m"] = ToJson(t.right_from_left);
  return {{"left", ToJson(t.hands[0], "translation_m", "rotation_rad")},
          {"right", ToJson(t.hands[1], "translation_m", "rotation_rad")},
          {"relative", relative}};
}

Json HandName(int hand) {
  return hand < 0 || hand >= kHands ? Json(nullptr)
                                    : Json(kHandNames[static_cast<std::size_t>(hand)]);
}

Json ToJson(const StatusRecord& status) {
  if (status.cause == StopCause::kNone) return nullptr;
  return {{"cause", Name(status.cause)},
          {"hand", HandName(status.hand)},
          {"value", Number(status.value)},
          {"limit", Number(status.limit)}};
}

Json ToJson(const StopSummary& stop) {
  return {{"cause", Name(stop.cause)},
          {"hand", HandName(stop.hand)},
          {"value", Number(stop.value)},
          {"limit", Number(stop.limit)},
          {"time_s", Number(stop.time)},
          {"stop_duration_s", stop.duration},
          {"stop_distance_m", Number(stop.distance)},
          {"power_off_by", ToJson(stop.harder)}};
}

Json HeightJson(const Summary& s) {
  if (s.ticks == 0) return nullptr;
  return {{"initial", s.height_initial},
          {"min", s.height_min},
          {"max", s.height_max},
          {"final", s.height_final}};
}

Json ToJson(const Histogram& h, bool ran) {
  if (!ran) return nullptr;
  return {{"p50", h.Quantile(0.5)},
          {"p99", h.Quantile(0.99)},
          {"p999", h.Quantile(0.999)},
          {"max", h.max()}};
}

std::string InMillimetres(const Statistics& s) {
  return Formatted("%8.3f ±%6.3f %8.3f", 1e3 * s.mean(), 1e3 * s.std(), 1e3 * s.max());
}

void AddErrors(const char* name, const Statistics& translation, const Statistics& rotation,
               std::string* text) {
  if (translation.count() == 0) return;
  AppendLine(text, "  %-31s %s   %9.4f ±%7.4f %9.4f", name, InMillimetres(translation).c_str(),
             kDegrees * rotation.mean(), kDegrees * rotation.std(), kDegrees * rotation.max());
}

void AddTracking(const char* title, const TrackingStatistics& t, std::string* text) {
  AppendLine(text, "%-33s translation [mm]           rotation [deg]", title);
  AppendLine(text, "  %-31s %16s %8s   %18s %9s", "", "mean ± std", "max", "mean ± std", "max");
  AddErrors("left handle", t.hands[0].translation, t.hands[0].rotation, text);
  AddErrors("right handle", t.hands[1].translation, t.hands[1].rotation, text);
  if (t.right_from_left.count() == 0) return;
  AppendLine(text, "  %-31s %s", "distance between the handles",
             InMillimetres(t.relative.translation).c_str());
  AddErrors("right handle seen from the left", t.right_from_left, t.relative.rotation, text);
}

void AddStop(const StopSummary& stop, std::string* text) {
  std::string seen = ".";
  if (stop.quantity != Quantity::kNone)
    seen = ": " + SeenAndAllowed(stop.value, stop.limit, stop.quantity) + ".";
  AppendLine(text, "Stopped after %.3f s of emulation by cause '%s'%s%s%s", stop.time,
             Name(stop.cause), stop.hand < 0 ? "" : ", hand ",
             stop.hand < 0 ? "" : kHandNames[static_cast<std::size_t>(stop.hand)], seen.c_str());
  if (DidNotRest(stop))
    AppendLine(text, "  The arms had not come to rest.");
  else
    AppendLine(text, "  At rest after %.0f ms and %.1f mm.", 1e3 * stop.duration,
               1e3 * stop.distance);
  if (const std::string harder = HarderWords(stop.harder); !harder.empty())
    AppendLine(text, " %s", harder.c_str());
  if (stop.detection)
    AppendLine(text, "  Decided %.0f ms after the hand's true value crossed the threshold.",
               1e3 * *stop.detection);
}

void AddStops(const Summary& s, std::string* text) {
  constexpr std::size_t kTold = 10;
  if (s.stops.empty()) return AppendLine(text, "No safety stop.");
  if (s.stop_count > 1)
    AppendLine(text, "%llu stops:", static_cast<unsigned long long>(s.stop_count));
  const std::size_t told = std::min(s.stops.size(), kTold);
  for (std::size_t i = 0; i < told; ++i) AddStop(s.stops[i], text);
  if (s.stop_count > told)
    AppendLine(text, "And %llu more; --json FILE.json lists %zu.",
               static_cast<unsigned long long>(s.stop_count - told), s.stops.size());
}

void AddTiming(const Summary& s, std::string* text) {
  AppendLine(text, "Time a tick [µs]        p50      p99    p99.9      max");
  for (std::size_t k = 0; k < kStages; ++k) {
    const Histogram& h = s.timing[k];
    AppendLine(text, "  %-14s %10.1f %8.1f %8.1f %8.1f", kStageNames[k], h.Quantile(0.5),
               h.Quantile(0.99), h.Quantile(0.999), h.max());
  }
}

void AddHands(const Summary& s, std::string* text) {
  AppendLine(text, "Hands                 force [N]                   torque [N·m]");
  for (std::size_t i = 0; i < kHands; ++i) {
    const PairStatistics& w = s.wrench[i];
    if (w.translation.count() == 0) continue;
    AppendLine(text, "  %-16s %8.2f ±%6.2f, max %6.2f   %8.3f ±%6.3f, max %6.3f", kHandNames[i],
               w.translation.mean(), w.translation.std(), w.translation.max(), w.rotation.mean(),
               w.rotation.std(), w.rotation.max());
  }
}

// Results that exist only if the run started.
void AddFigures(const Summary& s, std::string* text) {
  if (s.ticks > s.released_ticks) AddTracking("While gripping", s.gripping, text);
  if (s.released_ticks > 0) AddTracking("While released", s.released, text);
  if (s.released_ticks > 0 && s.ticks > s.released_ticks)
    AddTracking("Whole run", s.whole_run, text);
  *text += '\n';
  AddHands(s, text);
  if (std::isfinite(s.link_distance_min))
    AppendLine(text, "Nearest link pair      %.3f m", s.link_distance_min);
  AppendLine(text, "Height of the object   %.3f m at the start, %.3f to %.3f m, %.3f m at the end",
             s.height_initial, s.height_min, s.height_max, s.height_final);
  if (s.qp_solved + s.qp_failed > 0)
    AppendLine(text, "Rendering              %llu solved, %llu of them relaxed, %llu failed",
               static_cast<unsigned long long>(s.qp_solved),
               static_cast<unsigned long long>(s.qp_relaxed),
               static_cast<unsigned long long>(s.qp_failed));
}

}  // namespace

std::string LoopWords(const PredictedLoop& loop) {
  return Formatted("Lead %.1f ms, stability margin %.1f: ", 1e3 * loop.lead, loop.margin) +
         (loop.stable() ? "the haptic loop was predicted stable."
                        : "the haptic loop was PREDICTED UNSTABLE with this hand. Run "
                          "`predictor check`.");
}

std::string SummaryJson(const Summary& s, bool timing) {
  Json tracking = ToJson(s.gripping);
  tracking["released"] = s.released_ticks > 0 ? ToJson(s.released) : Json(nullptr);
  tracking["whole_run"] = ToJson(s.whole_run);
  Json json = {
      {"scenario", s.scenario}, {"seed", s.seed}, {"duration_s", s.duration}, {"ticks", s.ticks}};
  if (timing) json["real_time_factor"] = s.real_time_factor;
  json["lead_s"] = s.loop ? Number(s.loop->lead) : Json(nullptr);
  json["stability_margin"] = s.loop ? Number(s.loop->margin) : Json(nullptr);
  json["predicted_unstable"] = s.loop ? Json(!s.loop->stable()) : Json(nullptr);
  json["tracking"] = tracking;
  json["wrench"] = {{"left", ToJson(s.wrench[0], "force_n", "torque_nm")},
                    {"right", ToJson(s.wrench[1], "force_n", "torque_nm")}};
  json["elbow_distance_m"] = {{"min", Number(s.link_distance_min)}};
  json["object"] = {{"height_m", HeightJson(s)}};
  json["stop"] = s.stops.empty() ? Json(nullptr) : ToJson(s.stops.front());
  json["stop_count"] = s.stop_count;
  json["stops"] = Json::array();
  for (const StopSummary& stop : s.stops) json["stops"].push_back(ToJson(stop));
  json["qp"] = {{"solved", s.qp_solved}, {"relaxed", s.qp_relaxed}, {"failed", s.qp_failed}};
  if (timing) {
    Json times;
    const auto add = [&](Stage stage) {
      const auto k = static_cast<std::size_t>(stage);
      times[kStageNames[k]] = ToJson(s.timing[k], s.ticks > 0);
    };
    add(Stage::kTick);
    for (int k = 0; k < static_cast<int>(Stage::kTick); ++k) add(static_cast<Stage>(k));
    json["timing_us"] = times;
  }
  json["overruns"] = s.overruns;
  json["records_dropped"] = s.records_dropped;
  return json.dump(2) + "\n";
}

std::string SummaryTable(const Summary& s) {
  std::string text;
  AppendLine(&text, "%s", Printable(s.scenario).c_str());
  if (s.ticks == 0)
    AppendLine(&text, "Not run: it never came to RUN, so there are no errors and forces to tell.");
  else
    AppendLine(&text, "%.2f s emulated in %llu ticks, %s, seed %llu", s.duration,
               static_cast<unsigned long long>(s.ticks),
               s.by_the_clock ? "in real time"
                              : Formatted("%.1f times real time", s.real_time_factor).c_str(),
               static_cast<unsigned long long>(s.seed));
  if (s.loop) AppendLine(&text, "%s", LoopWords(*s.loop).c_str());
  text += '\n';
  if (s.ticks > 0) AddFigures(s, &text), text += '\n';
  AddStops(s, &text);
  text += '\n';
  if (s.ticks > 0) AddTiming(s, &text);
  if (s.overruns + s.records_dropped > 0)
    AppendLine(&text, "Ticks that began late: %llu. Records dropped: %llu.",
               static_cast<unsigned long long>(s.overruns),
               static_cast<unsigned long long>(s.records_dropped));
  return text;
}

}  // namespace predictor
