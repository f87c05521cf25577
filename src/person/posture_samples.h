// Computes the uncertainty of posture and loads, because two hands and a head do not determine a
// body's posture.
#pragma once

#include <span>
#include <vector>

#include "person/body_loads.h"
#include "person/posture_angles.h"
#include "person/posture_solver.h"

namespace predictor::person {

// The standard deviations of all quantities that must be assumed. All these values are our choice
// (D). The project's reference also states ±15° for the swivel angle.
struct PostureSpread {
  double swivel = 0.262;  // swivel of each elbow, 15°; half of the variance is common to both [rad]
  double pelvis_forward = 0.03;    // [m]
  double pelvis_sideways = 0.02;   // [m]
  double pelvis_tilt = 0.087;      // 5° [rad]
  double spine_share = 0.7;        // logarithms of the weights of torso, pelvis and lowering
  double neck = 0.26;              // 15° [rad]
  double comfort = 0.12;           // comfortable angle of each arm joint [rad]
  double length = 0.05;            // length of each segment that is not measured, as a fraction
  double segment_mass = 0.05;      // share of the mass of each segment, as a fraction
  double back_muscle_arm = 0.006;  // [m]
};

// Of 64 samples, the third smallest and the third largest enclose another sample of the same kind
// with probability 59/65 = 0.91.
inline constexpr int kPostureSamples = 64;

// The median and the 90 % interval of one value.
struct Interval {
  double median = 0, low = 0, high = 0;
};
// Returns the median and the ⌊n/20⌋-th smallest and largest values. For 64 values, these are the
// third smallest and the third largest. Reorders `values`. Throws std::invalid_argument if `values`
// is empty.
Interval IntervalOf(std::span<double> values);

// One possible person.
struct SampledPosture {
  BodyVector q;
  PostureAngles angles;
  BodyLoads loads;
  bool reached = false;  // the hands reach the handles
  double miss = 0;       // largest distance by which a hand misses its handle [m]
};

// Draws kPostureSamples people once, in pairs of opposite deviations, and evaluates all of them at
// each time (common random numbers).
class PostureSampler {
 public:
  PostureSampler(const BodySpec& spec, const Stance& stance, const std::array<Grip, kHands>& grips);

  // `nominal` is the motion of the nominal posture. All samples use the velocities and
  // accelerations of the nominal motion. The postures of the samples are solved for this time
  // alone, starting from the nominal posture. Returns the kPostureSamples people, who are the same
  // at every time.
  std::vector<SampledPosture> Evaluate(const BodySample& sample, const BodyMotion& nominal) const;
  // Evaluates one of the kPostureSamples people.
  SampledPosture EvaluatePerson(std::size_t i, const BodySample& sample,
                                const BodyMotion& nominal) const;

  // Returns the body of the k-th sample.
  const BodyModel& model(std::size_t k) const { return persons_[k].solver.model(); }

 private:
  struct Person {
    PostureSolver solver;
    BodyDynamics dynamics;
  };
  std::vector<Person> persons_;
};

// Returns a person with a different posture. The prior's comfort, swivel and weights change by
// `spread` times kPriorVariations standard normal numbers.
inline constexpr int kPriorVariations = 3 + 4 + 4 + 2 + kHands * kArmJoints;
PosturePrior VariedPrior(const PosturePrior& prior, std::span<const double> z,
                         const PostureSpread& spread);

// Returns a person with different lengths and masses. Each length or mass is multiplied by 1 +
// spread · z. The 9 standard normal numbers z are for upper arm, forearm, hand, shoulder distance,
// trunk, and the masses of torso, upper arm, forearm and hand. Lengths that are measured in `spec`
// are unchanged. The mass of the whole body is unchanged, because the pelvis takes the difference.
Anthropometry VariedBody(const BodySpec& spec, std::span<const double> z, double length,
                         double mass);
inline constexpr int kBodyVariations = 9;

}  // namespace predictor::person
