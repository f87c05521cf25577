// Writes a continuation as JSON, and its schema.
#include "analysis/continuation/continuation.h"
#include "core/json_schema.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

Json BoundJson(const CensoredValue& value) {
  return {{"value", NumberOrNull(value.value)}, {"at_least", value.at_least}};
}

Json QuantitiesOf(const ContinuedRun& run) {
  Json json = Json::object();
  for (const ContinuationQuantity& q : kContinuationQuantities)
    json[q.key] = NumberOrNull(run.*q.value);
  return json;
}

Json RunJson(const ContinuedRun& run) {
  Json json = QuantitiesOf(run);
  json["ending"] = Name(run.ending);
  json["fault"] = Name(run.fault);
  json["cobot_stop"] = Name(run.cobot_stop);
  json["duration_s"] = run.duration;
  return json;
}

Json ArmJson(const OperatorDraw& person) {
  const ArmImpedance& arm = person.arm;
  return {{"stiffness_n_m", {arm.stiffness[0], arm.stiffness[1], arm.stiffness[2]}},
          {"damping_ratio", arm.damping_ratio},
          {"mass_kg", arm.mass},
          {"reflex_gain", arm.reflex_gain},
          {"reflex_delay_s", arm.reflex_delay},
          {"stiffening", person.stiffening}};
}

Json RunProperties() {
  Json json = Json::object();
  for (const ContinuationQuantity& q : kContinuationQuantities)
    json[q.key] = schema::Value({"number", "null"}, std::string(q.label) + ", SI");
  json["ending"] = schema::Value("string", "settles, stays_above, diverges, cobot_stops or fault");
  json["fault"] = schema::Value("string", "cause if the emulator stopped for another reason");
  json["cobot_stop"] =
      schema::Value("string", "safety function with which the cobot stopped itself");
  json["duration_s"] = schema::Value("number", "from the stop to the end [s]");
  return json;
}

Json IntervalSchema() {
  const Json bound =
      schema::Object({{"value", schema::Value({"number", "null"}, "quantile over the draws, SI")},
                      {"at_least", schema::Value("boolean", "the value is only a lower bound")}},
                     "one quantile");
  Json json = Json::object();
  for (const ContinuationQuantity& q : kContinuationQuantities)
    json[q.key] = schema::Object({{"p5", bound}, {"median", bound}, {"p95", bound}},
                                 std::string(q.label) + ", SI");
  return json;
}

}  // namespace

std::string ContinuationJson(const Continuation& c, const std::string& recording) {
  Json json = {{"recording", recording},
               {"scenario", c.scenario},
               {"operator", c.operator_type},
               {"stop",
                {{"cause", Name(c.cause.cause)},
                 {"hand", c.cause.hand},
                 {"value", c.cause.value},
                 {"limit", c.cause.limit},
                 {"time_s", c.time},
                 {"largest_force_n", c.peak_before}}},
               {"horizon_s", c.horizon},
               {"arm", c.arm_source}};
  for (const ContinuationQuantity& q : kContinuationQuantities) {
    const Interval90 range = c.IntervalOf(q.value);
    json["predicted"][q.key] = {{"p5", BoundJson(range.low)},
                                {"median", BoundJson(range.median)},
                                {"p95", BoundJson(range.high)}};
  }
  for (int k = 0; k < kEndings; ++k) {
    const auto ending = static_cast<Ending>(k);
    json["endings"][Name(ending)] = c.CountOf(ending);
  }
  json["joint_use_missing"] = c.no_joint_use;
  json["simulated_operator"] = c.reference ? RunJson(*c.reference) : Json(nullptr);
  json["draws"] = Json::array();
  for (const ContinuedRun& run : c.runs) {
    Json draw = RunJson(run);
    draw["operator"] = ArmJson(run.person);
    json["draws"].push_back(std::move(draw));
  }
  json["assumptions"] = ContinuationAssumptions(c);
  return json.dump(2) + "\n";
}

std::string ContinuationSchema() {
  Json draw = RunProperties(), endings = Json::object();
  draw["operator"] = schema::Value("object", "impedance of this possible operator's arm");
  for (int k = 0; k < kEndings; ++k)
    endings[Name(static_cast<Ending>(k))] = schema::Value("integer", "number of draws");
  Json reference = schema::Object(RunProperties(), "what the simulated operator would have done");
  reference["type"] = {"object", "null"};
  const Json text = schema::Value("string", "a sentence");
  Json root = schema::Object(
      {{"recording", schema::Value("string", "file")},
       {"scenario", schema::Value("string", "name of the scenario")},
       {"operator", schema::Value("string", "virtual, browser or person")},
       {"stop",
        schema::Object({{"cause", schema::Value("string", "cause of the stop")},
                        {"hand", schema::Value("integer", "0 left, 1 right, -1 neither")},
                        {"value", schema::Value("number", "value that exceeded the limit, SI")},
                        {"limit", schema::Value("number", "limit, SI")},
                        {"time_s", schema::Value("number", "time of the run [s]")},
                        {"largest_force_n",
                         schema::Value("number", "largest force of a hand up to the stop [N]")}},
                       "the stop that the continuation leaves out")},
       {"horizon_s", schema::Value("number", "time after the stop [s]")},
       {"arm", schema::Value("string", "source of the arm's impedance")},
       {"predicted", schema::Object(IntervalSchema(), "quantiles over the draws")},
       {"endings", schema::Object(endings, "how the draws ended")},
       {"joint_use_missing", schema::Value("string", "why joint_use is null; empty: it is known")},
       {"simulated_operator", reference},
       {"draws", schema::Array(schema::Object(draw, "one possible operator"), "all draws")},
       {"assumptions", schema::Array(text, "what was assumed")}},
      "What would have happened if PREDICTOR had not stopped a run");
  root["$schema"] = schema::kDraft;
  return root.dump(2) + "\n";
}

}  // namespace predictor
