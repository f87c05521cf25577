#include "simulation/mujoco/cobot_contacts.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "models/arm_model.h"
#include "models/rigid_bodies.h"
#include "scenario/paths.h"
#include "simulation/mujoco/fixtures.h"
#include "simulation/mujoco/mesh_holes.h"
#include "simulation/mujoco/shapes.h"
#include "simulation/touches.h"

namespace predictor {
namespace {

// Links that are at most this far apart at cobot.posture count as overlapping [m].
constexpr double kNearlyTouching = 0.001;

void AddPairs(mjSpec* spec, const std::vector<std::string>& shapes,
              const std::vector<std::string>& others, double friction) {
  for (const std::string& shape : shapes)
    for (const std::string& other : others) AddContact(spec, shape, other, friction);
}

}  // namespace

CobotShapes::CobotShapes(mjSpec* spec, const Scenario& scenario, bool surroundings) {
  const UrdfModel urdf = ReadUrdf(ResolveModelPath(scenario.cobot.model, scenario.folder()),
                                  scenario.cobot.remove_links, scenario.folder());
  FindBodies(urdf);
  FindHand(urdf, scenario.cobot.end_effector);
  AddShapes(spec, urdf, scenario.cobot, surroundings);
}

void CobotShapes::FindBodies(const UrdfModel& urdf) {
  root_ = static_cast<std::size_t>(urdf.root);
  links_.resize(urdf.links.size());
  has_shapes_.assign(links_.size(), false);
  carrier_.assign(links_.size(), root_);
  const std::vector<std::size_t> bodies = RigidBodies(urdf);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    links_[i].name = urdf.links[i].name;
    links_[i].body = bodies[i];
    links_[i].has_shapes = !urdf.links[i].collisions.empty();
  }
  for (const Link& link : links_)
    if (link.has_shapes) has_shapes_[link.body] = true;
  for (const UrdfJoint& joint : urdf.joints) {
    if (joint.type == UrdfJointType::kFixed) continue;
    const std::size_t parent = links_[static_cast<std::size_t>(joint.parent)].body;
    carrier_[static_cast<std::size_t>(joint.child)] =
        has_shapes_[parent] || parent == root_ ? parent : carrier_[parent];
  }
}

void CobotShapes::AddShapes(mjSpec* spec, const UrdfModel& urdf, const CobotSpec& cobot,
                            bool surroundings) {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const UrdfLink& link = urdf.links[i];
    mjsBody* body = mjs_findBody(spec, (kCobotPrefix + link.name).c_str());
    const std::size_t rigid = links_[i].body;
    const bool by_surroundings = surroundings && rigid != root_;
    const bool by_cobot = (cobot.Touches("object") && !in_hand_[rigid]) ||
                          (cobot.Touches("cobot") && CanTouchALink(rigid));
    if (body == nullptr || !(by_surroundings || by_cobot)) continue;
    for (std::size_t k = 0; k < link.collisions.size(); ++k) {
      const ModelShape& shape = link.collisions[k];
      // A hole in a link is one for a screw or a cable, into which neither the object nor another
      // link fits. A peg among the surroundings might.
      if (by_surroundings) CheckHull(shape, "cobot.model");
      links_[i].shapes.push_back(kCobotPrefix + link.name + "/" + std::to_string(k));
      mjsGeom* geom = AddShape(spec, body, shape, links_[i].shapes.back(), "cobot.model");
      geom->contype = geom->conaffinity = 0;
      geom->density = 0;  // the link's inertia is in the file
    }
  }
}

void CobotShapes::FindHand(const UrdfModel& urdf, const std::string& end_effector) {
  in_hand_.assign(links_.size(), false);
  std::size_t hand = root_;
  for (std::size_t i = 0; i < links_.size(); ++i)
    if (urdf.links[i].name == end_effector) hand = links_[i].body;
  in_hand_[hand] = true;
  for (const UrdfJoint& joint : urdf.joints)
    if (in_hand_[links_[static_cast<std::size_t>(joint.parent)].body])
      in_hand_[links_[static_cast<std::size_t>(joint.child)].body] = true;
  const auto is_shape_of_hand = [this](const Link& link) {
    return link.has_shapes && in_hand_[link.body];
  };
  if (std::ranges::none_of(links_, is_shape_of_hand)) in_hand_[carrier_[hand]] = true;
}

std::vector<std::string> CobotShapes::Moving() const {
  std::vector<std::string> names;
  for (const Link& link : links_)
    if (link.body != root_) names.insert(names.end(), link.shapes.begin(), link.shapes.end());
  return names;
}

PairState CobotShapes::StateOf(std::size_t body, std::size_t other) const {
  if (body == other) return PairState::kOneBody;
  const bool neighbours = carrier_[body] == other || carrier_[other] == body;
  return neighbours ? PairState::kJoint : PairState::kCanTouch;
}

bool CobotShapes::CanTouchALink(std::size_t body) const {
  for (std::size_t other = 0; other < links_.size(); ++other)
    if (has_shapes_[other] && StateOf(body, other) == PairState::kCanTouch) return true;
  return false;
}

std::vector<ContactPair> CobotShapes::AddContacts(mjSpec* spec, const Scenario& scenario,
                                                  const std::vector<std::string>& object) const {
  RequireShapesOfCobotTouches(scenario, std::ranges::find(has_shapes_, true) != has_shapes_.end(),
                              !object.empty());
  std::vector<ContactPair> excluded;
  bool with_object = false, with_link = false;  // whether some link can touch them
  const auto add = [&](const Link& link, const std::string& other, PairState state,
                       const std::vector<std::string>& shapes) {
    if (state != PairState::kCanTouch) return excluded.push_back({link.name, other, state});
    AddPairs(spec, link.shapes, shapes, scenario.environment.friction);
    (other.empty() ? with_object : with_link) = true;
  };
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    if (!link.has_shapes) continue;
    if (scenario.cobot.Touches("object"))
      add(link, "", in_hand_[link.body] ? PairState::kHolds : PairState::kCanTouch, object);
    if (!scenario.cobot.Touches("cobot")) continue;
    for (std::size_t j = 0; j < i; ++j)
      if (links_[j].has_shapes)
        add(links_[j], link.name, StateOf(links_[j].body, link.body), link.shapes);
  }
  RequirePairsOfCobotTouches(scenario, with_link, with_object);
  return excluded;
}

namespace {

// Returns the shapes' places at cobot.posture. Those of a free object are arbitrary.
DataPtr AtPosture(const Scenario& scenario, const RobotModel& cobot, const Scene& scene) {
  const JointVector q = PostureOf(scenario.cobot.posture, cobot, "cobot.posture");
  DataPtr data(mj_makeData(scene.model.get()));
  for (int j = 0; j < q.size(); ++j) data->qpos[scene.qpos[static_cast<std::size_t>(j)]] = q[j];
  mj_kinematics(scene.model.get(), data.get());
  return data;
}

// Removes the contacts of the given pairs of shapes from the model and from its description.
void RemovePairs(const std::vector<int>& pairs, Scene* scene) {
  for (const int p : pairs) scene->model->pair_margin[p] = kNoContact;
  for (mjsElement* e = mjs_firstElement(scene->spec.get(), mjOBJ_PAIR); e;
       e = mjs_nextElement(scene->spec.get(), e))
    if (std::ranges::find(pairs, mjs_getId(e)) != pairs.end()) mjs_asPair(e)->margin = kNoContact;
}

std::string LinkNameOf(const Scene& scene, int body) {
  return mj_id2name(scene.model.get(), mjOBJ_BODY, body) + std::string_view(kCobotPrefix).size();
}

// Returns the distance of two bodies, at most `most` [m].
double DistanceOf(const CobotPair& pair, const Scene& scene, mjData* data, double most) {
  double nearest = most;
  for (const int p : pair.shapes)
    nearest = std::min(nearest, mj_geomDistance(scene.model.get(), data, scene.model->pair_geom1[p],
                                                scene.model->pair_geom2[p], most, nullptr));
  return nearest;
}

}  // namespace

void FindCobotPairs(const Scenario& scenario, const RobotModel& cobot, Scene* scene) {
  if (scenario.cobot.touches.empty()) return;
  const mjModel& model = *scene->model;
  const auto is_own = [&](int body) {
    return body != 0 && scene->movable_of[static_cast<std::size_t>(body)] < 0;
  };
  std::map<std::pair<int, int>, std::vector<int>> pairs;  // of each two bodies
  for (int p = 0; p < model.npair; ++p) {
    const int a = model.geom_bodyid[model.pair_geom1[p]],
              b = model.geom_bodyid[model.pair_geom2[p]];
    if (is_own(a) && is_own(b)) pairs[std::minmax(a, b)].push_back(p);
  }
  const DataPtr data = AtPosture(scenario, cobot, *scene);
  for (auto& [bodies, shapes] : pairs) {
    CobotPair pair{bodies.first, bodies.second, true, std::move(shapes)};
    if (pair.link == scene->object) std::swap(pair.link, pair.other);
    pair.active = pair.other == scene->object ||
                  DistanceOf(pair, *scene, data.get(), 2 * kNearlyTouching) >= kNearlyTouching;
    if (!pair.active) RemovePairs(pair.shapes, scene);
    scene->cobot_pairs.push_back(std::move(pair));
  }
}

std::vector<ContactPair> ContactPairsAt(const Scene& scene, mjData* data) {
  std::vector<ContactPair> pairs;
  for (const CobotPair& pair : scene.cobot_pairs)
    pairs.push_back({LinkNameOf(scene, pair.link),
                     pair.other == scene.object ? "" : LinkNameOf(scene, pair.other),
                     pair.active ? PairState::kCanTouch : PairState::kOverlaps,
                     DistanceOf(pair, scene, data, kFarthestPair)});
  pairs.insert(pairs.end(), scene.excluded_pairs.begin(), scene.excluded_pairs.end());
  return pairs;
}

void SetCobotTouches(const Scene& scene, bool touch) noexcept {
  for (const CobotPair& pair : scene.cobot_pairs)
    for (const int p : pair.shapes)
      scene.model->pair_margin[p] = touch && pair.active ? 0 : kNoContact;
}

bool CobotTouches(const Scene& scene) noexcept {
  const auto is_off = [&](const CobotPair& pair) {
    return pair.active && scene.model->pair_margin[pair.shapes.front()] <= kNoContact;
  };
  return std::ranges::none_of(scene.cobot_pairs, is_off);
}

}  // namespace predictor
