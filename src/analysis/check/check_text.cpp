// Writes the report of a check as text for the user, and as JSON.
#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>

#include "analysis/check/check.h"
#include "core/format.h"
#include "core/json_schema.h"
#include "core/text.h"
#include "core/units.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

std::string JointName(const CheckReport& report, std::size_t h, int joint) {
  return joint < 0 ? "" : report.models.arms[h]->joint_names[static_cast<std::size_t>(joint)];
}

void AddModels(const CheckReport& report, std::string* text) {
  const ModelsReport& m = report.models;
  AppendLine(text, "Models");
  AppendLine(text, "  cobot            %d joints, %.1f kg", m.cobot_joints, m.cobot_mass);
  AppendLine(text,
             "  object           %.2f kg; static equilibrium found %.0f mm below the set-point "
             "(%.0f mm to its side), %.3f m above the virtual floor",
             m.object_mass, -1e3 * m.sag.z(), 1e3 * m.sag.head<2>().norm(), m.X_WO.p.z());
  if (std::isfinite(m.torque_limit) && m.torque_limit > 0)
    AppendLine(text, "  torque at rest   at most %.0f %% of its limit (%s: %.1f of %.0f %s)",
               100 * m.torque_share, m.torque_joint.c_str(), m.torque, m.torque_limit,
               m.torque_is_force ? "N" : "N·m");
  for (std::size_t h = 0; h < kHands; ++h)
    if (m.arms[h])
      AppendLine(
          text, "  %-5s arm        %d joints, %.1f kg; handle %.2f kg, starts %.2f m from the base",
          kHandNames[h], m.arms[h]->joints, m.arms[h]->mass, m.arms[h]->payload_mass,
          m.arms[h]->reach);
}

void AddArm(const CheckReport& report, const Reach& reach, std::size_t h, std::string* text) {
  const ArmReach& r = *reach.arms[h];
  if (r.lost) {
    AppendLine(text, "  %-5s            OUT OF REACH from %.2f s (%.0f %% of the path reached)",
               kHandNames[h], *r.lost, 100 * r.reached);
    if (r.reached <= 0) return;
  }
  AppendLine(
      text,
      "  %-5s            %8.3f m  at %5.2f s   %8.2f rad at %5.2f s (%s)   %4.0f %% at %5.2f s "
      "(%s)",
      kHandNames[h], r.singular_value.value, r.singular_value.time, r.joint_margin.value,
      r.joint_margin.time, JointName(report, h, r.joint_margin.joint).c_str(),
      100 * r.joint_speed.value, r.joint_speed.time,
      JointName(report, h, r.joint_speed.joint).c_str());
}

void AddReach(const CheckReport& report, const Reach& reach, const char* title, std::string* text) {
  AppendLine(text, "%s", title);
  AppendLine(text,
             "  worst            singular value      joint margin             joint speed, share "
             "of the limit");
  for (std::size_t h = 0; h < kHands; ++h)
    if (reach.arms[h]) AddArm(report, reach, h, text);
  for (const PairReach& pair : reach.pairs)
    AppendLine(text, "  nearest links    %8.3f m  at %5.2f s   (%s; limit %.2f m)",
               pair.distance.value, pair.distance.time, pair.name.c_str(),
               report.security_distance);
  if (reach.pairs.empty()) AppendLine(text, "  nearest links    no link pairs defined");
}

void AddHandles(const Reach& reach, std::string* text) {
  for (std::size_t h = 0; h < kHands; ++h)
    if (reach.arms[h])
      AppendLine(text, "  %-5s handle     up to %.2f m/s at %.2f s, %.0f °/s at %.2f s",
                 kHandNames[h], reach.handles[h].speed.value, reach.handles[h].speed.time,
                 kDegrees * reach.handles[h].rotation_speed.value,
                 reach.handles[h].rotation_speed.time);
}

bool IsWorthIt(const CheckReport& report, double comfort) {
  constexpr double kWorthIt = 1.05;  // improvements smaller than this do not justify moving
                                     // anything
  return comfort > report.comfort + (kWorthIt - 1) * std::fabs(report.comfort);
}

void AddComfort(const CheckReport& report, double comfort, std::string* text) {
  AppendLine(text,
             "  comfort          %.2f instead of %.2f (the smallest ratio of a value to its "
             "comfortable value; below 0: out of reach)",
             comfort, report.comfort);
}

void AddProposal(const CheckReport& report, const BaseProposal& p, std::string* text) {
  AppendLine(text, "%s", "");
  if (!IsWorthIt(report, p.comfort)) {
    AppendLine(text,
               "Bases: no better positions were found nearby (comfort %.2f; 1 is comfortable).",
               report.comfort);
    return;
  }
  AddReach(report, p.reach, "Better bases", text);
  for (std::size_t h = 0; h < kHands; ++h)
    if (p.reach.arms[h])
      AppendLine(text, "  %s.base.xyz: [%.3f, %.3f, %.3f]   (now [%.3f, %.3f, %.3f])",
                 report.arm_key[h].c_str(), p.xyz[h].x(), p.xyz[h].y(), p.xyz[h].z(),
                 report.base[h].x(), report.base[h].y(), report.base[h].z());
  AddComfort(report, p.comfort, text);
}

// Returns a shift in the form that the scenario takes.
std::string ShiftText(const PoseSpec& shift) {
  return Formatted("{xyz: [%.3f, %.3f, %.3f], rpy: [0, 0, %.4g deg]}", shift.xyz.x(), shift.xyz.y(),
                   shift.xyz.z(), kDegrees * shift.rpy.z());
}

void AddProposal(const CheckReport& report, const ShiftProposal& p, std::string* text) {
  AppendLine(text, "%s", "");
  if (!IsWorthIt(report, p.comfort)) {
    AppendLine(text,
               "Scene: no better place for these arms was found (comfort %.2f; 1 is comfortable).",
               report.comfort);
    return;
  }
  AddReach(report, p.reach, "Better place of the scene", text);
  AppendLine(text, "  environment.shift: %s   (now %s)", ShiftText(p.shift).c_str(),
             ShiftText(report.shift).c_str());
  AddComfort(report, p.comfort, text);
}

void AddStability(const StabilityReport& r, std::string* text) {
  AppendLine(text, "%s", "");
  AppendLine(text,
             "Stability margin: factor by which the hands can be stiffer and heavier than in the "
             "scenario; 2 is required");
  AppendLine(text, "  lead %.1f ms (%s)   %.1f, would oscillate at %.1f Hz", 1e3 * r.lead,
             r.withheld ? "none, because an arm's loop was not measured"
             : r.chosen ? "chosen"
                        : "set in the scenario",
             r.margin.gain, r.margin.frequency);
  AppendLine(text, "  without lead          %.1f", r.without_lead.gain);
  AppendLine(text, "  full lead, %.1f ms    %.1f", 1e3 * r.lag, r.full_lead.gain);
  AppendLine(text, "  at %.1f ms, for hands of   stiffness [N/m]", 1e3 * r.lead);
  *text += "    mass [kg]  ";
  for (const double k : r.stiffnesses) Append(text, "%8.0f", k);
  *text += '\n';
  for (std::size_t i = 0; i < r.masses.size(); ++i) {
    Append(text, "    %-11.1f", r.masses[i]);
    for (std::size_t j = 0; j < r.stiffnesses.size(); ++j) {
      const StabilityMargin& margin = r.table[i * r.stiffnesses.size() + j];
      Append(text, "%7.1f%c", margin.gain, Suffices(margin) ? ' ' : '!');
    }
    *text += '\n';
  }
}

// "0, 1 and 4"
std::string Numbers(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    text += (k == 0 ? "" : k + 1 == numbers.size() ? " and " : ", ") + std::to_string(numbers[k]);
  return text;
}

// The damping that an impedance at kFeltFrequency contains [N·s/m].
double DampingOf(const std::complex<double>& impedance) {
  return impedance.imag() / (2 * std::numbers::pi * kFeltFrequency);
}

void AddContact(const ContactReport& r, std::string* text) {
  const Vector3& n = r.wall.normal;
  AppendLine(text, "  %s %s, normal [%.2f, %.2f, %.2f]: %s",
             r.fixtures.size() == 1 ? "fixture" : "fixtures", Numbers(r.fixtures).c_str(), n.x(),
             n.y(), n.z(), r.stable ? "stable" : "UNSTABLE");
  if (!r.yields) return;
  AppendLine(text, "    stiffness        %.3g N/m at each point", r.wall.stiffness);
  if (r.limit.reached)
    AppendLine(text, "    stable up to     %.3g N/m in all, then oscillates at %.1f Hz",
               r.limit.stiffness, r.limit.frequency);
  else
    AppendLine(text, "    stable up to     more than %.3g N/m", kStiffestWall);
  AppendLine(text, "    felt at rest     %.3g N/m of %.3g", r.at_rest.rendered.real(),
             r.at_rest.requested.real());
  AppendLine(text, "    felt at %.0f Hz     %.3g N/m of %.3g, %.3g N·s/m of %.3g%s", kFeltFrequency,
             r.moving.rendered.real(), r.moving.requested.real(), DampingOf(r.moving.rendered),
             DampingOf(r.moving.requested),
             r.moving.rendered.imag() < 0 ? " (the arms' lag feeds energy in)" : "");
}

void AddContacts(const CheckReport& report, std::string* text) {
  AppendLine(text,
             "\n"
             "Contact: what the hands feel while the object touches a fixture, at one point");
  for (const ContactReport& contact : report.contacts) AddContact(contact, text);
}

// ---- JSON --------------------------------------------------------------------------------------

Json ToJson(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
Json ToJson(const Extreme& e) { return {{"value", NumberOrNull(e.value)}, {"time_s", e.time}}; }
Json ToJson(const StabilityMargin& m) { return {{"gain", m.gain}, {"frequency_hz", m.frequency}}; }

Json ToJson(const ModelsReport& m) {
  Json json = {
      {"cobot", {{"joints", m.cobot_joints}, {"mass_kg", m.cobot_mass}}},
      {"object",
       {{"mass_kg", m.object_mass}, {"sag_m", ToJson(m.sag)}, {"position_m", ToJson(m.X_WO.p)}}},
      {"static_torque",
       {{"joint", m.torque_joint},
        {m.torque_is_force ? "value_n" : "value_nm", m.torque},
        {m.torque_is_force ? "limit_n" : "limit_nm", NumberOrNull(m.torque_limit)}}}};
  for (std::size_t h = 0; h < kHands; ++h) {
    json["arms"][kHandNames[h]] = nullptr;
    if (m.arms[h])
      json["arms"][kHandNames[h]] = {{"joints", m.arms[h]->joints},
                                     {"mass_kg", m.arms[h]->mass},
                                     {"handle_mass_kg", m.arms[h]->payload_mass}};
  }
  return json;
}

Json ToJson(const CheckReport& report, const Reach& reach, double comfort) {
  Json json = {{"comfort", NumberOrNull(comfort)}};
  for (std::size_t h = 0; h < kHands; ++h) {
    json[kHandNames[h]] = nullptr;
    if (!reach.arms[h]) continue;
    const ArmReach& r = *reach.arms[h];
    Json arm = {{"out_of_reach_s", r.lost ? Json(*r.lost) : Json(nullptr)},
                {"reached_share", r.reached},
                {"singular_value_m", ToJson(r.singular_value)},
                {"joint_margin_rad", ToJson(r.joint_margin)},
                {"joint_speed_share", ToJson(r.joint_speed)},
                {"handle_speed_m_s", ToJson(reach.handles[h].speed)},
                {"handle_rotation_rad_s", ToJson(reach.handles[h].rotation_speed)}};
    arm["joint_margin_rad"]["joint"] = JointName(report, h, r.joint_margin.joint);
    arm["joint_speed_share"]["joint"] = JointName(report, h, r.joint_speed.joint);
    json[kHandNames[h]] = arm;
  }
  json["link_pairs"] = Json::array();
  for (const PairReach& pair : reach.pairs)
    json["link_pairs"].push_back({{"links", pair.name}, {"distance_m", ToJson(pair.distance)}});
  return json;
}

Json ToJson(const CheckReport& report, const BaseProposal& p) {
  Json json;
  for (std::size_t h = 0; h < kHands; ++h)
    json["base_xyz_m"][kHandNames[h]] = p.reach.arms[h] ? ToJson(p.xyz[h]) : Json(nullptr);
  json["reach"] = ToJson(report, p.reach, p.comfort);
  return json;
}

Json ToJson(const CheckReport& report, const ShiftProposal& p) {
  return {{"shift", {{"xyz_m", ToJson(p.shift.xyz)}, {"yaw_rad", p.shift.rpy.z()}}},
          {"reach", ToJson(report, p.reach, p.comfort)}};
}

Json ToJson(const StabilityReport& r) {
  Json json = {{"lag_s", r.lag},
               {"lead_s", r.lead},
               {"lead_withheld", r.withheld},
               {"margin", ToJson(r.margin)},
               {"margin_without_lead", ToJson(r.without_lead)},
               {"margin_full_lead", ToJson(r.full_lead)}};
  json["table"] = Json::array();
  for (std::size_t i = 0; i < r.table.size(); ++i) {
    Json cell = {{"mass_kg", r.masses[i / r.stiffnesses.size()]},
                 {"stiffness_n_m", r.stiffnesses[i % r.stiffnesses.size()]}};
    cell.update(ToJson(r.table[i]));
    json["table"].push_back(cell);
  }
  return json;
}

Json ToJson(const FeltImpedance& felt) {
  const auto complex = [](const std::complex<double>& z) -> Json {
    return {{"real_n_m", NumberOrNull(z.real())}, {"imaginary_n_m", NumberOrNull(z.imag())}};
  };
  return {{"requested", complex(felt.requested)}, {"rendered", complex(felt.rendered)}};
}

Json ToJson(const ContactReport& r) {
  Json json = {{"fixtures", r.fixtures},
               {"normal", ToJson(r.wall.normal)},
               {"stiffness_n_m", r.wall.stiffness},
               {"damping_ns_m", r.wall.damping},
               {"yields", r.yields},
               {"stable", r.stable},
               {"largest_stable_stiffness_n_m", nullptr},
               {"at_rest", ToJson(r.at_rest)},
               {"at_5_hz", ToJson(r.moving)}};
  if (r.yields && r.limit.reached) json["largest_stable_stiffness_n_m"] = r.limit.stiffness;
  return json;
}

void AddStop(const CheckReport& report, std::string* text) {
  AppendLine(text,
             "\n"
             "Stop from %.2f m/s, including the arms' lag: the handles are at rest",
             report.handle_speed);
  AppendLine(text, "  within %4.0f ms, after at most %.1f mm", 1e3 * report.stop->time,
             1e3 * report.stop->way);
  AppendLine(text, "  within %4.0f ms, after at most %.1f mm, if a joint moves at its speed limit",
             1e3 * report.longest_stop->time, 1e3 * report.longest_stop->way);
}

}  // namespace

std::string CheckText(const CheckReport& report) {
  std::string text;
  AppendLine(&text, "%s", Printable(report.scenario).c_str());
  AppendLine(&text, "%s", "");
  AddModels(report, &text);
  AppendLine(&text, "%s", "");
  if (report.reach) {
    AddReach(report, *report.reach, "Reach over the operator's whole path", &text);
    AddHandles(*report.reach, &text);
  } else {
    AppendLine(&text,
               "Reach, bases and stability do not apply, because in `mode: direct` the hands act "
               "on the object itself.");
  }
  if (report.proposal) AddProposal(report, *report.proposal, &text);
  if (report.shift_proposal) AddProposal(report, *report.shift_proposal, &text);
  if (report.stability) AddStability(*report.stability, &text);
  if (!report.contacts.empty()) AddContacts(report, &text);
  if (report.stop) AddStop(report, &text);
  AppendLine(&text, "%s", "");
  for (const std::string& warning : report.warnings)
    AppendLine(&text, "Warning: %s", warning.c_str());
  for (const std::string& problem : report.problems)
    AppendLine(&text, "Unfit: %s", problem.c_str());
  if (report.fit()) AppendLine(&text, "Fit.");
  return text;
}

std::string CheckJson(const CheckReport& report) {
  Json json = {{"scenario", report.scenario},
               {"fit", report.fit()},
               {"problems", report.problems},
               {"warnings", report.warnings},
               {"models", ToJson(report.models)}};
  json["reach"] = report.reach ? ToJson(report, *report.reach, report.comfort) : Json(nullptr);
  json["proposal"] = report.proposal         ? ToJson(report, *report.proposal)
                     : report.shift_proposal ? ToJson(report, *report.shift_proposal)
                                             : Json(nullptr);
  json["stop"] = report.stop ? Json{{"handle_speed", report.handle_speed},
                                    {"time", report.stop->time},
                                    {"way", report.stop->way},
                                    {"longest_time", report.longest_stop->time},
                                    {"longest_way", report.longest_stop->way}}
                             : Json(nullptr);
  json["stability"] = report.stability ? ToJson(*report.stability) : Json(nullptr);
  json["contacts"] = Json::array();
  for (const ContactReport& contact : report.contacts) json["contacts"].push_back(ToJson(contact));
  return json.dump(2) + "\n";
}

}  // namespace predictor
