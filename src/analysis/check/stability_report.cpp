#include <cmath>

#include "analysis/check/check.h"

namespace predictor {

HandSpec Varied(HandSpec hand, double mass, double stiffness) {
  const double largest = hand.stiffness.maxCoeff();
  const double scale = largest > 0 ? stiffness / largest : 1;
  hand.mass = mass;
  hand.stiffness *= scale;
  hand.rotation_stiffness *= scale;
  hand.rotation_damping *= std::sqrt(scale);
  return hand;
}

StabilityReport CheckStability(const Scenario& s, const LinearModel& world,
                               const std::vector<double>& masses,
                               const std::vector<double>& stiffnesses, const OnProgress& progress) {
  const double dt = 1 / s.rate;
  const HapticLoop loop(world, s, dt);
  const HandSpec& hand = s.operator_.hand;
  StabilityReport report;
  const LeadChoice choice = ChooseLead(loop, s, dt);
  report.lag = choice.lag;
  report.chosen = !s.rendering.lead;
  report.lead = s.rendering.lead.value_or(choice.lead);
  report.margin = s.rendering.lead ? loop.Margin(hand, report.lead) : choice.margin;
  report.without_lead = loop.Margin(hand, 0);
  report.full_lead = loop.Margin(hand, report.lag);
  report.masses = masses;
  report.stiffnesses = stiffnesses;
  const double cells = static_cast<double>(masses.size() * stiffnesses.size());
  for (const double mass : masses)
    for (const double stiffness : stiffnesses) {
      progress(static_cast<double>(report.table.size()) / cells);
      report.table.push_back(loop.Margin(Varied(hand, mass, stiffness), report.lead));
    }
  progress(1);
  return report;
}

}  // namespace predictor
