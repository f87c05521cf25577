#include "models/arm_chain.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

template <std::size_t N>
bool Contains(std::string name, const std::array<const char*, N>& words) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::any_of(
      words, [&](const char* word) { return name.find(word) != std::string::npos; });
}

bool IsFinger(const UrdfLink& link) {
  return Contains(link.name, std::array{"finger", "thumb", "jaw", "knuckle"});
}

bool IsGripper(const UrdfJoint& joint, const UrdfModel& urdf) {
  const bool coupled =
      !joint.mimics.empty() || std::ranges::any_of(urdf.joints, [&](const UrdfJoint& other) {
        return other.mimics == joint.name;
      });
  return coupled ||
         Contains(joint.name, std::array{"finger", "thumb", "jaw", "knuckle", "gripper"});
}

// Determines which joints and links of a robot belong to arms. All indices refer to the joints and
// links of the model.
class Arms {
 public:
  explicit Arms(const UrdfModel& urdf)
      : urdf_(urdf),
        above_(urdf.links.size(), -1),
        carriers_(urdf.links.size(), 0),
        body_(urdf.links.size(), urdf.root),
        hand_(urdf.joints.size(), false),
        on_hand_(urdf.links.size(), false) {
    for (std::size_t j = 0; j < urdf.joints.size(); ++j) {
      const UrdfJoint& joint = urdf.joints[j];
      at(above_, joint.child) = static_cast<int>(j);
      at(carriers_, joint.child) = at(carriers_, joint.parent) + (Moves(joint) ? 1 : 0);
      at(body_, joint.child) = Moves(joint) ? joint.child : at(body_, joint.parent);
    }
    MarkGrippers();
    MarkBranches();
    for (std::size_t j = 0; j < urdf.joints.size(); ++j)
      at(on_hand_, urdf.joints[j].child) = hand_[j] || at(on_hand_, urdf.joints[j].parent);
  }

  static bool Moves(const UrdfJoint& joint) { return joint.type != UrdfJointType::kFixed; }
  int carriers(int link) const { return at(carriers_, link); }  // number of movable joints
  int above(int link) const { return at(above_, link); }        // joint; −1 at the root

  // Returns the link that is carried by the largest number of an arm's joints. If several links are
  // carried by this number of joints, it returns the last of these links that is not part of a
  // finger.
  int EndEffector() const {
    int best = urdf_.root;
    const auto rank = [this](int link) {
      return std::pair{carriers(link), !IsFinger(at(urdf_.links, link))};
    };
    for (int link = 0; link < static_cast<int>(urdf_.links.size()); ++link)
      if (!at(on_hand_, link) && rank(link) >= rank(best)) best = link;
    return best;
  }

 private:
  template <class List>
  static auto at(List& list, int i) -> decltype(list[0]) {
    return list[static_cast<std::size_t>(i)];
  }

  // The loop runs from the tips to the base, so that a joint is visited after all joints that it
  // carries.
  void MarkGrippers() {
    std::vector<bool> carries_arm(urdf_.links.size(), false);
    for (std::size_t j = urdf_.joints.size(); j-- > 0;) {
      const UrdfJoint& joint = urdf_.joints[j];
      hand_[j] = Moves(joint) && !at(carries_arm, joint.child) && IsGripper(joint, urdf_);
      if (at(carries_arm, joint.child) || (Moves(joint) && !hand_[j]))
        at(carries_arm, joint.parent) = true;
    }
  }

  void MarkBranches() {
    std::vector<int> branches(urdf_.links.size(), 0);  // number of branches of each body
    for (std::size_t j = 0; j < urdf_.joints.size(); ++j)
      if (Moves(urdf_.joints[j]) && !hand_[j]) ++at(branches, at(body_, urdf_.joints[j].parent));
    for (std::size_t j = 0; j < urdf_.joints.size(); ++j) {
      const int parent = urdf_.joints[j].parent;
      if (Moves(urdf_.joints[j]) && at(branches, at(body_, parent)) > 1 &&
          carriers(parent) >= kMinArmJoints)
        hand_[j] = true;
    }
  }

  const UrdfModel& urdf_;
  std::vector<int> above_, carriers_, body_;  // body: the first link of those fixed to each other
  std::vector<bool> hand_;                    // whether each joint is part of a hand
  std::vector<bool> on_hand_;                 // whether each link is part of a hand
};

int LinkNamed(const UrdfModel& urdf, const std::string& name) {
  const auto found = std::ranges::find(urdf.links, name, &UrdfLink::name);
  if (found == urdf.links.end())
    throw InputError(urdf.file.string(), Quote(name) + " is not a link of the robot " +
                                             Quote(urdf.name) + ". " +
                                             Suggestion(name, urdf.LinkNames()));
  return static_cast<int>(found - urdf.links.begin());
}

}  // namespace

ArmChain FindArm(const UrdfModel& urdf, const std::string& end_effector) {
  const Arms arms(urdf);
  const int end = end_effector.empty() ? arms.EndEffector() : LinkNamed(urdf, end_effector);
  ArmChain chain;
  chain.end_effector = urdf.links[static_cast<std::size_t>(end)].name;
  if (arms.carriers(end) == 0)
    throw InputError(urdf.file.string(), "No joint moves link " + Quote(chain.end_effector) +
                                             ". Give a link at the end of an arm.");
  std::vector<bool> on_path(urdf.joints.size(), false), kept(urdf.links.size(), true);
  for (int link = end; arms.above(link) >= 0;) {
    const auto joint = static_cast<std::size_t>(arms.above(link));
    on_path[joint] = true;
    link = urdf.joints[joint].parent;
  }
  for (std::size_t j = 0; j < urdf.joints.size(); ++j) {
    const UrdfJoint& joint = urdf.joints[j];
    const auto parent = static_cast<std::size_t>(joint.parent);
    const auto child = static_cast<std::size_t>(joint.child);
    kept[child] = kept[parent] && (on_path[j] || !Arms::Moves(joint));
    if (on_path[j] && Arms::Moves(joint)) chain.joints.push_back(joint.name);
    if (!kept[child]) chain.removed_mass += urdf.links[child].mass;
    if (kept[parent] && !kept[child]) chain.remove_links.push_back(urdf.links[child].name);
  }
  return chain;
}

}  // namespace predictor
