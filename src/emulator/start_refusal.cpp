#include "emulator/start_refusal.h"

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "scenario/located.h"

namespace predictor {
namespace {

InputError JointRefusal(const Scenario& s, const BeyondPlace& at, const std::string& joint) {
  const std::string key = DeviceArmKey(at.arm) + ".posture";
  return InputError::At(
      key,
      key + Formatted(": the arm starts with joint %s at %.3f rad, but must start between %.3f and "
                      "%.3f rad (its limits, reduced by rendering.joint_security, %g rad). Choose "
                      "another posture, or %s. `predictor check` shows details.",
                      Quote(joint).c_str(), at.value, at.low, at.high, s.rendering.joint_security,
                      PlacementRemedy(s, at.arm).c_str()));
}

InputError LinkRefusal(const BeyondPlace& at, const std::array<std::string, 2>& links) {
  const std::string key = DeviceArmKey(at.pair->arm_b) + ".base";
  return InputError::At(
      key, key + Formatted(": the arms start with %s only %.3f m from %s, but "
                           "rendering.security_distance is %.3f m. Move the arms' bases apart, or "
                           "choose another posture. `predictor check` shows details.",
                           links[0].c_str(), at.value, links[1].c_str(), at.low));
}

// Returns, for example, "link "panda_link4" of the left arm".
std::string LinkWords(const RobotModel& model, const FrameId& frame, int hand) {
  for (const std::string& link : model.link_names()) {
    const FrameId named = model.Frame(link);
    if (named.body == frame.body && named.X_JF.p == frame.X_JF.p)
      return "link " + Quote(link) + " of the " + HandName(hand) + " arm";
  }
  return std::string("a link of the ") + HandName(hand) + " arm";
}

}  // namespace

std::string StartRefusal(const Scenario& scenario, const BeyondPlace& at,
                         const std::array<RenderArm, kHands>& arms, Refusal refusal) {
  const auto model = [&arms](int hand) -> const RobotModel& {
    return *arms[static_cast<std::size_t>(hand)].model;
  };
  switch (at.what) {
    case Beyond::kNothing:
      return Sentence(refusal);
    case Beyond::kJoint:
      return Located(JointRefusal(scenario, at, model(at.arm).joint_name(at.joint)), scenario)
          .what();
    case Beyond::kLinks:
      return Located(
                 LinkRefusal(at, {LinkWords(model(at.pair->arm_a), at.pair->a, at.pair->arm_a),
                                  LinkWords(model(at.pair->arm_b), at.pair->b, at.pair->arm_b)}),
                 scenario)
          .what();
  }
  return "";
}

}  // namespace predictor
