// Lists what the carried object can touch: fixtures, the table, the floor and movable objects.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/types.h"
#include "models/object_model.h"
#include "scenario/scenario.h"

namespace predictor {

// Something that the carried object can touch.
struct Surface {
  enum class Kind { kFixture, kTable, kFloor, kMovable };
  Kind kind = Kind::kFixture;
  std::size_t number = 0;  // of a fixture or movable object

  bool operator==(const Surface&) const = default;
};

// Returns the fixtures that touch the object, then the table, the floor if `floor` is true, and the
// movable objects that touch the object.
std::vector<Surface> SurfacesOf(const Scenario& scenario, bool floor);

// Returns the scenario's key of a surface, for example "environment.fixtures.0".
std::string KeyOf(const Surface& surface);

// Returns a phrase for surfaces, for example "fixtures 0 and 2, table". With the names of the
// scenario, if it is given, this is "fixtures 0 (shelf) and 2, table".
std::string PhraseOf(const std::vector<Surface>& surfaces, const Scenario* names = nullptr);

// Returns the keys that let the cobot's links touch something, for example "environment.fixtures.1"
// and "cobot.touches".
std::vector<std::string> LinkContacts(const Scenario& scenario);

// Returns the outward unit normal, in W, of the fixture's side that faces the point p_W.
Vector3 NormalToward(const FixtureSpec& fixture, const Vector3& p_W);
// Returns the same for a surface. For a movable object, this is a side of the shape that is nearest
// to the point. A mesh counts as a ball about its frame's origin. Throws InputError if the model of
// a movable object cannot be read.
Vector3 NormalToward(const Scenario& scenario, const Surface& surface, const Vector3& p_W);

// Returns the model of movable object i. Throws InputError if it cannot be read.
ObjectModel LoadMovable(const Scenario& scenario, std::size_t i);

// Returns the height in W of the lowest point of the object's collision shapes [m], or −∞ if one of
// them is a mesh. X_WO is the pose of the object.
double LowestPoint(const ObjectModel& object, const Pose& X_WO);

// Returns whether the object can come near the floor: the floor has contact, and a person holds the
// handles, or the path of the operator's script brings the lowest point of the object to at most
// kNearFloor above it. X_WO is the pose of the object at the start. An object with a mesh counts as
// near. Throws InputError if the object's model cannot be read.
bool CanReachFloor(const Scenario& scenario, const Pose& X_WO);
inline constexpr double kNearFloor = 0.05;  // [m]

}  // namespace predictor
