#include "haptics/link_pairs.h"

#include "core/error.h"
#include "core/text.h"
#include "scenario/operating_rules.h"

namespace predictor {
namespace {

struct NamedLink {
  int arm;
  std::string link;
};

// Parses "left:link", "right:link", or a link without side. If a link is given without a side, its
// position in the pair determines the side.
NamedLink ParseLink(const std::string& name, int side) {
  for (int arm = 0; arm < kHands; ++arm) {
    const std::string prefix = std::string(kHandNames[static_cast<std::size_t>(arm)]) + ":";
    if (name.rfind(prefix, 0) == 0) return {arm, name.substr(prefix.size())};
  }
  return {side, name};
}

std::string DisplayName(const NamedLink& link) {
  return std::string(kHandNames[static_cast<std::size_t>(link.arm)]) + " " + link.link;
}

// `key` is the key of the pair.
FrameId FrameOf(const NamedLink& link,
                const std::array<std::shared_ptr<const RobotModel>, kHands>& models,
                const std::string& key) {
  const std::string arm = kHandNames[static_cast<std::size_t>(link.arm)];
  if (!models[link.arm])
    throw InputError::At(key, key + " keeps " + Quote(link.link) + " of the " + arm +
                                  " arm apart, but there is no such arm. Remove the pair, or write "
                                  "left:LINK or right:LINK for links of the existing arm.");
  try {
    return models[link.arm]->Frame(link.link);
  } catch (const InputError& error) {
    throw InputError::At(key, key + " (" + arm + " arm): " + error.what());
  }
}

}  // namespace

Vector3 Between(const std::array<RenderArm, kHands>& arms, const LinkPair& pair) noexcept {
  const RenderArm &a = arms[pair.arm_a], &b = arms[pair.arm_b];
  return a.data->FramePose(*a.model, pair.a).p - b.data->FramePose(*b.model, pair.b).p;
}

std::vector<LinkPair> LinkPairs(
    const Scenario& s, const std::array<std::shared_ptr<const RobotModel>, kHands>& models) {
  std::vector<std::array<std::string, 2>> names = s.rendering.link_pairs;
  const bool elbows = names.empty() || RulesFor(s).always_separates_elbows;
  if (elbows && models[0] && models[1] && !s.arm(0).elbow.empty() && !s.arm(1).elbow.empty())
    names.push_back({s.arm(0).elbow, s.arm(1).elbow});
  if (names.size() > kMaxLinkPairs)
    throw InputError::At("rendering.link_pairs",
                         "rendering.link_pairs has " + std::to_string(names.size()) +
                             " pairs, but at most " + std::to_string(kMaxLinkPairs) +
                             " are possible. Remove some.");
  std::vector<LinkPair> pairs;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string key = "rendering.link_pairs." + std::to_string(i);
    const NamedLink a = ParseLink(names[i][0], 0);
    const NamedLink b = ParseLink(names[i][1], 1);
    if (a.arm == b.arm && a.link == b.link)
      throw InputError::At(
          key, key + " keeps " + Quote(a.link) + " apart from itself. Give two different links.");
    pairs.push_back({a.arm, b.arm, FrameOf(a, models, key), FrameOf(b, models, key),
                     DisplayName(a) + " and " + DisplayName(b)});
  }
  return pairs;
}

}  // namespace predictor
