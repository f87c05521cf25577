// The impedance of an operator's arm, as a distribution.
#pragma once

#include <array>
#include <string>

#include "core/random.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// The impedance of one arm, as felt at the handle.
struct ArmImpedance {
  Vector3 stiffness;              // along W's axes [N/m]
  double damping_ratio = 0;       // D = 2 ζ √(mass · stiffness)
  double mass = 0;                // mass that moves with the handle [kg]
  double reflex_gain = 0;         // share of stiffness and damping that acts with a delay
  double reflex_delay = 0;        // [s]
  double rotation_stiffness = 0;  // [N·m/rad]
  double rotation_damping = 0;    // [N·m·s/rad]

  Vector3 Damping() const;  // [N·s/m]
};

inline constexpr int kArmParameters = 7;
// The names are "stiffness_x", "stiffness_y", "stiffness_z", "damping_ratio", "mass", "reflex_gain"
// and "reflex_delay".
extern const std::array<const char*, kArmParameters> kArmParameterNames;

// All parameters are log-normal, except for the reflex gain, which is normal. They may be
// correlated. The rotational impedance scales with the geometric mean of the stiffness.
class ArmDistribution {
 public:
  using Vector = Eigen::Matrix<double, kArmParameters, 1>;
  using Matrix = Eigen::Matrix<double, kArmParameters, kArmParameters>;

  // Returns the distribution that this project assumes for people whose arms were not identified,
  // centred on `hand`. The standard deviations of the logarithms are 0.35 (stiffness, common to all
  // axes), 0.2 (in addition for each axis), 0.35 (damping ratio), 0.3 (mass) and 0.2 (reflex
  // delay). The standard deviation of the reflex gain is 0.15. These standard deviations are design
  // choices. With the default hand, these standard deviations put 95 % of the people within the
  // ranges that Mussa-Ivaldi et al. 1985, Tsuji et al. 1995, Dolan et al. 1993 and Pruszynski &
  // Scott 2012 report. The ranges are quoted from the project's reference and were not checked
  // again.
  static ArmDistribution Prior(const HandSpec& hand);
  // Makes the distribution from the mean and the covariance of the parameters themselves, in their
  // units. Throws InputError if a mean is not positive or the matrix is not a covariance.
  static ArmDistribution FromMoments(const Vector& mean, const Matrix& covariance,
                                     const HandSpec& hand, const std::string& source);
  // Reads mean and covariance from JSON: {"predictor_arm": 1, "source": "...", "parameters": [...],
  // "mean": [...], "covariance": [[...]]}. Parameters that are missing in the file keep their
  // prior. Throws InputError.
  static ArmDistribution Read(const std::string& file, const HandSpec& hand);

  ArmImpedance Draw(RandomStream* random) const;
  const std::string& source() const { return source_; }  // a sentence for the user
  // Returns a quantile of the marginal distribution of a parameter. The probability is 0.05, 0.5 or
  // 0.95.
  double Percentile(int parameter, double probability) const;

 private:
  ArmImpedance Make(const Vector& x) const;

  Vector mean_ = Vector::Zero();  // mean of the logarithms and of the reflex gain
  Matrix covariance_ = Matrix::Zero();
  Matrix root_ = Matrix::Zero();  // root · rootᵀ is the covariance
  double rotation_stiffness_ = 0, rotation_damping_ = 0, reference_ = 1;
  std::string source_;
};

}  // namespace predictor
