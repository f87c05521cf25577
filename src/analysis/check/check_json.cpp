// Writes the report of a check as JSON, and its schema.
#include <complex>
#include <nlohmann/json.hpp>
#include <utility>

#include "analysis/check/check.h"
#include "core/json_schema.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

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
    arm["joint_margin_rad"]["joint"] = report.JointName(h, r.joint_margin.joint);
    arm["joint_speed_share"]["joint"] = report.JointName(h, r.joint_speed.joint);
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

Json ToJson(const LinkGap& gap) { return {{"link", gap.link}, {"clearance_m", gap.distance}}; }

const char* WordOf(PairState state) {
  switch (state) {
    case PairState::kCanTouch:
      return "can_touch";
    case PairState::kOverlaps:
      return "overlap";
    case PairState::kJoint:
      return "joint";
    case PairState::kOneBody:
      return "one_body";
    case PairState::kHolds:
      return "holds";
  }
  return "";
}

Json ToJson(const ContactPair& pair) {
  const bool has_gap = pair.state == PairState::kCanTouch || pair.state == PairState::kOverlaps;
  return {{"link", pair.link},
          {"other", pair.other},
          {"state", WordOf(pair.state)},
          {"gap_m", has_gap ? Json(pair.distance) : Json(nullptr)}};
}

Json ToJson(const StartReport& start) {
  Json pairs = Json::array();
  for (const ContactPair& pair : start.pairs) pairs.push_back(ToJson(pair));
  return {{"flange_m", ToJson(start.flange)},
          {"last_link_direction", ToJson(start.outward)},
          {"object_is_outside", start.is_outside},
          {"nearest_link", ToJson(start.gaps.links)},
          {"nearest_link_of_hand", ToJson(start.gaps.hand)},
          {"contact_pairs", pairs},
          {"keep_out", start.keep_out},
          {"floor_force_n", start.support.floor},
          {"other_support_n", start.support.other}};
}

Json ToJson(const FeltImpedance& felt) {
  const auto complex = [](const std::complex<double>& z) -> Json {
    return {{"real_n_m", NumberOrNull(z.real())}, {"imaginary_n_m", NumberOrNull(z.imag())}};
  };
  return {{"requested", complex(felt.requested)}, {"rendered", complex(felt.rendered)}};
}

Json ToJson(const std::optional<AddedMass>& added) {
  if (!added) return nullptr;
  return {{"mass_kg", added->mass}, {"stable", added->stable}, {"at_5_hz", ToJson(added->moving)}};
}

// Returns the numbers of the surfaces of one kind.
std::vector<std::size_t> NumbersOf(const ContactReport& r, Surface::Kind kind) {
  std::vector<std::size_t> numbers;
  for (const Surface& surface : r.surfaces)
    if (surface.kind == kind) numbers.push_back(surface.number);
  return numbers;
}

Json ToJson(const ContactReport& r) {
  Json json = {{"fixtures", NumbersOf(r, Surface::Kind::kFixture)},
               {"touches_table", !NumbersOf(r, Surface::Kind::kTable).empty()},
               {"touches_floor", !NumbersOf(r, Surface::Kind::kFloor).empty()},
               {"movable_objects", NumbersOf(r, Surface::Kind::kMovable)},
               {"normal", ToJson(r.wall.normal)},
               {"stiffness_n_m", r.wall.stiffness},
               {"damping_ns_m", r.wall.damping},
               {"yields", r.yields},
               {"touched_at_start", r.at_start},
               {"stable", r.stable},
               {"largest_stable_stiffness_n_m", nullptr},
               {"oscillation_hz", nullptr},
               {"at_rest", ToJson(r.at_rest)},
               {"at_5_hz", ToJson(r.moving)},
               {"pushed", ToJson(r.pushed)},
               {"held", ToJson(r.held)}};
  if (r.limit.reached) {
    json["largest_stable_stiffness_n_m"] = r.limit.stiffness;
    json["oscillation_hz"] = r.limit.frequency;
  }
  for (const FeltAt& at : r.spectrum) {
    Json felt = {{"frequency_hz", at.frequency}};
    felt.update(ToJson(at.felt));
    json["impedance"].push_back(felt);
  }
  return json;
}

// ---- schema ------------------------------------------------------------------------------------

const schema::Words kWords = {
    {{"scenario", "name of the scenario"},
     {"fit", "the scenario passes"},
     {"problems", "reasons for a failure, each with its remedy"},
     {"warnings", "what else should be changed"},
     {"models", "what was read from the models, and the equilibrium at the start"},
     {"cobot", "the virtual cobot"},
     {"object", "the object; sag: from the set-point to the equilibrium, axes of W"},
     {"static_torque", "the cobot's joint that is nearest to its limit at rest"},
     {"value_nm", "torque [N·m]"},
     {"limit_nm", "its limit [N·m]; null: none"},
     {"value_n", "force of a prismatic joint [N]"},
     {"limit_n", "its limit [N]; null: none"},
     {"controller", "the loop of cobot and controller at the controller's rate, without hands"},
     {"growth_rate",
      "of the oscillation that grows fastest [1/s]; negative: it decays; null: none"},
     {"start", "cobot and object at the start, at rest"},
     {"flange_m", "origin of the end-effector in W [m]"},
     {"last_link_direction", "unit vector from the last joint to the end-effector, axes of W"},
     {"object_is_outside", "the object is on that side of the end-effector"},
     {"nearest_link", "the cobot's link that is nearest to the object, except those of its hand"},
     {"nearest_link_of_hand", "the link of the cobot's hand that is nearest to the object"},
     {"link", "name of the link; empty: none is within 2 m"},
     {"clearance_m", "distance, at most 2 m; negative: depth of the overlap [m]"},
     {"contact_pairs",
      "the pairs of bodies that cobot.touches concerns; empty if cobot.touches is empty"},
     {"keep_out", "numbers of the fixtures that are keep-out volumes; empty: none"},
     {"other", "name of another link; empty: the carried object"},
     {"state",
      "can_touch, or why no contact acts: overlap (they overlap, or are less than 1 mm apart, at "
      "cobot.posture), joint (a joint connects "
      "them), one_body (rigidly connected) or holds (the link belongs to the hand that holds the "
      "object)"},
     {"gap_m",
      "distance of the two at the start, at most 2 m; negative: depth of the overlap [m]; null: "
      "they always touch"},
     {"floor_force_n", "vertical force of the floor on the object [N]"},
     {"other_support_n", "vertical force of table and fixtures on the object [N]"},
     {"arms", "the haptic arms; null: absent"},
     {"joints", "number of joints"},
     {"mass_kg", "mass [kg]"},
     {"handle_mass_kg", "mass of the handle [kg]"},
     {"sag_m", "displacement by the weight [m]"},
     {"position_m", "position in W [m]"},
     {"reach", "worst figures over the operator's path; null: no arms"},
     {"comfort", "smallest ratio of a figure to its comfortable value; below 0: out of reach"},
     {"out_of_reach_s", "from this time on, the arm cannot reach its handle [s]; null: it can"},
     {"reached_share", "share of the path before that time; the figures are those of this part"},
     {"singular_value_m", "smallest singular value of the handle's Jacobian [m]"},
     {"joint_margin_rad", "smallest distance to a position limit [rad]"},
     {"joint_speed_share", "largest share of the allowed speed; null: a joint may not move at all"},
     {"handle_speed_m_s", "largest speed of the handle [m/s]"},
     {"handle_rotation_rad_s", "largest angular speed of the handle [rad/s]"},
     {"value", "the worst value"},
     {"time_s", "when it occurs [s]"},
     {"joint", "name of the joint"},
     {"link_pairs", "the monitored pairs of links"},
     {"links", "names of the links"},
     {"distance_m", "smallest distance [m]"},
     {"proposal", "better bases of the arms, or a better place of the scene; null: none sought"},
     {"base_xyz_m", "positions of the bases [m]"},
     {"shift", "value for environment.shift"},
     {"xyz_m", "[m]"},
     {"yaw_rad", "rotation about the vertical [rad]"},
     {"stop", "a stop of the arms; null: no arms"},
     {"handle_speed", "speed from which the handles stop [m/s]"},
     {"time", "longest time of the stop [s]"},
     {"way", "longest distance of the stop [m]"},
     {"longest_time", "the same, with a joint at its speed limit [s]"},
     {"longest_way", "the same, with a joint at its speed limit [m]"},
     {"stability", "prediction of the haptic loop without contact; null: no arms"},
     {"lag_s", "lag of the arms [s]"},
     {"lead_s", "lead of the run [s]"},
     {"lead_withheld", "no lead, because the loop of a real arm has not been measured"},
     {"margin", "stability margin with the lead"},
     {"margin_without_lead", "stability margin without lead"},
     {"margin_full_lead", "stability margin with a lead equal to the lag"},
     {"gain", "factor by which the hands' impedance may grow"},
     {"table", "margins for other hands"},
     {"contacts",
      "predictions for contact of the object with its surroundings, one for each kind and side; "
      "empty: nothing can touch the object"},
     {"link_contacts",
      "keys that let the cobot's links touch something; such contacts are not predicted"},
     {"fixtures", "numbers of the fixtures"},
     {"touches_table", "environment.table is one of the touched bodies"},
     {"touches_floor", "the virtual floor is one of the touched bodies"},
     {"movable_objects", "number of the movable object, which counts as one that cannot move"},
     {"pushed",
      "the loop if the object pushes this movable object and nothing else stops it; null: no "
      "movable object"},
     {"held",
      "the loop while the object holds this movable object; null: no event pick_up names it"},
     {"normal", "unit vector out of the touched body, axes of W"},
     {"stiffness_n_m", "stiffness [N/m]; of a contact: at each point, as simulated"},
     {"damping_ns_m", "damping at each point, as simulated [N·s/m]"},
     {"yields", "the scenario gives a stiffness of the fixtures; false: the engine's own contact"},
     {"touched_at_start",
      "the object touches it at the start; stable, at_rest, at_5_hz and impedance are then those "
      "of "
      "this contact with all its points"},
     {"stable", "the loop is stable (of a contact: the haptic loop in contact)"},
     {"largest_stable_stiffness_n_m",
      "largest stiffness of such a wall for which the loop is stable [N/m], without damping if "
      "the scenario gives no stiffness; null: 1e6 or more"},
     {"oscillation_hz", "frequency at which the loop oscillates against a stiffer wall [Hz]"},
     {"at_rest", "what the hands feel at rest"},
     {"at_5_hz", "what the hands feel at 5 Hz"},
     {"impedance", "what the hands feel from 0.1 to 40 Hz"},
     {"frequency_hz", "frequency [Hz]"},
     {"requested", "force over displacement in the virtual world"},
     {"rendered", "force over displacement that the arms render"},
     {"real_n_m", "real part: a stiffness [N/m]"},
     {"imaginary_n_m", "imaginary part: 2π·frequency times a damping [N/m]"}},
    {"left", "right", "reach", "stop", "stability", "out_of_reach_s", "growth_rate", "gap_m",
     "pushed", "held"}};

// Returns an example of a report that contains every member.
CheckReport Example() {
  CheckReport report;
  report.models.torque_joint = "joint";
  Reach reach;
  for (std::size_t h = 0; h < kHands; ++h) {
    report.models.arms[h].emplace();
    reach.arms[h].emplace();
    reach.arms[h]->lost = 0.0;
  }
  reach.pairs = {{"links", {}}};
  report.proposal.emplace().reach = reach;
  report.reach = std::move(reach);
  report.stop = report.longest_stop = StopBudget();
  report.stability.emplace();
  report.stability->masses = report.stability->stiffnesses = {1.0};
  report.stability->table.emplace_back();
  report.start.pairs.emplace_back();
  report.start.keep_out = {0};
  ContactReport contact;
  contact.surfaces = {{Surface::Kind::kFixture, 0}, {Surface::Kind::kMovable, 0}};
  contact.pushed.emplace();
  contact.held.emplace();
  contact.spectrum.emplace_back();
  report.contacts = {contact};
  report.link_contacts = {""};
  report.problems = report.warnings = {""};
  return report;
}

Json SchemaOf(const CheckReport& example) {
  return schema::FromExample(Json::parse(CheckJson(example)), kWords);
}

}  // namespace

std::string CheckJson(const CheckReport& report) {
  Json json = {{"scenario", report.scenario},
               {"fit", report.fit()},
               {"problems", report.problems},
               {"warnings", report.warnings},
               {"models", ToJson(report.models)}};
  json["start"] = ToJson(report.start);
  json["controller"] = {{"stable", report.controller.is_stable()},
                        {"joint", report.controller_joint},
                        {"growth_rate", NumberOrNull(report.controller.growth)},
                        {"frequency_hz", report.controller.frequency}};
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
  json["link_contacts"] = report.link_contacts;
  return json.dump(2) + "\n";
}

std::string CheckSchema() {
  CheckReport example = Example();
  Json schema = SchemaOf(example);
  Json& properties = schema["properties"];
  // Some members have two forms. This example contains the second form of these members.
  example.models.torque_is_force = true;
  example.shift_proposal.emplace().reach = *example.reach;
  example.proposal.reset();
  const Json other = SchemaOf(example)["properties"];
  const auto either = [&](Json* is, const Json& second, bool can_miss) {
    Json both = {{"anyOf", {*is, second}}};
    if (is->contains("description")) both["description"] = (*is)["description"];
    if (can_miss) both["anyOf"].push_back({{"type", "null"}});
    *is = both;
  };
  either(&properties["proposal"], other["proposal"], true);
  either(&properties["models"]["properties"]["static_torque"],
         other["models"]["properties"]["static_torque"], false);
  schema["description"] = "What predictor check predicts about a scenario";
  schema["$schema"] = schema::kDraft;
  return schema.dump(2) + "\n";
}

}  // namespace predictor
