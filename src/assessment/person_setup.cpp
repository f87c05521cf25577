#include "assessment/person_setup.h"

#include <cmath>

#include "core/error.h"
#include "core/text.h"

namespace predictor::assessment {

std::vector<std::string> MissingForPosture(const Scenario& scenario) {
  std::vector<std::string> missing;
  if (!scenario.operator_.body)
    missing.emplace_back(
        "The scenario does not describe the operator's body. Add operator.body: {height, mass, "
        "sex}.");
  if (!scenario.operator_.stance)
    missing.emplace_back(
        "The place where the operator stands is not known. Add operator.stance: {ground, facing} "
        "to the scenario and, for real arms, ground to the machine file.");
  return missing;
}

PersonSetup SetupOf(const Scenario& scenario, const std::array<Pose, kHands>& handles) {
  if (const auto missing = MissingForPosture(scenario); !missing.empty())
    throw InputError(Join(missing, " "));
  const StanceSpec& stands = *scenario.operator_.stance;
  PersonSetup setup;
  setup.body = *scenario.operator_.body;
  const Vector3 forward(std::cos(stands.facing), std::sin(stands.facing), 0);
  setup.stance = person::StanceOf(stands);
  for (int hand = 0; hand < kHands; ++hand) {
    if (!scenario.Has(hand)) continue;
    const auto h = static_cast<std::size_t>(hand);
    const GripSpec& grip = scenario.handle(hand).grip;
    setup.grips[h].kind = grip.kind;
    setup.grips[h].X_DG = person::GripOn(grip.bar, handles[h].q.conjugate() * -forward);
  }
  return setup;
}

PersonSetup SetupOf(const Scenario& scenario, const TickRecord& first) {
  std::array<Pose, kHands> handles;
  for (std::size_t h = 0; h < kHands; ++h) handles[h] = FromRecord(first.hands[h].real.pose);
  return SetupOf(scenario, handles);
}

}  // namespace predictor::assessment
