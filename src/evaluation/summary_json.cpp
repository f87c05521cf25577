// Writes the summary as JSON, and its schema. The JSON and its schema are made from lists of
// results.
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/json_schema.h"
#include "core/tick_fields.h"
#include "core/words.h"
#include "evaluation/summary.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

Result Entry(const char* path, ResultValue value, const char* meaning,
             const Unit& unit = units::kNone, Chapter chapter = Chapter::kSummary) {
  return {.path = path,
          .group = "",
          .unit = unit,
          .meaning = meaning,
          .value = std::move(value),
          .chapter = chapter};
}

ResultValue HandName(int hand) {
  if (hand < 0 || hand >= kHands) return {};
  return kHandNames[static_cast<std::size_t>(hand)];
}

const char* NameOf(Quantity quantity) { return kQuantityNames[static_cast<std::size_t>(quantity)]; }

// ---- lists of results -------------------------------------------------------------------------

std::vector<Result> ResultsOf(const StopSummary& stop) {
  const StatusRecord& harder = stop.harder;
  const bool hardened = harder.cause != StopCause::kNone;
  const auto if_hardened = [&](const ResultValue& value) {
    return hardened ? value : ResultValue();
  };
  return {
      Entry("cause", Name(stop.cause), "cause of the stop"),
      Entry("hand", HandName(stop.hand), "hand that caused it"),
      Entry("value", stop.value, "measured value that caused the stop, SI"),
      Entry("limit", stop.limit, "its limit, SI"),
      Entry("quantity", NameOf(stop.quantity),
            "quantity of that value and limit; it is vibration if the force vibrated"),
      Entry("fastest_joint",
            stop.fastest_joint >= 0 ? 1.0 + stop.fastest_joint
                                    : std::numeric_limits<double>::quiet_NaN(),
            "if the simulation diverged: number of the cobot's fastest joint, from 1"),
      Entry("time_s", stop.time, "emulated time until the stop", units::kSecond),
      Entry("stop_duration_s", stop.duration, "time from the decision to rest", units::kSecond),
      Entry("stop_distance_m", stop.distance,
            "distance travelled by the handle that moved further, from the decision to rest",
            units::kMetre),
      Entry("power_off_by.cause", if_hardened(Name(harder.cause)),
            "fault that removed the power at the end of the stop"),
      Entry("power_off_by.hand", if_hardened(HandName(harder.hand)), "hand of that fault"),
      Entry("power_off_by.value", if_hardened(harder.value), "measured value of that fault, SI"),
      Entry("power_off_by.limit", if_hardened(harder.limit), "its limit, SI"),
      Entry("power_off_by.quantity", if_hardened(NameOf(harder.quantity)),
            "quantity of that value and limit")};
}

std::vector<Result> ResultsOf(const EventSummary& event) {
  const auto if_known = [](const std::optional<double>& value) {
    return value ? ResultValue(*value) : ResultValue();
  };
  std::vector<Result> results = {
      Entry("event", event.event, "name of the hazard"),
      Entry("begin_s", if_known(event.begin), "run time at which it began", units::kSecond),
      Entry("end_s", if_known(event.end), "run time at which it ended", units::kSecond),
      Entry("until_stop_s", if_known(event.until_stop),
            "time from the beginning of the event to the emulator's next stop", units::kSecond)};
  const auto add = [&](const char* path, const std::array<double, kHands>& largest,
                       const char* meaning, const Unit& unit) {
    results.push_back(Entry(path,
                            event.begin
                                ? ResultValue(*std::max_element(largest.begin(), largest.end()))
                                : ResultValue(),
                            meaning, unit));
  };
  add("force_N", event.force, "largest force of a hand after it began", units::kNewton);
  add("torque_Nm", event.torque, "largest torque of a hand after it began", units::kNewtonMetre);
  add("speed_m_s", event.speed, "largest speed of a handle after it began", units::kMetrePerSecond);
  return results;
}

std::vector<Result> ResultsOf(const CobotStopSummary& stop) {
  return {Entry("reason", Name(stop.reason), "what exceeded the cobot's own limit"),
          Entry("time_s", stop.time, "run time of the stop", units::kSecond)};
}

std::vector<Result> HeadOf(const Summary& s) {
  const auto of_loop = [&](auto value) {
    return s.loop ? ResultValue(value(*s.loop)) : ResultValue();
  };
  return {Entry("scenario", s.scenario, "name of the scenario"),
          Entry("seed", s.seed, "seed of the random numbers"),
          Entry("real_time_factor", s.real_time_factor, "simulated time per elapsed time",
                units::kNone, Chapter::kTiming),
          Entry("lead_s", of_loop([](const auto& loop) { return loop.lead; }),
                "time by which the reference leads the arms", units::kSecond),
          Entry("stability_margin", of_loop([](const auto& loop) { return loop.margin; }),
                "factor of the hands' impedance at which the haptic loop becomes unstable"),
          Entry("predicted_unstable", of_loop([](const auto& loop) { return !loop.stable(); }),
                "whether the haptic loop was predicted to be unstable")};
}

std::vector<Result> TailOf(const Summary& s) {
  return {Entry("overruns", s.overruns, "ticks that began late"),
          Entry("records_dropped", s.records_dropped, "records that the summary does not contain")};
}

// ---- values -----------------------------------------------------------------------------------

struct ToJson {
  Json operator()(std::monostate) const { return nullptr; }
  Json operator()(double x) const { return NumberOrNull(x); }
  Json operator()(std::uint64_t n) const { return n; }
  Json operator()(bool b) const { return b; }
  Json operator()(const std::string& text) const { return text; }
  Json operator()(const Statistics& s) const {
    return {{"mean", (*this)(s.mean())}, {"std", (*this)(s.std())}, {"max", (*this)(s.max())}};
  }
  Json operator()(const Quantiles& q) const {
    return {{"p50", q.p50}, {"p99", q.p99}, {"p999", q.p999}, {"max", q.max}};
  }
};

// Below the top level, an object that contains no value becomes null.
void Collapse(Json* json) {
  if (!json->is_object()) return;
  bool any = false;
  for (Json& member : *json) {
    Collapse(&member);
    any = any || !member.is_null();
  }
  if (!any) *json = nullptr;
}

// Converts a path such as "wrench.left" to a JSON pointer. `between` replaces the dot.
Json::json_pointer PlaceOf(const std::string& path, const std::string& between = "/") {
  std::string pointer = "/";
  for (const char c : path) pointer += c == '.' ? between : std::string(1, c);
  return Json::json_pointer(pointer);
}

void Put(const std::vector<Result>& results, bool timing, Json* root) {
  for (const Result& result : results) {
    if (result.chapter == Chapter::kTiming && !timing) continue;
    (*root)[PlaceOf(result.path)] =
        IsMissing(result.value) ? Json(nullptr) : std::visit(ToJson{}, result.value);
  }
}

template <class S>
Json JsonOf(const S& summary) {
  Json json;
  Put(ResultsOf(summary), true, &json);
  for (Json& member : json) Collapse(&member);
  return json;
}

// ---- schema -----------------------------------------------------------------------------------

struct SchemaOfValue {
  static Json Nullable(const char* type) { return {{"type", {type, "null"}}}; }
  Json operator()(std::monostate) const { return Json::object(); }
  Json operator()(double) const { return Nullable("number"); }
  Json operator()(std::uint64_t) const { return {{"type", "integer"}}; }
  Json operator()(bool) const { return Nullable("boolean"); }
  Json operator()(const std::string&) const { return Nullable("string"); }
  Json operator()(const Statistics&) const { return {{"$ref", "#/$defs/statistics"}}; }
  Json operator()(const Quantiles&) const { return {{"$ref", "#/$defs/quantiles"}}; }
};

void PutSchema(const std::vector<Result>& results, Json* properties) {
  for (const Result& result : results) {
    Json schema = std::visit(SchemaOfValue{}, result.value);
    schema["description"] = result.meaning;
    if (*result.unit.si != '\0') schema["unit"] = result.unit.si;
    for (std::size_t dot = result.path.find('.'); dot != std::string::npos;
         dot = result.path.find('.', dot + 1))
      (*properties)[PlaceOf(result.path.substr(0, dot), "/properties/")]["type"] = {"object",
                                                                                    "null"};
    (*properties)[PlaceOf(result.path, "/properties/")] = schema;
  }
}

Json NumbersSchema(const char* description, const std::vector<const char*>& keys) {
  Json schema = {{"type", {"object", "null"}}, {"description", description}};
  for (const char* key : keys) schema["properties"][key] = SchemaOfValue::Nullable("number");
  return schema;
}

}  // namespace

std::string SummaryJson(const Summary& s, bool timing) {
  Json json;
  Put(HeadOf(s), timing, &json);
  Put(s.results, timing, &json);
  for (Json& top : json)
    if (top.is_object())
      for (Json& member : top) Collapse(&member);
  json["stop"] = s.stops.empty() ? Json(nullptr) : JsonOf(s.stops.front());
  json["stop_count"] = s.stop_count;
  json["stops"] = Json::array();
  for (const StopSummary& stop : s.stops) json["stops"].push_back(JsonOf(stop));
  json["events"] = Json::array();
  for (const EventSummary& event : s.events) json["events"].push_back(JsonOf(event));
  json["cobot_stop"] = s.cobot_stop ? JsonOf(*s.cobot_stop) : Json(nullptr);
  Put(TailOf(s), timing, &json);
  return json.dump(2) + "\n";
}

std::string SummarySchema() {
  Summary s = SummaryBuilder(Scenario()).summary();
  s.loop.emplace();
  StopSummary stop;
  stop.hand = stop.harder.hand = 0;
  stop.harder.cause = StopCause::kForce;
  Json properties, of_stop = {{"type", {"object", "null"}}};
  PutSchema(HeadOf(s), &properties);
  PutSchema(s.results, &properties);
  PutSchema(ResultsOf(stop), &of_stop["properties"]);
  properties["stop"] = {{"$ref", "#/$defs/stop"}, {"description", "the first stop"}};
  properties["stop_count"] = {{"type", "integer"}, {"description", "number of stops"}};
  properties["stops"] = {
      {"type", "array"},
      {"items", {{"$ref", "#/$defs/stop"}}},
      {"description", "the stops, in order, at most " + std::to_string(StopLog::kMaxStops)}};
  Json of_event = {{"type", "object"}};
  EventSummary event;
  event.begin = event.end = event.until_stop = 0;
  PutSchema(ResultsOf(event), &of_event["properties"]);
  properties["events"] = {{"type", "array"},
                          {"items", of_event},
                          {"description", "the scenario's events, in its order"}};
  properties["cobot_stop"] = {{"type", {"object", "null"}},
                              {"description", "protective stop of the virtual cobot itself"}};
  PutSchema(ResultsOf(CobotStopSummary{}), &properties["cobot_stop"]["properties"]);
  PutSchema(TailOf(s), &properties);
  const Json schema = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", "PREDICTOR summary of a run"},
      {"type", "object"},
      {"properties", properties},
      {"$defs",
       {{"statistics", NumbersSchema("mean, standard deviation and largest value over the ticks",
                                     {"mean", "std", "max"})},
        {"quantiles", NumbersSchema("quantiles over the ticks", {"p50", "p99", "p999", "max"})},
        {"stop", of_stop}}}};
  return schema.dump(2) + "\n";
}

}  // namespace predictor
