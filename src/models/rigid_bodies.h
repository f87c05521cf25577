// Finds the rigid bodies of a URDF.
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

#include "models/urdf.h"

namespace predictor {

// Returns the rigid body to which each link belongs, as the index of the first link of this body.
// Links that fixed joints connect are one body. The body of the root link is the one that no joint
// moves.
inline std::vector<std::size_t> RigidBodies(const UrdfModel& urdf) {
  std::vector<std::size_t> bodies(urdf.links.size());
  std::iota(bodies.begin(), bodies.end(), std::size_t{0});
  for (const UrdfJoint& joint : urdf.joints)  // parents come before children
    if (joint.type == UrdfJointType::kFixed)
      bodies[static_cast<std::size_t>(joint.child)] =
          bodies[static_cast<std::size_t>(joint.parent)];
  return bodies;
}

}  // namespace predictor
