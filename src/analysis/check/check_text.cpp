// Writes the report of a check as text for the user.
#include <cmath>

#include "analysis/check/check.h"
#include "core/format.h"
#include "core/text.h"
#include "core/units.h"

namespace predictor {
namespace {

void AddModels(const CheckReport& report, std::string* text) {
  const ModelsReport& m = report.models;
  AppendLine(text, "Models");
  AppendLine(text, "  cobot            %d joints, %.1f kg", m.cobot_joints, m.cobot_mass);
  AppendLine(text,
             "  object           %.2f kg; static equilibrium found %.0f mm %s the set-point "
             "(%.0f mm to its side), %.3f m above the virtual floor",
             m.object_mass, 1e3 * std::fabs(m.sag.z()), m.sag.z() > 0 ? "above" : "below",
             1e3 * m.sag.head<2>().norm(), m.X_WO.p.z());
  if (std::isfinite(m.torque_limit) && m.torque_limit > 0)
    AppendLine(text, "  torque at rest   at most %.0f %% of its limit (%s: %.1f of %.0f %s)",
               100 * m.torque_share, m.torque_joint.c_str(), m.torque, m.torque_limit,
               m.torque_is_force ? "N" : "N·m");
  AddStart(report.start, text);
  for (std::size_t h = 0; h < kHands; ++h)
    if (m.arms[h])
      AppendLine(
          text, "  %-5s arm        %d joints, %.1f kg; handle %.2f kg, starts %.2f m from the base",
          kHandNames[h], m.arms[h]->joints, m.arms[h]->mass, m.arms[h]->payload_mass,
          m.arms[h]->reach);
}

// Returns the time of a worst value and the joint concerned, or "" if no joint moves.
std::string WhenAndWhere(const CheckReport& report, std::size_t hand, const Extreme& worst) {
  if (worst.joint < 0) return "";
  return Formatted(" at %5.2f s (%s)", worst.time, report.JointName(hand, worst.joint).c_str());
}

void AddArm(const CheckReport& report, const Reach& reach, std::size_t h, std::string* text) {
  const ArmReach& r = *reach.arms[h];
  // Just before an arm loses its handle, the arm is stretched or at a joint limit. The figures of
  // such an arm are not meaningful for the task.
  if (r.lost) {
    AppendLine(text,
               "  %-5s            CANNOT REACH ITS HANDLE from %.2f s on (%.0f %% of the path)",
               kHandNames[h], *r.lost, 100 * r.reached);
    return;
  }
  AppendLine(text, "  %-5s            %8.3f m  at %5.2f s   %8.2f rad%s   %s%s", kHandNames[h],
             r.singular_value.value, r.singular_value.time, r.joint_margin.value,
             WhenAndWhere(report, h, r.joint_margin).c_str(),
             std::isfinite(r.joint_speed.value)
                 ? Formatted("%4.0f %%", 100 * r.joint_speed.value).c_str()
                 : "blocked",
             WhenAndWhere(report, h, r.joint_speed).c_str());
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
  if (reach.pairs.empty()) AppendLine(text, "  nearest links    no pairs of links of the two arms");
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
               "Bases: no better positions were found nearby (the comfort is %.2f; a value of 1 is "
               "comfortable).",
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

// Returns a shift in the syntax of the scenario.
std::string ShiftText(const PoseSpec& shift) {
  return Formatted("{xyz: [%.3f, %.3f, %.3f], rpy: [0, 0, %.4g deg]}", shift.xyz.x(), shift.xyz.y(),
                   shift.xyz.z(), kDegrees * shift.rpy.z());
}

void AddProposal(const CheckReport& report, const ShiftProposal& p, std::string* text) {
  AppendLine(text, "%s", "");
  if (!IsWorthIt(report, p.comfort)) {
    AppendLine(text,
               "Scene: no better place for these arms was found (the comfort is %.2f; a value of 1 "
               "is comfortable).",
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

// `stiffness` is in N/m.
std::string StiffnessText(double stiffness) {
  return std::fabs(stiffness) < 999.5e3 ? Formatted("%.3g kN/m", 1e-3 * stiffness)
                                        : Formatted("%.3g MN/m", 1e-6 * stiffness);
}

// `damping` is in N·s/m.
std::string DampingText(double damping) {
  return std::fabs(damping) < 9995 ? Formatted("%.3g N·s/m", damping)
                                   : Formatted("%.3g kN·s/m", 1e-3 * damping);
}

void AddStiffness(const ContactReport& r, std::string* text) {
  const std::string each = StiffnessText(r.wall.stiffness);
  const Surface::Kind kind = r.surfaces[0].kind;
  if (r.yields)
    AppendLine(text, "    stiffness        %s at each point", each.c_str());
  else if (kind == Surface::Kind::kTable || kind == Surface::Kind::kFloor)
    AppendLine(text, "    stiffness        not given (in the simulation, %s at each point)",
               each.c_str());
  else
    AppendLine(text, "    stiffness        rigid (in the simulation, %s at each point)",
               each.c_str());
}

void AddLimit(const ContactReport& r, std::string* text) {
  const char* instead = r.yields ? "" : ", as a spring without damping";
  if (!r.limit.reached)
    AppendLine(text, "    stable up to     more than %s%s", StiffnessText(kStiffestWall).c_str(),
               instead);
  else if (r.limit.stiffness > 0)
    AppendLine(text, "    stable up to     %s in all%s; oscillates at %.1f Hz above",
               StiffnessText(r.limit.stiffness).c_str(), instead, r.limit.frequency);
  else if (r.at_start)
    AppendLine(text,
               "    stable up to     not computed: without the contact of the start, the loop "
               "oscillates at %.1f Hz",
               r.limit.frequency);
  else
    AppendLine(text, "    stable up to     0 kN/m: oscillates at %.1f Hz even without contact",
               r.limit.frequency);
}

std::string MovingText(const FeltImpedance& felt) {
  return "stiffness " + StiffnessText(felt.rendered.real()) + " (requested " +
         StiffnessText(felt.requested.real()) + "), damping " +
         DampingText(DampingOf(felt.rendered, kFeltFrequency)) + " (requested " +
         DampingText(DampingOf(felt.requested, kFeltFrequency)) + ")" +
         (felt.rendered.imag() < 0 ? " (the arms' lag feeds energy in)" : "");
}

void AddMass(const char* when, const AddedMass& added, std::string* text) {
  AppendLine(text, "    %-16s %s with %.3g kg more; at %.0f Hz, %s", when,
             added.stable ? "stable" : "UNSTABLE", added.mass, kFeltFrequency,
             MovingText(added.moving).c_str());
}

void AddContact(const ContactReport& r, std::string* text) {
  const Vector3& n = r.wall.normal;
  AppendLine(text, "  %s%s, normal [%.2f, %.2f, %.2f]: %s", Printable(r.what).c_str(),
             r.is_movable() ? " that cannot move"
             : r.at_start   ? " as at the start"
                            : "",
             n.x(), n.y(), n.z(), r.stable ? "stable" : "UNSTABLE");
  AddStiffness(r, text);
  AddLimit(r, text);
  AppendLine(text, "    felt at rest     stiffness %s (requested %s)",
             StiffnessText(r.at_rest.rendered.real()).c_str(),
             StiffnessText(r.at_rest.requested.real()).c_str());
  AppendLine(text, "    felt at %.0f Hz     %s", kFeltFrequency, MovingText(r.moving).c_str());
  if (r.pushed) AddMass("if pushed", *r.pushed, text);
  if (r.held) AddMass("if held", *r.held, text);
}

void AddContacts(const CheckReport& report, std::string* text) {
  AppendLine(text, "%s",
             "\nContact: what the hands feel while the object touches something, at one point");
  for (const ContactReport& contact : report.contacts) AddContact(contact, text);
  if (!report.link_contacts.empty())
    AppendLine(
        text,
        "  cobot's links    contact that %s allows is not predicted. The prediction knows only "
        "forces on the object. Simulate the scenario to see such a contact.",
        Join(report.link_contacts).c_str());
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
  if (!report.contacts.empty() || !report.link_contacts.empty()) AddContacts(report, &text);
  if (report.stop) AddStop(report, &text);
  AppendLine(&text, "%s", "");
  for (const std::string& warning : report.warnings)
    AppendLine(&text, "Warning: %s", warning.c_str());
  for (const std::string& problem : report.problems)
    AppendLine(&text, "Unfit: %s", problem.c_str());
  if (report.fit()) AppendLine(&text, "Fit.");
  return text;
}

}  // namespace predictor
