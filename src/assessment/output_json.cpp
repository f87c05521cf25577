#include <cmath>
#include <nlohmann/json.hpp>

#include "assessment/output.h"
#include "assessment/safety/output.h"

namespace predictor::assessment {
namespace {

using Json = nlohmann::ordered_json;

Json Number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json ToJson(const std::optional<person::Interval>& range) {
  if (!range) return nullptr;
  return {Number(range->low), Number(range->high)};
}

Json ToJson(const QuantityResult& q) {
  return {{"unit", q.kind->unit.si},
          {"origin", Name(q.kind->origin)},
          {"mean", Number(q.mean)},
          {"p5", Number(q.p5)},
          {"p95", Number(q.p95)},
          {"min", Number(q.min)},
          {"max", Number(q.max)},
          {"bad", q.kind->bad == Bad::kHigh ? "high" : "low"},
          {"mean_interval_90", ToJson(q.mean_interval)},
          {"tail_interval_90", ToJson(q.tail_interval)}};
}

Json ToJson(const WorksheetResult& w) {
  Json classes = Json::array();
  for (std::size_t score = 1; score < w.share.size(); ++score)
    classes.push_back(
        {{"score", score},
         {"share_of_time", w.share[score]},
         {"probability", w.probability.empty() ? Json(nullptr) : Json(w.probability[score])}});
  return {{"origin", Name(Origin::kStandard)},
          {"worst", w.worst},
          {"p95", w.p95},
          {"action", w.kind->action(w.p95).sentence},
          {"classes", classes}};
}

Json ToJson(const ergonomics::HandPlace& place) {
  return {{"horizontal_m", place.horizontal},
          {"height_m", place.height},
          {"asymmetry_rad", place.asymmetry}};
}

Json ToJson(const Lift& lift) {
  return {
      {"origin_of_number", Name(Origin::kStandard)},
      {"begin_s", lift.begin},
      {"end_s", lift.end},
      {"one_hand", lift.one_hand},
      {"origin", ToJson(lift.origin)},
      {"destination", ToJson(lift.destination)},
      {"vertical_force_n", lift.vertical_force},
      {"adapted_lifting_index", lift.one_hand ? Json(nullptr) : Number(lift.niosh.carried.index)},
      {"unassisted_lifting_index",
       lift.one_hand ? Json(nullptr) : Number(lift.niosh.unassisted.index)},
      {"share_that_accepts", lift.one_hand ? Json(nullptr) : Json(lift.share_that_accepts)},
      {"outside_lm_mmh", lift.acceptable.outside}};
}

Json ToJson(const DamageResult& d) {
  return {{"origin", Name(Origin::kStandard)},
          {"tool", d.tool},
          {"part", d.part},
          {"damage_per_run", d.per_run},
          {"share_of_reference_day_per_run", d.day_share},
          {"share_of_reference_day_per_shift", d.shift_share},
          {"probability_of_outcome", d.probability}};
}

Json ToJson(const FatigueResult& f) {
  return {{"origin", Name(Origin::kModelled)},
          {"joint", f.joint},
          {"mean_load", f.mean_load},
          {"capacity_at_end", f.capacity},
          {"time_to_limit_s", Number(f.time_to_limit)}};
}

template <class T>
Json ListOf(const std::vector<T>& list) {
  Json json = Json::array();
  for (const T& entry : list) json.push_back(ToJson(entry));
  return json;
}

Json ToJson(const Comparison& comparison) {
  Json json = {{"recording", comparison.b}, {"warning", comparison.warning}};
  for (const Difference& d : comparison.differences)
    json["quantities"][d.kind->path] = {
        {"tail", Number(d.a)},
        {"tail_of_other", Number(d.b)},
        {"difference_interval_90", ToJson(d.interval)},
        {"share_better", d.share_better ? Json(*d.share_better) : Json(nullptr)}};
  return json;
}

Json PersonOf(const Assessment& a) {
  const BodySpec& body = a.setup.body;
  return {{"simulated", a.operator_type == "virtual"},
          {"operator", a.operator_type},
          {"height_m", body.height},
          {"mass_kg", body.mass},
          {"sex", body.sex == Sex::kMale ? "male" : "female"},
          {"reached", a.reached},
          {"reached_by_possible_postures",
           a.sampled_times.empty() ? Json(nullptr) : Json(a.sampled_reached)},
          {"largest_miss_m", a.worst_miss}};
}

// ---- schema -----------------------------------------------------------------------------------

Json Described(const char* type, const std::string& meaning) {
  return {{"type", type}, {"description", meaning}};
}

Json OrNull(const char* type, const std::string& meaning) {
  return {{"type", {type, "null"}}, {"description", meaning}};
}

Json Members(Json properties, const std::string& meaning) {
  Json required = Json::array();
  for (const auto& [key, value] : properties.items()) required.push_back(key);
  return {{"type", "object"},
          {"description", meaning},
          {"required", std::move(required)},
          {"properties", std::move(properties)}};
}

Json ArrayOf(Json items, const std::string& meaning) {
  return {{"type", "array"}, {"description", meaning}, {"items", std::move(items)}};
}

Json QuantitySchema(const QuantityKind& kind) {
  return Members(
      {{"unit", Described("string", "SI unit")},
       {"origin", Described("string", "measured, modelled or standard")},
       {"mean", OrNull("number", "over time, of the nominal posture")},
       {"p5", OrNull("number", "5th percentile over time")},
       {"p95", OrNull("number", "95th percentile over time")},
       {"min", OrNull("number", "smallest value")},
       {"max", OrNull("number", "largest value")},
       {"bad", Described("string", "whether high or low values are bad")},
       {"mean_interval_90", OrNull("array", "90 % interval of the mean")},
       {"tail_interval_90", OrNull("array", "90 % interval of p95, or of p5 if low is bad")}},
      WithUnit(std::string(kind.group) + ", " + kind.label, {kind.unit.si, kind.unit.si}));
}

Json WorksheetSchema(const WorksheetKind& kind) {
  const Json classes =
      Members({{"score", Described("integer", "score")},
               {"share_of_time", Described("number", "of the nominal posture, 0 … 1")},
               {"probability", OrNull("number", "mean over time, over the possible postures")}},
              "one score");
  return Members({{"origin", Described("string", "standard")},
                  {"worst", Described("integer", "highest score")},
                  {"p95", Described("integer", "95th percentile over time")},
                  {"action", Described("string", "what the method advises for it")},
                  {"classes", ArrayOf(classes, "each possible score")}},
                 kind.name);
}

Json ListSchema(const char* meaning, const Json& example) {
  Json properties = Json::object();
  for (const auto& [key, value] : example.items())
    properties[key] = {{"type", value.is_object()    ? Json("object")
                                : value.is_string()  ? Json("string")
                                : value.is_boolean() ? Json("boolean")
                                                     : Json({"number", "null"})}};
  return ArrayOf(Members(properties, "one entry"), meaning);
}

}  // namespace

std::string AssessmentJson(const Assessment& a, const Comparison* comparison) {
  Json json = {{"recording", a.recording},
               {"scenario", a.scenario},
               {"duration_s", a.duration},
               {"held_s", a.held},
               {"person", PersonOf(a)}};
  for (const QuantityResult& q : a.quantities) json["quantities"][q.kind->path] = ToJson(q);
  for (const WorksheetResult& w : a.worksheets) json["worksheets"][w.kind->name] = ToJson(w);
  json["lifts"] = ListOf(a.lifts);
  json["damage"] = ListOf(a.damage);
  json["fatigue"] = ListOf(a.fatigue);
  json["safety"] = a.safety ? SafetyJson(*a.safety) : Json(nullptr);
  json["warnings"] = a.warnings;
  json["assumptions"] = a.assumptions;
  json["not_evaluable"] = Json::array();
  for (const NotEvaluable& n : a.not_evaluable)
    json["not_evaluable"].push_back({{"what", n.what}, {"why", n.why}});
  json["against"] = comparison ? ToJson(*comparison) : Json(nullptr);
  return json.dump(2) + "\n";
}

std::string AssessmentSchema() {
  Json quantities = Json::object(), worksheets = Json::object();
  for (const QuantityKind& kind : Quantities()) quantities[kind.path] = QuantitySchema(kind);
  for (const WorksheetKind& kind : Worksheets()) worksheets[kind.name] = WorksheetSchema(kind);
  const Json text = Described("string", "a sentence");
  Json schema = Members(
      {{"recording", Described("string", "file")},
       {"scenario", Described("string", "name of the scenario")},
       {"duration_s", Described("number", "simulated time [s]")},
       {"held_s",
        Described("number", "of it, while a hand held a handle; only this is judged [s]")},
       {"person",
        Members({{"simulated", Described("boolean", "whether the operator was simulated")},
                 {"operator", Described("string", "virtual, browser or person")},
                 {"height_m", Described("number", "height of the body [m]")},
                 {"mass_kg", Described("number", "mass of the body [kg]")},
                 {"sex", Described("string", "female or male")},
                 {"reached", Described("number",
                                       "share of time in which the body reaches the "
                                       "handles, 0 … 1")},
                 {"reached_by_possible_postures", OrNull("number", "the same over all of them")},
                 {"largest_miss_m", Described("number", "distance that is missing [m]")}},
                "the person")},
       {"quantities", Members(quantities, "values over time")},
       {"worksheets", Members(worksheets, "scores of observers' worksheets")},
       {"lifts", ListSchema("lifts of the run", ToJson(Lift{}))},
       {"damage", ListSchema("cumulative damage", ToJson(DamageResult{}))},
       {"fatigue", ListSchema("fatigue of joints", ToJson(FatigueResult{}))},
       {"safety", SafetySchema()},
       {"warnings", ArrayOf(text, "doubtful input")},
       {"assumptions", ArrayOf(text, "what was assumed")},
       {"not_evaluable",
        ArrayOf(Members({{"what", text}, {"why", text}}, "one gap"), "what could not be judged")},
       {"against", OrNull("object",
                          "tails of another recording, and the differences for "
                          "the same possible persons")}},
      "The assessment of the person in a run of PREDICTOR");
  schema["$schema"] = "http://json-schema.org/draft-07/schema#";
  return schema.dump(2) + "\n";
}

}  // namespace predictor::assessment
