// Writes the result of an identification as text for the user, and as JSON.
#include <nlohmann/json.hpp>

#include "analysis/identify/identify.h"
#include "core/format.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, kInertiaModels> kModelWords = {
    "fixed: the links are as in their model",
    "regularised: the links can differ from their model by the assumed uncertainty",
    "base: nothing is assumed about the links"};

void AddJoint(const JointIdentification& j, std::string* text) {
  if (!j.identified()) return AppendLine(text, "  %-16s not identified", j.name.c_str());
  const auto mark = [](const Estimate& e) { return IsWide(e) ? "wide" : ""; };
  AppendLine(text, "  %-16s %8.3f ± %-7.3f %-4s %8.3f ± %-7.3f %-4s %6.1f / %-6.1f %10.3f",
             j.name.c_str(), j.viscous.value, j.viscous.half_width, mark(j.viscous),
             j.coulomb.value, j.coulomb.half_width, mark(j.coulomb), j.moving[0], j.moving[1],
             j.held_out);
}

void AddLoad(const LoadIdentification& load, std::string* text) {
  if (!load.identified()) return AppendLine(text, "Load: not identified. %s", load.refusal.c_str());
  AppendLine(text, "Load: %.3f ± %.3f kg (scenario: %.3f kg), centre of gravity in O",
             load.mass.value, load.mass.half_width, load.nominal_mass);
  for (std::size_t i = 0; i < 3; ++i) {
    AppendLine(text, "  %c  %7.1f ± %.1f mm (scenario: %.1f mm)", "xyz"[i], 1e3 * load.com[i].value,
               1e3 * load.com[i].half_width, 1e3 * load.nominal_com[static_cast<Eigen::Index>(i)]);
  }
}

void AddModels(const Identification& r, std::string* text) {
  AppendLine(text, "Inertia of the links: %s.", kModelWords[static_cast<std::size_t>(r.model)]);
  for (std::size_t k = 0; k < kInertiaModels; ++k) {
    const ModelScore& s = r.scores[k];
    AppendLine(text, "  %-12s predicts left-out blocks within %.4f N·m rms; loss %+.3f ± %.3f",
               kInertiaModelNames[k], s.held_out, s.excess, s.excess_error);
  }
  AppendLine(text,
             "  (robust loss per row, relative to the regularised model, ± standard error; another "
             "model is used only if it is better by more than two standard errors)");
  AppendLine(text, "  the links differ from their model by an estimated %.2f standard deviations%s",
             r.strain, r.strained ? ": MORE than assumed" : "");
  AppendLine(text, "  %d base parameters of links and load; condition number with friction %.0f",
             r.base_parameters, r.condition);
}

Json JsonOf(const Estimate& e) {
  return {{"value", e.value}, {"half_width_95", e.half_width}, {"wide", IsWide(e)}};
}

Json JsonOf(const JointIdentification& j) {
  Json json = {{"name", j.name},
               {"refusal", j.identified() ? Json(nullptr) : Json(j.refusal)},
               {"moving_s", {{"back", j.moving[0]}, {"forth", j.moving[1]}}},
               {"speed_rad_s", {{"p10", j.slow}, {"p90", j.fast}}},
               {"held_out_rms_nm", j.held_out}};
  if (!j.identified()) return json;
  json["viscous_nms_rad"] = JsonOf(j.viscous);
  json["coulomb_nm"] = JsonOf(j.coulomb);
  return json;
}

Json JsonOf(const LoadIdentification& load) {
  if (!load.identified()) return {{"refusal", load.refusal}};
  return {{"refusal", nullptr},
          {"mass_kg", JsonOf(load.mass)},
          {"center_of_gravity_m", {JsonOf(load.com[0]), JsonOf(load.com[1]), JsonOf(load.com[2])}}};
}

}  // namespace

std::string IdentificationText(const Identification& r) {
  std::string text;
  AppendLine(&text, "Joint friction, from %.0f s of motion; ± is half the 95 %% interval",
             r.duration);
  if (r.not_finite > 0)
    AppendLine(&text, "OMITTED: %llu ticks of the recording with values that are not finite",
               static_cast<unsigned long long>(r.not_finite));
  AppendLine(&text, "  %-16s %-25s %-25s %-15s %s", "", "  viscous [N·m·s/rad]",
             "    Coulomb [N·m]", "back / forth [s]", "held out [N·m]");
  for (const JointIdentification& j : r.joints) AddJoint(j, &text);
  for (const JointIdentification& j : r.joints)
    if (!j.identified()) AppendLine(&text, "Not identified: %s", j.refusal.c_str());
  AddLoad(r.load, &text);
  AddModels(r, &text);
  return text;
}

std::string IdentificationJson(const Identification& r) {
  Json json = {{"duration_s", r.duration},
               {"not_finite_ticks", r.not_finite},
               {"complete", r.complete()},
               {"joints", Json::array()}};
  for (const JointIdentification& j : r.joints) json["joints"].push_back(JsonOf(j));
  json["load"] = JsonOf(r.load);
  json["inertia"] = {{"model", kInertiaModelNames[static_cast<std::size_t>(r.model)]},
                     {"base_parameters", r.base_parameters},
                     {"condition", r.condition},
                     {"strain", r.strain},
                     {"strained", r.strained},
                     {"scores", Json::object()}};
  for (std::size_t k = 0; k < kInertiaModels; ++k) {
    const ModelScore& s = r.scores[k];
    json["inertia"]["scores"][kInertiaModelNames[k]] = {{"held_out_rms_nm", s.held_out},
                                                        {"excess_loss", s.excess},
                                                        {"excess_loss_error", s.excess_error}};
  }
  return json.dump(2) + "\n";
}

}  // namespace predictor
