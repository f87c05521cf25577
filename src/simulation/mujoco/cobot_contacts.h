// The collision shapes of the cobot's links, and their contacts with the carried object and with
// one another (cobot.touches).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "models/robot.h"
#include "models/urdf.h"
#include "scenario/scenario.h"
#include "simulation/mujoco/library.h"
#include "simulation/mujoco/scene.h"

namespace predictor {

class CobotShapes {
 public:
  // Adds the collision shapes of the links that can touch something to the bodies of the cobot.
  // They collide with nothing yet. `surroundings` states whether fixtures or movable objects can
  // touch the links that the cobot's joints move. Throws InputError.
  CobotShapes(mjSpec* spec, const Scenario& scenario, bool surroundings);

  // Returns the names of the shapes of the links that the cobot's joints move. They are complete if
  // the surroundings can touch them.
  std::vector<std::string> Moving() const;

  // Makes the shapes collide with the named shapes of the object and with one another, as
  // cobot.touches states. Two links do not collide if they are one rigid body, or if joints connect
  // them with only links without shapes in between. The object does not collide with the hand. The
  // hand consists of the end-effector, the links that are rigidly connected to it, and the links
  // that these carry. If it has no shapes, it also includes the nearest links towards the base that
  // have some. Returns the pairs that do not collide for these reasons. Throws InputError if there
  // are no shapes that could collide.
  std::vector<ContactPair> AddContacts(mjSpec* spec, const Scenario& scenario,
                                       const std::vector<std::string>& object) const;

 private:
  struct Link {
    std::string name;
    std::size_t body = 0;  // index of the first link of the rigid body to which this link belongs
    bool has_shapes = false;          // in the URDF
    std::vector<std::string> shapes;  // names of those that were added
  };

  void FindBodies(const UrdfModel& urdf);
  void FindHand(const UrdfModel& urdf, const std::string& end_effector);
  void AddShapes(mjSpec* spec, const UrdfModel& urdf, const CobotSpec& cobot, bool surroundings);
  PairState StateOf(std::size_t body, std::size_t other) const;
  bool CanTouchALink(std::size_t body) const;

  std::vector<Link> links_;
  std::size_t root_ = 0;              // the body that no joint moves
  std::vector<std::size_t> carrier_;  // of each body: the next one towards the base whose links
                                      // have shapes, or the root
  std::vector<bool> has_shapes_;      // of each body: whether its links have shapes in the URDF
  std::vector<bool> in_hand_;         // of each body
};

// Finds the pairs of cobot.touches in the compiled model. Two links that overlap at cobot.posture,
// or that are closer than 1 mm, lose their contact. Throws InputError if cobot.posture is invalid.
void FindCobotPairs(const Scenario& scenario, const RobotModel& cobot, Scene* scene);

// Returns the pairs of cobot.touches, with their distances at the places in `data`.
std::vector<ContactPair> ContactPairsAt(const Scene& scene, mjData* data);

// Determines whether the contacts of cobot.touches act.
void SetCobotTouches(const Scene& scene, bool touch) noexcept;
bool CobotTouches(const Scene& scene) noexcept;

}  // namespace predictor
