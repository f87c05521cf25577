// Writes the tables and sentences that the text and the page have in common.
#include <algorithm>
#include <cmath>
#include <map>

#include "assessment/output.h"
#include "assessment/safety/output.h"
#include "core/format.h"
#include "core/text.h"
#include "core/words.h"

namespace predictor::assessment {
namespace {

std::string ValueText(const Result& result) {
  if (const auto* x = std::get_if<double>(&result.value)) return NumberText(result.unit, *x);
  if (const auto* n = std::get_if<std::uint64_t>(&result.value)) return std::to_string(*n);
  return "";
}

std::string PercentText(double share) {
  return std::isfinite(share) ? Formatted("%.0f %%", 100 * share) : "must not be hit";
}

// Returns the hand to which a result belongs, according to the path of the result ("hands.left.…"),
// or −1 if the result belongs to neither hand.
int HandOf(const Result& result) {
  for (int hand = 0; hand < kHands; ++hand)
    if (result.path.find(std::string(".") + HandName(hand) + ".") != std::string::npos) return hand;
  return -1;
}

// Returns the description of a result without the hand, for example "largest index" for "largest
// index of the left hand".
std::string LabelOf(const Result& result, int hand) {
  std::string label = result.group == "Oscillation" ? "oscillation, " + result.label : result.label;
  const std::string end = std::string(" of the ") + HandName(hand) + " hand";
  if (label.ends_with(end)) label.resize(label.size() - end.size());
  return WithUnit(label, result.unit);
}

// Returns the results of each hand side by side, followed by the results of the whole run.
SafetyTable HandTable(const std::vector<Result>& results, bool simulated) {
  SafetyTable table{.title = "What the hands felt", .origin = Name(Origin::kMeasured, simulated)};
  table.rows.push_back({"", "left", "right", "how it was computed"});
  std::map<std::string, std::size_t> row_of;
  for (const Result& result : results) {
    const int hand = HandOf(result);
    if (hand < 0) {
      table.notes.push_back(Formatted("%s: %s %s (%s).", result.group.c_str(),
                                      ValueText(result).c_str(), result.unit.shown,
                                      result.meaning.c_str()));
      continue;
    }
    const std::string label = LabelOf(result, hand);
    const auto [at, added] = row_of.emplace(label, table.rows.size());
    if (added) table.rows.push_back({label, "–", "–", result.meaning});
    table.rows[at->second][static_cast<std::size_t>(hand) + 1] = ValueText(result);
  }
  return table;
}

std::string TorqueText(double torque) {
  return std::isfinite(torque) ? Formatted("%.1f", torque) : "–";
}

SafetyTable StopTable(const StopJudgement& judged) {
  const StopSummary& stop = judged.stop;
  SafetyTable table{.title = Formatted("What the stop at %.2f s did to the joints", stop.time),
                    .origin = "modelled"};
  std::string words = "Cause of the stop: " + StopCauseText(stop.cause, stop.quantity);
  if (stop.hand >= 0) words += Formatted(" (%s hand)", HandName(stop.hand));
  words += Formatted(". The handles came to rest after %.0f ms and %.1f mm.", 1e3 * stop.duration,
                     1e3 * stop.distance);
  table.notes.push_back(words);
  if (judged.loads.empty()) {
    table.notes.emplace_back("No hand held a handle, or the stop was too short to be judged.");
    return table;
  }
  table.rows.push_back(
      {"", "before [N·m]", "caused by the stop [N·m]", "90 %", "largest [N·m]", "of strength"});
  for (const StopLoad& load : judged.loads)
    table.rows.push_back(
        {load.joint, TorqueText(load.before), TorqueText(load.change),
         load.change_90 ? Formatted("%.1f … %.1f", load.change_90->low, load.change_90->high) : "–",
         TorqueText(load.peak), load.use ? PercentText(*load.use) : "–"});
  table.notes.emplace_back(
      "The change caused by the stop is the change of the torque after the decision to stop that "
      "has the largest magnitude. The column \"90 %\" contains the 90 % interval of this change "
      "over 64 possible "
      "postures and bodies. The last column gives the largest torque as a percentage of the mean "
      "strength for the person's sex, if the program has a strength for this joint. These "
      "strengths were "
      "recalled from the literature, not verified.");
  if (std::ranges::any_of(judged.loads, [](const StopLoad& l) { return !std::isfinite(l.change); }))
    table.notes.emplace_back(
        "Not evaluable: the joints without values. The upper arm is raised above 90°, where models "
        "of the shoulder disagree with measurements, or a hand of the modelled body misses its "
        "handle by more than 5 cm.");
  return table;
}

SafetyTable LettingGoTable(const SafetyAssessment& safety) {
  SafetyTable table{.title = "If the person or the cobot lets go", .origin = "modelled"};
  if (safety.drop) {
    const Drop& drop = *safety.drop;
    table.notes.push_back(Formatted(
        "The object would fall %.2f m from its highest position (at %.1f s). The object would "
        "reach the ground with a speed of %.1f m/s and an energy of %.0f J, %s.",
        drop.height, drop.time, drop.speed, drop.energy,
        drop.beside_feet > 0
            ? Formatted("with its origin %.2f m beside the feet", drop.beside_feet).c_str()
            : "with its origin above the feet"));
    const double pulled = drop.jump - drop.weight_of_hand;  // the hand's largest force down [N]
    table.notes.push_back(Formatted(
        "If the cobot lost its force, each hand would carry %.0f N. The force of a hand would "
        "change by up to %.0f N%s.",
        drop.weight_of_hand, drop.jump,
        pulled > 0.5
            ? Formatted(", because a hand pulled down with up to %.0f N in the run", pulled).c_str()
            : ""));
  }
  const Separation& s = safety.separation;
  table.notes.push_back(Formatted(
      "At %.1f s, the fastest point of the scene moved at %.2f m/s. A person who walks towards the "
      "scene needs a distance of %.2f m (ISO 13855, without the intrusion distance of a sensor). "
      "The feet are "
      "%.2f m away%s.",
      s.time, s.speed, s.needed, s.distance,
      s.needed > s.distance ? ", which is too close to a cobot that does not detect the person"
                            : ""));
  return table;
}

// States with which force a part of the body can be clamped, and against what.
std::string ClampingWords(const UnintendedContact& contact) {
  const std::string force =
      contact.clamping_force
          ? Formatted(
                "A body part can be clamped with %.0f N, which is the scenario's bound on the "
                "cobot's force.",
                *contact.clamping_force)
          : "The force with which a body part can be clamped is unknown, because the scenario has "
            "no bound on the cobot's force (cobot.safety.force_cap), so clamping is not judged.";
  if (!contact.fixtures.empty())
    return force + " The object or the cobot can clamp a body part against: " +
           Printable(Join(contact.fixtures)) + ".";
  return force +
         " The scenario contains no floor, table or fixture, so clamping is possible only if the "
         "real workplace contains one.";
}

SafetyTable ContactTable(const UnintendedContact& contact) {
  SafetyTable table{.title = "Unintended contact", .origin = "standard"};
  table.rows.push_back({"", "fastest allowed [m/s]", "share reached"});
  if (contact.clamping_force) table.rows[0].emplace_back("share if clamped");
  for (std::size_t i = 0; i < contact.regions.size(); ++i) {
    const RegionCheck& region = contact.regions[i];
    std::vector<std::string> row = {
        region.limit.region,
        region.max_speed > 0 ? Formatted("%.2f", region.max_speed) : "must not be hit",
        PercentText(region.share)};
    if (contact.clamping_force) row.push_back(PercentText(contact.clamped[i].share));
    table.rows.push_back(std::move(row));
  }
  table.notes.push_back(Formatted(
      "This table applies to contact of the person with the fastest point of the object or with "
      "the cobot's end-effector at the largest speed of this run, %.2f m/s (at %.1f s), with an "
      "effective mass of %.1f kg. Limits: %s.",
      contact.speed, contact.time, contact.robot_mass, contact.edition.c_str()));
  table.notes.push_back(ClampingWords(contact));
  table.notes.emplace_back(
      "These limits do not apply to the forces at the handles. The numbers do not prove "
      "conformity, which requires measurements of the real application.");
  return table;
}

SafetyTable MarginTable(const std::vector<Margin>& margins) {
  SafetyTable table{.title = "Margins of the cobot and the arms", .origin = "modelled"};
  table.rows.push_back({"", "smallest", "at [s]", "joint"});
  for (const Margin& margin : margins)
    table.rows.push_back({WithUnit(margin.what, margin.unit),
                          NumberText(margin.unit, margin.smallest), Formatted("%.1f", margin.time),
                          margin.joint.empty() ? "–" : Printable(margin.joint)});
  table.notes.emplace_back(
      "Near a limit of a joint or a singular posture, the cobot cannot follow a hand in every "
      "direction, or its joints move fast.");
  return table;
}

SafetyTable RigTable(const std::vector<RigLimit>& limits, bool simulated) {
  SafetyTable table{.title = "What this rig renders", .origin = Name(Origin::kMeasured, simulated)};
  table.rows.push_back({"", "up to", "reached", "share"});
  bool censored = false;
  for (const RigLimit& limit : limits) {
    censored = censored || limit.censored();
    const Unit& unit = limit.unit;
    table.rows.push_back({WithUnit(limit.what, unit), NumberText(unit, limit.limit),
                          (limit.censored() ? "at least " : "") + NumberText(unit, limit.reached),
                          PercentText(limit.reached / limit.limit)});
  }
  table.notes.emplace_back(censored
                               ? "The run reached a limit of the rig. The values without this "
                                 "limit are unknown, so values with \"at least\" are lower bounds."
                               : "The run stayed within the limits. A hazard that exceeds these "
                                 "limits cannot be judged on this rig.");
  return table;
}

}  // namespace

std::vector<SafetyTable> SafetyTables(const SafetyAssessment& safety) {
  std::vector<SafetyTable> tables = {HandTable(safety.exposure, safety.simulated)};
  for (const StopJudgement& stop : safety.stops) tables.push_back(StopTable(stop));
  tables.push_back(LettingGoTable(safety));
  if (safety.contact) tables.push_back(ContactTable(*safety.contact));
  if (!safety.margins.empty()) tables.push_back(MarginTable(safety.margins));
  tables.push_back(RigTable(safety.rig, safety.simulated));
  return tables;
}

}  // namespace predictor::assessment
