#include "analysis/check/controller_advice.h"

#include <cmath>

#include "core/format.h"
#include "scenario/own_parameters.h"

namespace predictor {
namespace {

// Returns sentences that state what to change so that the sampled loop is stable.
std::string Reduction(const SampledLoop& loop) {
  if (loop.stable_damping > 0)
    return Formatted(
        "The damping is too large for such a light joint. At this joint, the damping is %.3g "
        "N·m·s/rad, but only up to about %.2g would be stable. Reduce the damping, or make it "
        "proportional to the mass matrix.",
        loop.damping, loop.stable_damping * loop.damping);
  if (loop.stable_stiffness > 0)
    return Formatted(
        "The stiffness is too large for such a light joint. At this joint, the stiffness is %.3g "
        "N·m/rad, but only up to about %.2g would be stable. Reduce the stiffness.",
        loop.stiffness, loop.stable_stiffness * loop.stiffness);
  if (loop.stable_both > 0)
    return Formatted(
        "The stiffness and the damping are too large for such a light joint. With %.2g %% of both "
        "values, the controller would be stable. Reduce them.",
        100 * loop.stable_both);
  return "Reduce its gains.";
}

}  // namespace

std::string ControllerProblem(const Scenario& s, const CheckReport& report) {
  const SampledLoop& loop = report.controller;
  const ControlSpec& control = s.cobot.control;
  const std::string later =
      control.rate < s.rate || control.delay > 0
          ? " A higher cobot.control.rate or a shorter cobot.control.delay also helps."
          : "";
  return Formatted(
             "The cobot's controller is unstable at joint %s, even without hands: because the "
             "torque is computed %.0f times per second, it oscillates at %.0f Hz with growing "
             "amplitude. ",
             report.controller_joint.c_str(), control.rate, loop.frequency) +
         Reduction(loop) + later;
}

std::string MoreDamping(const CobotSpec& cobot) {
  std::string damping = "the damping of the cobot's controller";
  if (const ParameterKind* kind = FindKind(Controllers(), cobot.controller.type)) {
    if (kind->place != ControllerPlace::kProgram) damping = "the damping of your controller";
    const auto own = kind->parameters();
    for (const YamlNode& item : WriteParameters(own.get()).items)
      if (item.key.find("damping") != std::string::npos && item.key.rfind("posture", 0) != 0) {
        damping = "cobot.controller." + item.key;
        break;
      }
  }
  return "Raise " + damping + ", use a heavier object,";
}

}  // namespace predictor
