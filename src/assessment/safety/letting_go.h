// Judges what could happen to a person who lets go of the handles: the object falls, the object or
// the cobot hits the person or clamps a part of the body, or the person stands too close to the
// moving cobot.
//
// These are unintended contacts. The limits for such contact do not apply to the forces at the
// handles, which the person intends.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assessment/person_setup.h"
#include "core/record.h"
#include "ergonomics/contact_limits.h"
#include "models/object_model.h"
#include "scenario/scenario.h"

namespace predictor::assessment {

// Masses of the virtual scene [kg].
struct SceneMasses {
  double cobot = 0;  // mass of the links that its joints move
  double object = 0;
};

// The motion of the virtual object and the cobot's end-effector in RUN.
class SceneMotion {
 public:
  struct Sample {
    double time = 0;                         // run time [s]
    Vector3 object = Vector3::Zero();        // origin of the object, in W [m]
    Vector3 end_effector = Vector3::Zero();  // in W [m]
    double object_speed = 0;                 // of its fastest point [m/s]
    double end_effector_speed = 0;           // of the origin [m/s]
    double speed() const { return std::max(object_speed, end_effector_speed); }
  };

  // The fastest point of the object is the fastest of its origin, the given points of its outline
  // and the virtual handles.
  explicit SceneMotion(std::vector<OutlinePoint> outline = {}) : outline_(std::move(outline)) {}
  // Adds the next record, in order.
  void Add(const TickRecord& record);

  bool empty() const { return !any_; }
  bool knows_the_outline() const { return !outline_.empty(); }
  const Sample& fastest() const { return fastest_; }
  const Sample& highest() const { return highest_; }  // the object's highest place
  // Returns, for each release by a hand of a simulated operator, the time of the greatest speed
  // before the hands hold again.
  const std::vector<Sample>& releases() const { return releases_; }
  // Returns the smallest upward force of a hand while the hand held a handle [N], or infinity if
  // the hand never held a handle.
  double min_lift(int hand) const { return min_lift_[static_cast<std::size_t>(hand)]; }

 private:
  Sample SampleOf(const TickRecord& record) const;

  std::vector<OutlinePoint> outline_;  // in O
  bool any_ = false, released_ = false;
  Sample fastest_, highest_;
  std::vector<Sample> releases_;
  std::array<double, kHands> min_lift_ = {INFINITY, INFINITY};  // [N]
  int gripping_ = 0;
};

// The fall of the object if the cobot lets go of the object at the object's highest position in the
// run.
struct Drop {
  double time = 0;         // run time of the highest place [s]
  double height = 0;       // height of the object's origin above the ground [m]
  double speed = 0;        // speed at the ground, √(2 g h) [m/s]
  double energy = 0;       // m g h [J]
  double beside_feet = 0;  // horizontal distance of the object's origin from the feet [m]; 0: above
                           // them
  // Weight that a hand would suddenly carry, and its difference from the smallest force that the
  // hand carried in the run [N]; if both hands hold, each carries half of the weight.
  double weight_of_hand = 0, jump = 0;
};

// The distance that a person needs from a cobot that does not detect that the hands let go,
// according to ISO 13855 (mark R): S = v_h (T_r + T_s) + v_r T_r + v_r² / 2a. The intrusion
// distance C and the uncertainties Z are not included, because they belong to a sensor that this
// scene does not have.
struct Separation {
  double time = 0;      // run time [s]
  double speed = 0;     // v_r: speed of the object's fastest point or of the end-effector's origin,
                        // whichever is faster [m/s]
  double needed = 0;    // S [m]
  double distance = 0;  // horizontal distance from the point between the feet to the nearer of
                        // object and end-effector [m]
};
inline constexpr double kApproachSpeed = 1.6;   // v_h of a walking person (R) [m/s]
inline constexpr double kReactionTime = 0.1;    // T_r (D) [s]
inline constexpr double kStopDeceleration = 5;  // a, so that T_s = v_r / a (D) [m/s²]
double NeededSeparation(double robot_speed);    // S [m]

// A region of the body that the object or the cobot hits or clamps. Only the force is judged,
// because the pressure depends on the unknown shape of the contact surface.
struct RegionCheck {
  ergonomics::ContactLimit limit;
  double max_speed = 0;  // speed at which the force limit is reached [m/s]; 0: must not be hit
  double share = 0;      // largest speed of the run / max_speed
};

struct UnintendedContact {
  std::string edition;               // edition of the limits
  double robot_mass = 0;             // effective [kg]
  double speed = 0;                  // largest SceneMotion::Sample::speed of the run [m/s]
  double time = 0;                   // run time of that speed [s]
  std::vector<RegionCheck> regions;  // transient contact, each region once
  // The largest force with which the cobot can clamp a part of the body, or no value if the
  // scenario sets no bound.
  std::optional<double> clamping_force;  // [N]
  std::vector<RegionCheck> clamped;      // `share`: clamping force / quasi-static limit
  // The bodies of the surroundings against which the object or the cobot can clamp: "the floor",
  // "the table", and the names or shapes of the fixtures.
  std::vector<std::string> fixtures;
};

Drop DropOf(const SceneMotion& motion, const SceneMasses& masses, const PersonSetup& setup,
            const Scenario& scenario);
// Returns the separation for the release with the largest shortfall of the distance. If there was
// no release, returns the separation at the moment of the highest speed.
Separation SeparationOf(const SceneMotion& motion, const PersonSetup& setup);
std::vector<std::string> ClampingFixtures(const Scenario& scenario);
UnintendedContact ContactOf(const SceneMotion& motion, const SceneMasses& masses,
                            const ergonomics::ContactLimits& limits, const Scenario& scenario);

}  // namespace predictor::assessment
