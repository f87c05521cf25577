#include "analysis/check/hulls.h"

#include <algorithm>
#include <cstddef>

#include "core/format.h"
#include "models/object_model.h"
#include "models/rigid_bodies.h"
#include "scenario/paths.h"
#include "simulation/collision_hull.h"

namespace predictor {
namespace {

constexpr double kMuchLarger = 1.3;  // volume of a hull divided by that of its mesh

void AddWarnings(const std::vector<ModelShape>& shapes, const std::string& key,
                 std::vector<std::string>* warnings) {
  for (const ModelShape& shape : shapes) {
    const double excess = HullExcess(shape, key);
    if (excess <= kMuchLarger) continue;
    warnings->push_back(Formatted(
        "%s: %s: The convex hull of the mesh %s collides instead of the mesh, and is %.1f times "
        "as large. Nothing can enter the recesses that the hull fills. If something should enter "
        "them, build the part from several <collision> boxes and cylinders.",
        key.c_str(), shape.place.c_str(), shape.mesh.c_str(), excess));
  }
}

// Adds warnings about the links of the cobot that can touch something. `surroundings` states
// whether these are all links that its joints move. Otherwise, they are those in `pairs`.
void AddCobotWarnings(const Scenario& s, bool surroundings, const std::vector<ContactPair>& pairs,
                      std::vector<std::string>* warnings) {
  const UrdfModel urdf =
      ReadUrdf(ResolveModelPath(s.cobot.model, s.folder()), s.cobot.remove_links, s.folder());
  const auto has_pair = [&](const std::string& link) {
    return std::ranges::any_of(pairs, [&](const ContactPair& pair) {
      return pair.state == PairState::kCanTouch && (pair.link == link || pair.other == link);
    });
  };
  const std::vector<std::size_t> bodies = RigidBodies(urdf);
  for (std::size_t i = 0; i < urdf.links.size(); ++i)
    if ((surroundings && bodies[i] != static_cast<std::size_t>(urdf.root)) ||
        has_pair(urdf.links[i].name))
      AddWarnings(urdf.links[i].collisions, "cobot.model", warnings);
}

}  // namespace

std::vector<std::string> HullWarnings(const Scenario& s, const std::vector<ContactPair>& pairs) {
  const EnvironmentSpec& environment = s.environment;
  const auto touches = [&](const char* what) {
    const auto touched = [what](const auto& body) { return body.Touches(what); };
    return std::ranges::any_of(environment.fixtures, touched) ||
           std::ranges::any_of(environment.objects, touched);
  };
  std::vector<std::string> warnings;
  if (touches("object") || s.cobot.Touches("object"))
    AddWarnings(LoadObject(s.object, s.folder()).collisions, "object.model", &warnings);
  if (touches("cobot") || !pairs.empty()) AddCobotWarnings(s, touches("cobot"), pairs, &warnings);
  for (std::size_t i = 0; i < environment.objects.size(); ++i) {
    const std::string key = "environment.objects." + std::to_string(i);
    const MovableSpec& movable = environment.objects[i];
    AddWarnings(LoadObject({movable.model, movable.primitive, {}}, s.folder(), key).collisions,
                key + ".model", &warnings);
  }
  return warnings;
}

}  // namespace predictor
