// A muscle with a stiff tendon: the force that its fibres can produce at a given length and
// velocity.
//
// The letter at each number states the number's origin. V: agrees with an independent copy. R:
// quoted from memory of the literature. D: our choice.
#pragma once

namespace predictor::muscles {

struct MuscleParameters {
  double max_force = 0;     // isometric force of fully active fibres at their optimal length [N]
  double fibre_length = 0;  // optimal length [m]
  double pennation = 0;     // angle between fibres and tendon at the optimal length [rad]
  double tendon_slack = 0;  // length of the tendon, which does not stretch [m]
};

// The state of the fibres at one time. If the path is shorter than the tendon, the fibres are
// slack, so their length and forces are zero.
struct Fibre {
  double length = 0;         // relative to the optimal length
  double velocity = 0;       // positive while lengthening, relative to kMaxVelocity
  double cos_pennation = 1;  // the muscle's thickness is constant (Zajac 1989, R)
};
// path_length [m] and its rate [m/s] are those of the whole path from origin to insertion.
Fibre FibreOf(const MuscleParameters& muscle, double path_length, double path_rate);

// The shortening velocity at which the force is zero, in optimal lengths per second (Thelen 2003,
// V: the default of a public simulator).
inline constexpr double kMaxVelocity = 10;

// Returns the active force of fibres at full activation over max_force, exp(-(l - 1)² / 0.45)
// (Thelen 2003, R).
double ActiveForceLength(double length);
// Returns the passive force over max_force, (exp(4 (l - 1) / 0.6) - 1) / (exp(4) - 1) above the
// optimal length, else 0 (Thelen 2003, R).
double PassiveForceLength(double length);
// Returns the factor by which the velocity v changes the active force (V: MuJoCo's muscle with
// fvmax 1.2). While shortening, the factor is (1 + v)², and it is 0 below -1. While lengthening,
// the factor is 1.2 - (0.2 - v)² / 0.2 up to v = 0.2, and 1.2 above.
double ForceVelocity(double velocity);

// The forces along the tendon [N]: `active` at full activation, and `passive` without activation.
struct TendonForces {
  double active = 0, passive = 0;
};
TendonForces ForcesOf(const MuscleParameters& muscle, const Fibre& fibre);

}  // namespace predictor::muscles
