// Pairs of links that rendering keeps apart.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "haptics/render_arm.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

inline constexpr int kMaxLinkPairs = 8;

struct LinkPair {
  int arm_a, arm_b;
  FrameId a, b;
  std::string name;  // as written in the scenario: "LINK and LINK"
};

// Returns the vector from b's origin to a's, in W [m].
Vector3 Between(const std::array<RenderArm, kHands>& arms, const LinkPair& pair) noexcept;

// Returns the pairs that a scenario keeps apart: rendering.link_pairs, or the two elbows if that is
// not set. For real arms the elbows are always included. Throws InputError (unknown link, too many
// pairs).
std::vector<LinkPair> LinkPairs(
    const Scenario& scenario, const std::array<std::shared_ptr<const RobotModel>, kHands>& models);

}  // namespace predictor
