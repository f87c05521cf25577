// Writes a continuation as text for people.
#include <algorithm>
#include <cmath>

#include "analysis/continuation/continuation.h"
#include "core/format.h"
#include "core/text.h"
#include "core/words.h"

namespace predictor {
namespace {

std::string RangeText(const Interval90& range, const char* format) {
  const auto text = [&](const CensoredValue& value) {
    return std::isfinite(value.value) ? BoundText(value, format) : std::string("not known");
  };
  return text(range.low) + " … " + text(range.high);
}

}  // namespace

const std::array<ContinuationQuantity, 6> kContinuationQuantities = {{
    {"peak_force_n", "Largest force of a hand", "%.1f N", &ContinuedRun::peak_force},
    {"peak_torque_nm", "Largest torque of a hand", "%.2f N·m", &ContinuedRun::peak_torque},
    {"peak_speed_m_s", "Largest speed of a handle", "%.2f m/s", &ContinuedRun::peak_speed},
    {"energy_into_person_j", "Energy into the person", "%.2f J", &ContinuedRun::energy},
    {"peak_power_into_person_w", "Largest power into the person", "%.1f W",
     &ContinuedRun::peak_power},
    {"joint_use", "Joint torque over strength", "%.2f", &ContinuedRun::joint_use},
}};

std::string EndingWords(const Continuation& c) {
  constexpr std::array<const char*, kEndings> kWords = {
      "settles below the limits", "stays above a limit", "diverges", "the cobot stops itself",
      "ends with another fault of the emulator"};
  std::vector<std::string> parts;
  for (int k = 0; k < kEndings; ++k)
    if (const int count = c.CountOf(static_cast<Ending>(k)); count > 0)
      parts.push_back(Formatted("%s %.0f %%", kWords[static_cast<std::size_t>(k)],
                                100.0 * count / static_cast<double>(c.runs.size())));
  return Join(parts);
}

std::vector<std::string> ContinuationAssumptions(const Continuation& c) {
  std::vector<std::string> lines = {
      "All values are modelled. The limits of force, torque, coupling, tracking and handle speed "
      "are switched off. The arms' own limits and all other faults remain active.",
      "The operator's intention is not known. The intention is estimated from the measured force "
      "and motion before the stop. The assumed change of the intention after the stop is a design "
      "choice with a stated spread.",
      "The operator is assumed neither to let go nor to relax on purpose after the stop.",
      "The arm's impedance: " + c.arm_source + "."};
  if (c.CountOf(Ending::kFault) > 0)
    lines.push_back(
        "The values of runs that end with another fault are lower bounds. The quantiles take these "
        "lower bounds into account (Kaplan-Meier). The words \"at least\" mark quantiles of which "
        "only a bound is known.");
  lines.push_back(c.no_joint_use.empty()
                      ? "\"Joint torque over strength\" is the torque of elbows and shoulders at "
                        "the largest force, for the nominal posture at rest, divided by the mean "
                        "strength for the person's sex."
                      : "Joint torque over strength is not evaluable: " + c.no_joint_use);
  return lines;
}

std::string ContinuationText(const Continuation& c) {
  std::string text;
  AppendLine(&text, "%s: stopped after %.3f s of emulation by cause '%s'%s%s: %s.",
             Printable(c.scenario).c_str(), c.time, Name(c.cause.cause),
             c.cause.hand < 0 ? "" : ", hand ",
             c.cause.hand < 0 ? "" : kHandNames[static_cast<std::size_t>(c.cause.hand)],
             SeenAndAllowed(c.cause.value, c.cause.limit, c.cause.quantity).c_str());
  AppendLine(&text, "The run itself shows only that the largest force was at least %.1f N.",
             c.peak_before);
  AppendLine(&text, "Without the stop, %.2g s later (%zu possible operators):", c.horizon,
             c.runs.size());
  AppendLine(&text, "  %-32s %10s   90 %% interval%s", "", "median",
             c.reference ? "; the simulated operator" : "");
  for (const ContinuationQuantity& q : kContinuationQuantities) {
    const Interval90 range = c.IntervalOf(q.value);
    if (!std::isfinite(range.median.value)) continue;
    std::string reference;
    if (c.reference && std::isfinite((*c.reference).*q.value))
      reference = "; " + BoundText({(*c.reference).*q.value, c.reference->ending == Ending::kFault},
                                   q.format);
    AppendLine(&text, "  %-32s %10s   %s%s", q.label, BoundText(range.median, q.format).c_str(),
               RangeText(range, q.format).c_str(), reference.c_str());
  }
  AppendLine(&text, "How it would have ended: %s.", EndingWords(c).c_str());
  if (c.reference)
    AppendLine(&text,
               "The simulated operator's own intention, which a recording does not show: %s.",
               Name(c.reference->ending));
  for (const std::string& line : ContinuationAssumptions(c))
    AppendLine(&text, "- %s", line.c_str());
  return text;
}

}  // namespace predictor
