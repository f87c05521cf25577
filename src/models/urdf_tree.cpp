#include "models/urdf_tree.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

using Indices = std::vector<int>;

// Returns for each link the joint above it, or −1 for a root. Refuses a link with two parents.
Indices JointsAbove(const UrdfSource& source, const UrdfModel& model) {
  Indices above(model.links.size(), -1);
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const UrdfJoint& joint = model.joints[j];
    int& first = above[static_cast<std::size_t>(joint.child)];
    if (first >= 0) {
      throw InputError(source.name + ":" + std::to_string(joint.line),
                       "Link " + Quote(model.links[static_cast<std::size_t>(joint.child)].name) +
                           " is the child of two joints, " +
                           Quote(model.joints[static_cast<std::size_t>(first)].name) + " and " +
                           Quote(joint.name) +
                           ". A link can have only one parent joint. Delete the other joint.");
    }
    first = static_cast<int>(j);
  }
  return above;
}

[[noreturn]] void FailCycle(const UrdfSource& source, const UrdfModel& model, const Indices& above,
                            int link) {
  // A walk upwards by as many steps as there are links ends inside the cycle.
  const auto parent = [&](int i) {
    return model.joints[static_cast<std::size_t>(above[static_cast<std::size_t>(i)])].parent;
  };
  for (std::size_t i = 0; i < model.links.size(); ++i) link = parent(link);
  std::vector<std::string> cycle;
  int at = link;
  do {
    cycle.insert(cycle.begin(), model.links[static_cast<std::size_t>(at)].name);
    at = parent(at);
  } while (at != link && cycle.size() < 10);
  throw InputError(
      source.name + ":" + std::to_string(model.links[static_cast<std::size_t>(link)].line),
      "The links form a cycle: " + Join(cycle, " → ") + " → " + cycle.front() +
          ". Delete one of the joints between them.");
}

// Returns the joints below `root`, depth-first. The joints of each link are in the file's order.
Indices DepthFirst(const UrdfModel& model, int root) {
  std::vector<Indices> below(model.links.size());
  for (std::size_t j = model.joints.size(); j-- > 0;) {
    below[static_cast<std::size_t>(model.joints[j].parent)].push_back(static_cast<int>(j));
  }
  Indices order;
  Indices stack = below[static_cast<std::size_t>(root)];
  while (!stack.empty()) {
    const int joint = stack.back();
    stack.pop_back();
    order.push_back(joint);
    const Indices& next =
        below[static_cast<std::size_t>(model.joints[static_cast<std::size_t>(joint)].child)];
    stack.insert(stack.end(), next.begin(), next.end());
  }
  return order;
}

template <class T>
std::vector<T> Pick(const std::vector<T>& from, const Indices& order) {
  std::vector<T> picked;
  for (const int i : order) picked.push_back(from[static_cast<std::size_t>(i)]);
  return picked;
}

// Returns the index of the link named in entry `entry` of the list of links to remove.
std::size_t FindLink(const UrdfModel& model, const std::string& name, std::size_t entry) {
  const std::string key = "remove_links." + std::to_string(entry);
  const auto found = std::find_if(model.links.begin(), model.links.end(),
                                  [&name](const UrdfLink& link) { return link.name == name; });
  if (found == model.links.end()) {
    throw InputError::At(key, key + ": " + Quote(name) + " is not a link of the robot " +
                                  Quote(model.name) + ". " + Suggestion(name, model.LinkNames()));
  }
  if (found - model.links.begin() == model.root) {
    throw InputError::At(
        key, key + ": " + Quote(name) + " is the root of the robot " + Quote(model.name) +
                 ", so nothing would remain. Give a link that is farther from the root.");
  }
  return static_cast<std::size_t>(found - model.links.begin());
}

}  // namespace

void SortTree(const UrdfSource& source, UrdfDocument* urdf) {
  UrdfModel& model = urdf->model;
  const Indices above = JointsAbove(source, model);
  std::vector<std::string> roots;
  for (std::size_t i = 0; i < above.size(); ++i) {
    if (above[i] >= 0) continue;
    roots.push_back(model.links[i].name);
    model.root = static_cast<int>(i);
  }
  if (roots.empty()) FailCycle(source, model, above, 0);
  if (roots.size() > 1) {
    const std::string others = roots.size() > 5 ? ", ..." : "";
    roots.resize(std::min<std::size_t>(roots.size(), 5));
    throw InputError(
        source.name + ":" + std::to_string(model.links[static_cast<std::size_t>(model.root)].line),
        "More than one link has no parent joint: " + Join(roots) + others +
            ". A model must have one root. Connect the other links to it with joints.");
  }
  const Indices order = DepthFirst(model, model.root);
  if (order.size() + 1 < model.links.size()) {  // the remaining links form a cycle
    std::vector<bool> is_reached(model.links.size(), false);
    is_reached[static_cast<std::size_t>(model.root)] = true;
    for (const int j : order) {
      is_reached[static_cast<std::size_t>(model.joints[static_cast<std::size_t>(j)].child)] = true;
    }
    const auto lost = std::find(is_reached.begin(), is_reached.end(), false);
    FailCycle(source, model, above, static_cast<int>(lost - is_reached.begin()));
  }
  model.joints = Pick(model.joints, order);
  urdf->joints = Pick(urdf->joints, order);
}

void RemoveLinks(const std::vector<std::string>& names, XmlElement* robot, UrdfDocument* urdf) {
  UrdfModel& model = urdf->model;
  std::vector<bool> is_cut(model.links.size(), false);
  for (std::size_t i = 0; i < names.size(); ++i) is_cut[FindLink(model, names[i], i)] = true;
  Indices joints, links, new_index(model.links.size(), -1);
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const auto parent = static_cast<std::size_t>(model.joints[j].parent);
    const auto child = static_cast<std::size_t>(model.joints[j].child);
    if (is_cut[parent]) is_cut[child] = true;
    if (is_cut[child]) {
      robot->DeleteChild(urdf->joints[j]);
    } else {
      joints.push_back(static_cast<int>(j));
    }
  }
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (is_cut[i]) {
      robot->DeleteChild(urdf->links[i]);
    } else {
      new_index[i] = static_cast<int>(links.size());
      links.push_back(static_cast<int>(i));
    }
  }
  model.joints = Pick(model.joints, joints);
  urdf->joints = Pick(urdf->joints, joints);
  model.links = Pick(model.links, links);
  urdf->links = Pick(urdf->links, links);
  model.root = new_index[static_cast<std::size_t>(model.root)];
  for (UrdfJoint& joint : model.joints) {
    joint.parent = new_index[static_cast<std::size_t>(joint.parent)];
    joint.child = new_index[static_cast<std::size_t>(joint.child)];
  }
}

}  // namespace predictor
