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
  std::string name;  // "left LINK and right LINK"
};

// Returns the vector from the origin of b to the origin of a, in W [m].
Vector3 Between(const std::array<RenderArm, kHands>& arms, const LinkPair& pair) noexcept;

// Returns the pairs that a scenario keeps apart: rendering.link_pairs or, if this key is not set,
// the two elbows. For real arms, the pair of elbows is always included. Throws InputError if a link
// is unknown or if there are too many pairs.
std::vector<LinkPair> LinkPairs(
    const Scenario& scenario, const std::array<std::shared_ptr<const RobotModel>, kHands>& models);

}  // namespace predictor
