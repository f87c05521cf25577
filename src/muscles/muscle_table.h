// The muscles of an arm: their names, paths and strengths.
//
// Sources of the paths: attachments and via points were read from the MyoArm model of the package
// myo-sim 0.2.4 (Apache-2.0) in the posture of zero angles. Attachments and via points were
// expressed in the segments of our body, rounded to millimetres and reduced to a few points. Values
// that were read from MyoArm are V, and values that were changed or omitted are D. The wrapping
// obstacles are D. The wrapping obstacles were chosen so that the moment arms agree with measured
// ones (docs/concepts/muscles.md). Sources of the forces: Holzbaur, Murray & Delp 2005 for shoulder
// and elbow, and MyoArm (V) for the forearm. Of the forces from Holzbaur et al., those of triceps,
// biceps and brachialis are V (compared with the public model arm26), and the others are R.
// MyoArm's forces are larger. The forces of the four paths of each finger muscle are added up. The
// muscles of wrist and fingers have half of MyoArm's forces (D). Fibre lengths and pennation are
// from Holzbaur et al. 2005 (V for the same six muscles, R for the others).
#pragma once

#include <array>
#include <span>

namespace predictor::muscles {

// Groups of muscles that are reported together.
enum class MuscleGroup : int {
  kShoulderFlexors,
  kShoulderExtensors,  // and adductors
  kShoulderAbductors,
  kRotatorCuff,
  kElbowFlexors,
  kElbowExtensors,
  kForearm,  // rotation of the forearm, wrist and fingers
};
inline constexpr int kMuscleGroups = 7;
// Returns whether the group's muscles act at the shoulder, where the model is not valid with a
// raised arm.
constexpr bool ActsAtShoulder(int group) {
  return group <= static_cast<int>(MuscleGroup::kRotatorCuff);
}

// A rigid part to which a muscle is attached. The coordinates apply to a right arm in the zero
// posture (hanging, straight, thumb forward). In these coordinates, x points forward, y to the left
// and z up.
enum class Part : int {
  kNone,
  kTorso,     // origin at the shoulder joint; the shoulder girdle does not move relative to it
  kUpperArm,  // origin at the shoulder joint
  kUlna,      // origin at the elbow joint
  kRadius,    // origin at the elbow joint; turns about the forearm's long axis
  kHand,      // origin at the wrist joint
};

// The round obstacles. A muscle takes the shortest path around its obstacle on the given side.
enum class Wrap : int {
  kNone,
  kHead,          // ball about the shoulder joint; the shorter side
  kHeadOuter,     // cylinder about the upper arm's axis; the muscle rotates outward
  kHeadInner,     // cylinder about the upper arm's axis; the muscle rotates inward
  kElbowFront,    // cylinder about the elbow's axis
  kElbowBack,     // cylinder about the elbow's axis
  kForearmOuter,  // cylinder about the forearm's axis; the muscle supinates
  kForearmInner,  // cylinder about the forearm's axis; the muscle pronates
};

// A point of a muscle's path, and the obstacle between this point and the previous one.
struct PathPoint {
  Part part = Part::kNone;
  double x = 0, y = 0, z = 0;  // [mm]
  Wrap wrap = Wrap::kNone;
  double radius = 0;  // radius of the obstacle [mm]
};
inline constexpr int kMaxPathPoints = 7;

struct MuscleSpec {
  const char* name;
  const char* key;  // name in files
  MuscleGroup group;
  double max_force;                            // [N]
  double fibre_length;                         // optimal length [mm]
  double pennation;                            // [°]
  std::array<PathPoint, kMaxPathPoints> path;  // origin first; ends at the first kNone
};

inline constexpr int kMuscles = 33;
std::span<const MuscleSpec, kMuscles> MuscleTable();

// The lengths of the segments in which the points are given [m]. The points scale with the lengths
// of a body's own segments.
inline constexpr double kTableUpperArm = 0.2904, kTableForearm = 0.2535, kTableHand = 0.080;

}  // namespace predictor::muscles
