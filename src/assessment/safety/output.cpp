#include "assessment/safety/output.h"

#include <algorithm>
#include <map>

#include "core/format.h"
#include "core/json_schema.h"
#include "core/text.h"
#include "core/text_table.h"

namespace predictor::assessment {
namespace {

using Json = nlohmann::ordered_json;

// Aligns numbers to the right, and names and sentences to the left.
void AppendTable(const std::vector<std::vector<std::string>>& rows, std::string* text) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c)
      widths[c] = std::max(widths[c], CharactersIn(row[c]));
  }
  for (const auto& row : rows) {
    std::string line = "  ";
    for (std::size_t c = 0; c < row.size(); ++c) {
      const bool left = c == 0 || row[c].find(' ') != std::string::npos;
      if (c > 0) line += "  ";
      line += left ? LeftAligned(row[c], widths[c]) : RightAligned(row[c], widths[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    *text += line + "\n";
  }
}

Json ToJson(const Result& result) {
  Json value = nullptr;
  if (const auto* x = std::get_if<double>(&result.value)) value = NumberOrNull(*x);
  if (const auto* n = std::get_if<std::uint64_t>(&result.value)) value = *n;
  return {{"unit", result.unit.si}, {"value", value}, {"meaning", result.meaning}};
}

Json ToJson(const StopLoad& load) {
  return {{"joint", load.joint},
          {"before_nm", NumberOrNull(load.before)},
          {"change_nm", NumberOrNull(load.change)},
          {"change_90_nm",
           load.change_90 ? Json({load.change_90->low, load.change_90->high}) : Json(nullptr)},
          {"largest_nm", NumberOrNull(load.peak)},
          {"share_of_strength", load.use ? Json(*load.use) : Json(nullptr)}};
}

Json ToJson(const StopJudgement& judged) {
  Json json = {{"time_s", judged.stop.time},
               {"cause", Name(judged.stop.cause)},
               {"duration_s", judged.stop.duration},
               {"distance_m", judged.stop.distance},
               {"joints", Json::array()}};
  for (const StopLoad& load : judged.loads) json["joints"].push_back(ToJson(load));
  return json;
}

Json ToJson(const Separation& s) {
  return {{"time_s", s.time},
          {"speed_m_per_s", s.speed},
          {"needed_m", s.needed},
          {"distance_m", s.distance}};
}

Json ToJson(const Drop& drop) {
  return {{"time_s", drop.time},
          {"height_m", drop.height},
          {"speed_m_per_s", drop.speed},
          {"energy_j", drop.energy},
          {"beside_feet_m", drop.beside_feet},
          {"weight_of_hand_n", drop.weight_of_hand},
          {"jump_n", drop.jump}};
}

Json ToJson(const RegionCheck& check) {
  return {{"region", check.limit.region},
          {"max_speed_m_per_s", check.max_speed},
          {"share", NumberOrNull(check.share)}};
}

Json ToJson(const UnintendedContact& contact) {
  Json json = {
      {"edition", contact.edition},
      {"effective_mass_kg", contact.robot_mass},
      {"time_s", contact.time},
      {"speed_m_per_s", contact.speed},
      {"transient", Json::array()},
      {"clamping_force_n", contact.clamping_force ? Json(*contact.clamping_force) : Json(nullptr)},
      {"fixtures", contact.fixtures},
      {"clamped", Json::array()}};
  for (const RegionCheck& check : contact.regions) json["transient"].push_back(ToJson(check));
  for (const RegionCheck& check : contact.clamped) json["clamped"].push_back(ToJson(check));
  return json;
}

Json ToJson(const RigLimit& limit) {
  return {{"what", limit.what},       {"unit", limit.unit.si}, {"limit", limit.limit},
          {"reached", limit.reached}, {"event", limit.event},  {"censored", limit.censored()}};
}

Json ToJson(const Margin& margin) {
  return {{"what", margin.what},
          {"unit", margin.unit.si},
          {"smallest", margin.smallest},
          {"time_s", margin.time},
          {"joint", margin.joint}};
}

// Returns the meaning of a key. A key has the same meaning at every place where it occurs.
std::string MeaningOf(const std::string& key) {
  static const std::map<std::string, std::string> kMeanings = {
      {"unit", "SI unit"},
      {"value", "the result; null: missing"},
      {"meaning", "how it was computed"},
      {"joint", "joint of an arm or of the cobot; empty: none"},
      {"before_nm", "torque when the stop was decided [N·m]"},
      {"change_nm",
       "change of the torque since then with the largest magnitude: what the stop caused; null: "
       "raised shoulder or unknown posture [N·m]"},
      {"change_90_nm", "90 % interval of that change over the possible postures [N·m]"},
      {"largest_nm", "largest magnitude of the torque since then [N·m]"},
      {"share_of_strength", "largest share of mean strength; null: no strength of this joint"},
      {"time_s", "run time [s]"},
      {"cause", "cause of the stop"},
      {"duration_s", "from the decision to rest [s]"},
      {"distance_m",
       "distance travelled by the faster handle in a stop, or distance of the person from the "
       "moving scene [m]"},
      {"joints", "each joint of the arms that held a handle"},
      {"speed_m_per_s",
       "speed [m/s]; of the scene: of the object's fastest point or of the end-effector's origin"},
      {"needed_m", "distance that a person needs [m]"},
      {"height_m", "height of the object's origin above the ground [m]"},
      {"energy_j", "energy at the ground [J]"},
      {"beside_feet_m", "horizontal distance from the feet [m]"},
      {"weight_of_hand_n", "weight that each hand would carry [N]"},
      {"jump_n", "difference from the smallest force that the hand carried in the run [N]"},
      {"region", "region of the body"},
      {"max_speed_m_per_s", "speed at which the limit is reached; 0: must not be hit [m/s]"},
      {"share", "share of the limit that the run reached; null: must not be hit"},
      {"edition", "edition of the limits"},
      {"effective_mass_kg", "effective mass of cobot and object [kg]"},
      {"transient", "each region, if it is hit and can recoil"},
      {"clamping_force_n", "bound that the scenario sets on the cobot's force; null: no bound [N]"},
      {"fixtures", "what the object or the cobot can clamp a part of the body against"},
      {"clamped", "each region, if it is clamped"},
      {"what", "subject of the margin, the limit or the gap"},
      {"why", "why it could not be judged"},
      {"smallest", "smallest value in the run, SI"},
      {"limit", "limit of what the rig renders, SI"},
      {"reached", "largest value in the run, SI"},
      {"event", "hazard that had begun last when the value was largest; empty: none"},
      {"censored", "whether the true value may have been larger"},
  };
  return kMeanings.at(key);
}

// Returns the type and the meaning of each value in an example.
Json TypesOf(const Json& example) {
  Json properties = Json::object();
  for (const auto& [key, value] : example.items()) {
    Json type = value.is_object()    ? Json("object")
                : value.is_array()   ? Json("array")
                : value.is_string()  ? Json("string")
                : value.is_boolean() ? Json("boolean")
                : value.is_null()    ? Json({"array", "number", "null"})
                                     : Json({"number", "null"});
    properties[key] = schema::Value(std::move(type), MeaningOf(key));
  }
  return {{"type", "object"}, {"properties", std::move(properties)}};
}

Json ListOf(const Json& example, const char* meaning) {
  return schema::Array(TypesOf(example), meaning);
}

Json WithMeaning(Json value, const char* meaning) {
  value["description"] = meaning;
  return value;
}

Json OrNull(Json value) {
  value["type"] = {"object", "null"};
  return value;
}

}  // namespace

std::string SafetyText(const SafetyAssessment& safety) {
  std::string text = "\nSafety of the collaboration\n";
  for (const SafetyTable& table : SafetyTables(safety)) {
    AppendLine(&text, "%s (%s)", table.title.c_str(), table.origin.c_str());
    AppendTable(table.rows, &text);
    for (const std::string& note : table.notes) AppendLine(&text, "  %s", note.c_str());
  }
  for (const NotEvaluable& gap : safety.not_evaluable)
    AppendLine(&text, "This result could not be evaluated: %s, because %s.", gap.what.c_str(),
               gap.why.c_str());
  return text;
}

Json SafetyJson(const SafetyAssessment& safety) {
  Json json = {{"measured", Json::object()}, {"stops", Json::array()}};
  for (const Result& result : safety.exposure) json["measured"][result.path] = ToJson(result);
  for (const StopJudgement& stop : safety.stops) json["stops"].push_back(ToJson(stop));
  json["separation"] = ToJson(safety.separation);
  json["drop"] = safety.drop ? ToJson(*safety.drop) : Json(nullptr);
  json["unintended_contact"] = safety.contact ? ToJson(*safety.contact) : Json(nullptr);
  json["margins"] = Json::array();
  for (const Margin& margin : safety.margins) json["margins"].push_back(ToJson(margin));
  json["rig"] = Json::array();
  for (const RigLimit& limit : safety.rig) json["rig"].push_back(ToJson(limit));
  json["not_evaluable"] = Json::array();
  for (const NotEvaluable& gap : safety.not_evaluable)
    json["not_evaluable"].push_back({{"what", gap.what}, {"why", gap.why}});
  return json;
}

Json SafetySchema() {
  Json measured = {{"type", "object"},
                   {"description", "what the hands felt, by the result's name"},
                   {"additionalProperties", TypesOf(ToJson(Result{}))}};
  return {
      {"type", {"object", "null"}},
      {"description", "the safety of the collaboration"},
      {"properties",
       {{"measured", std::move(measured)},
        {"stops", ListOf(ToJson(StopJudgement{}), "what each stop did to the joints; modelled")},
        {"separation", WithMeaning(TypesOf(ToJson(Separation{})),
                                   "required distance after letting go, by ISO 13855; standard")},
        {"drop", OrNull(WithMeaning(TypesOf(ToJson(Drop{})), "the object falls; modelled"))},
        {"unintended_contact",
         OrNull(WithMeaning(TypesOf(ToJson(UnintendedContact{})),
                            "object or cobot hits or clamps the person; standard"))},
        {"margins", ListOf(ToJson(Margin{}),
                           "how close the cobot comes to its joint limits and to singular "
                           "postures, and links of the arms to each other; modelled")},
        {"rig", ListOf(ToJson(RigLimit{}),
                       "limits of what the rig renders, and the values that the run reached")},
        {"not_evaluable", ListOf(Json{{"what", ""}, {"why", ""}}, "what could not be judged")}}}};
}

}  // namespace predictor::assessment
