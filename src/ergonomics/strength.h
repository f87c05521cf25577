// The joint strengths of a population, and the share of the population that can exert a torque.
//
// The mean strengths of elbow and shoulder as functions of the joint angle are from Stobbe, in
// Chaffin & Andersson, Occupational Biomechanics. These strengths are quoted from memory and were
// not verified, because no public copy of the equations was found. The strength of elbow flexion at
// 90° agrees with the book's table of means (men 77 N·m, women 41 N·m; quoted from memory). The
// strengths apply to static, isometric exertions of US industrial workers.
//
// The strengths are not valid for a particular person, for fast movement, for other joints, or for
// the grip of the hand.
#pragma once

#include <array>

#include "core/random.h"
#include "core/sex.h"

namespace predictor::ergonomics {

enum class StrengthDirection {
  kElbowFlexion,
  kElbowExtension,
  kShoulderFlexion,
  kShoulderExtension,
};
inline constexpr int kStrengthDirections = 4;

// The standard deviation of the strength divided by its mean. This ratio is the same for all joints
// (quoted from memory).
inline constexpr double kStrengthVariation = 0.3;
// The correlation between the strengths of two joints of a person (quoted from memory, about 0.7).
inline constexpr double kStrengthCorrelation = 0.7;
// No sampled person is weaker than this share of the mean strength (design choice). Without this
// limit, one person in 2000 would have a negative strength.
inline constexpr double kMinStrengthShare = 0.1;

// Returns the mean strength of one arm [N·m], which is at least 0. `elbow` [rad] is the included
// angle, which is π for a straight arm. `shoulder` [rad] is the angle between trunk and upper arm,
// which is 0 for a hanging arm and positive forwards.
double MeanStrength(StrengthDirection direction, Sex sex, double elbow, double shoulder);

// Returns the share of the population, 0 … 1, whose strength is at least this torque [N·m].
double ShareCapable(double torque, double mean_strength);

// A person's strength in each direction, as a multiple of the mean.
using StrengthShares = std::array<double, kStrengthDirections>;

// Samples a person's strength from a normal distribution with the variation and correlation above.
// The number of random numbers that this function draws is one more than the number of directions.
// Does not allocate.
StrengthShares SampleStrength(RandomStream* random);

}  // namespace predictor::ergonomics
