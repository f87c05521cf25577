// Fits the impedance of an operator's arm in a plane to its responses to displacements of the
// handle.
//
// With x, v, a the handle's motion in the plane and F the hand's force on the handle:
//
//   F = −M a − D v − K x − g (D v(t − τ) + K x(t − τ)) + voluntary force and noise
//
// The matrices M, D and K are symmetric; g is the gain and τ the delay of the reflex. The hand's
// own noise moves the handle, so that motion and noise are correlated and ordinary least squares is
// biased. The commanded directions are independent of the noise. The directions therefore serve as
// instruments: at each time after the onset, force and motion are regressed on the directions. The
// model is fitted to the resulting mean responses. This method is two-stage least squares (Theil
// 1953) with the direction at each time as instrument. The mean responses contain the noise of each
// displacement, which leaves a bias in the order of 1/N for N displacements. The bias is removed as
// in the jackknife estimator (Angrist, Imbens & Krueger 1999), which predicts each displacement
// from the others. With leverages of 2/N, this correction subtracts 4/N² times the squared errors
// of the single displacements.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace predictor {

inline constexpr int kPlaneParameters = 11;
// M_uu, M_uv, M_vv [kg], D_uu, D_uv, D_vv [N·s/m], K_uu, K_uv, K_vv [N/m], g, τ [s]; u, v are the
// axes of the plane.
using PlaneVector = Eigen::Matrix<double, kPlaneParameters, 1>;
using PlaneMatrix = Eigen::Matrix<double, kPlaneParameters, kPlaneParameters>;
namespace plane {
inline constexpr int kMass = 0, kDamping = 3, kStiffness = 6, kGain = 9, kDelay = 10;
}

// A signal in the plane. Each of the axes u and v has a matrix with a row per time and a column per
// displacement.
using PlaneSignal = std::array<Eigen::MatrixXd, 2>;

// The responses to the displacements, each relative to its mean just before the onset.
struct ArmResponses {
  double dt = 0.001;                                    // [s]
  int before = 0;                                       // number of times before the onset
  PlaneSignal position, velocity, acceleration, force;  // [m], [m/s], [m/s²], [N]
  Eigen::MatrixX2d direction;                           // commanded, of unit length

  int count() const { return static_cast<int>(direction.rows()); }
};

struct ArmFitOptions {
  // The range of a reflex's delay [s] (Pruszynski & Scott 2012: long-latency reflexes, 50 to 100
  // ms).
  double min_delay = 0.03, max_delay = 0.13;
  double bin = 0.005;   // over which the equations are averaged [s]
  int resamples = 200;  // of the bootstrap
  std::uint64_t seed = 1;
};

struct ArmFit {
  PlaneVector value;
  PlaneMatrix covariance;  // by a bootstrap over displacements (Efron & Tibshirani 1993)
  double residual = 0;     // rms of the mean responses' unexplained force [N]
  // Half-width of the 90 % interval.
  double half_width(int parameter) const;
  int count = 0;  // of displacements
};

// Throws InputError if the directions do not span the plane or there are too few displacements.
ArmFit FitArm(const ArmResponses& responses, const ArmFitOptions& options = {});

// For comparison, fits the same model to all data by ordinary least squares. Noise that moves the
// handle biases this result. The function computes no covariance.
PlaneVector FitArmWithoutInstruments(const ArmResponses& responses,
                                     const ArmFitOptions& options = {});

}  // namespace predictor
