// A continuation as JSON, with its schema.
#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/continuation/continuation.h"

namespace predictor {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson NumberOrNull(double x) {
  return std::isfinite(x) ? OrderedJson(x) : OrderedJson(nullptr);
}

OrderedJson BoundJson(const CensoredValue& value) {
  return {{"value", NumberOrNull(value.value)}, {"at_least", value.at_least}};
}

OrderedJson QuantitiesOf(const ContinuedRun& run) {
  OrderedJson json = OrderedJson::object();
  for (const ContinuationQuantity& q : kContinuationQuantities)
    json[q.key] = NumberOrNull(run.*q.value);
  return json;
}

OrderedJson RunJson(const ContinuedRun& run) {
  OrderedJson json = QuantitiesOf(run);
  json["ending"] = Name(run.ending);
  json["fault"] = Name(run.fault);
  json["cobot_stop"] = Name(run.cobot_stop);
  json["duration_s"] = run.duration;
  return json;
}

OrderedJson ArmJson(const OperatorDraw& person) {
  const ArmImpedance& arm = person.arm;
  return {{"stiffness_n_m", {arm.stiffness[0], arm.stiffness[1], arm.stiffness[2]}},
          {"damping_ratio", arm.damping_ratio},
          {"mass_kg", arm.mass},
          {"reflex_gain", arm.reflex_gain},
          {"reflex_delay_s", arm.reflex_delay},
          {"stiffening", person.stiffening}};
}

OrderedJson TypeOf(const OrderedJson& type, const std::string& meaning) {
  return {{"type", type}, {"description", meaning}};
}

OrderedJson ObjectOf(const OrderedJson& properties, const std::string& meaning) {
  OrderedJson required = OrderedJson::array();
  for (const auto& [key, value] : properties.items()) required.push_back(key);
  return {{"type", "object"},
          {"description", meaning},
          {"required", std::move(required)},
          {"properties", properties}};
}

OrderedJson ListSchemaOf(const OrderedJson& items, const std::string& meaning) {
  return {{"type", "array"}, {"description", meaning}, {"items", items}};
}

OrderedJson RunProperties() {
  OrderedJson json = OrderedJson::object();
  for (const ContinuationQuantity& q : kContinuationQuantities)
    json[q.key] = TypeOf({"number", "null"}, std::string(q.label) + ", SI");
  json["ending"] = TypeOf("string", "settles, stays_above, diverges, cobot_stops or fault");
  json["fault"] = TypeOf("string", "cause of another stop of the emulator");
  json["cobot_stop"] = TypeOf("string", "function by which the cobot stopped itself");
  json["duration_s"] = TypeOf("number", "from the stop to the end [s]");
  return json;
}

OrderedJson IntervalSchema() {
  const OrderedJson bound =
      ObjectOf({{"value", TypeOf({"number", "null"}, "quantile over the draws, SI")},
                {"at_least", TypeOf("boolean", "the value is only a lower bound")}},
               "one quantile");
  OrderedJson json = OrderedJson::object();
  for (const ContinuationQuantity& q : kContinuationQuantities)
    json[q.key] =
        ObjectOf({{"p5", bound}, {"median", bound}, {"p95", bound}}, std::string(q.label) + ", SI");
  return json;
}

}  // namespace

std::string ContinuationJson(const Continuation& c, const std::string& recording) {
  OrderedJson json = {{"recording", recording},
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
  json["simulated_operator"] = c.reference ? RunJson(*c.reference) : OrderedJson(nullptr);
  json["draws"] = OrderedJson::array();
  for (const ContinuedRun& run : c.runs) {
    OrderedJson draw = RunJson(run);
    draw["operator"] = ArmJson(run.person);
    json["draws"].push_back(std::move(draw));
  }
  json["assumptions"] = ContinuationAssumptions(c);
  return json.dump(2) + "\n";
}

std::string ContinuationSchema() {
  OrderedJson draw = RunProperties(), endings = OrderedJson::object();
  draw["operator"] = TypeOf("object", "the possible operator: impedance of the arm");
  for (int k = 0; k < kEndings; ++k)
    endings[Name(static_cast<Ending>(k))] = TypeOf("integer", "number of draws");
  OrderedJson reference = ObjectOf(RunProperties(), "what the simulated operator would have done");
  reference["type"] = {"object", "null"};
  const OrderedJson text = TypeOf("string", "a sentence");
  OrderedJson schema = ObjectOf(
      {{"recording", TypeOf("string", "file")},
       {"scenario", TypeOf("string", "name of the scenario")},
       {"operator", TypeOf("string", "virtual, browser or person")},
       {"stop", ObjectOf({{"cause", TypeOf("string", "cause of the stop")},
                          {"hand", TypeOf("integer", "0 left, 1 right, -1 neither")},
                          {"value", TypeOf("number", "value that exceeded the limit, SI")},
                          {"limit", TypeOf("number", "limit, SI")},
                          {"time_s", TypeOf("number", "time of the run [s]")},
                          {"largest_force_n",
                           TypeOf("number", "largest force of a hand up to the stop [N]")}},
                         "the stop that was left out")},
       {"horizon_s", TypeOf("number", "time after the stop [s]")},
       {"arm", TypeOf("string", "source of the arm's impedance")},
       {"predicted", ObjectOf(IntervalSchema(), "quantiles over the draws")},
       {"endings", ObjectOf(endings, "how the draws ended")},
       {"joint_use_missing", TypeOf("string", "why joint_use is null; empty: it is known")},
       {"simulated_operator", reference},
       {"draws", ListSchemaOf(ObjectOf(draw, "one possible operator"), "all draws")},
       {"assumptions", ListSchemaOf(text, "what was assumed")}},
      "What would have happened if PREDICTOR had not stopped a run");
  schema["$schema"] = "http://json-schema.org/draft-07/schema#";
  return schema.dump(2) + "\n";
}

}  // namespace predictor
