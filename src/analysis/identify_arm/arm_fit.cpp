#include "analysis/identify_arm/arm_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/random.h"

namespace predictor {
namespace {

constexpr double kShrinkage = 0.02;  // share of the mean variance added to the noise's covariance
constexpr double kMaxGain = 3;       // of a reflex
constexpr int kMaxSteps = 40;
constexpr double kMinDecrease = 1e-14;  // relative decrease of the squared error that counts as one
constexpr int kWhitenings = 2;          // repetitions of estimating the noise
constexpr double kDelayStep = 0.02;     // between the starts of the search [s]

// The basis of symmetric matrices.
const std::array<Eigen::Matrix2d, 3>& Units() {
  static const std::array<Eigen::Matrix2d, 3> units = [] {
    std::array<Eigen::Matrix2d, 3> m;
    m[0] << 1, 0, 0, 0;
    m[1] << 0, 1, 1, 0;
    m[2] << 0, 0, 0, 1;
    return m;
  }();
  return units;
}

Eigen::Matrix2d Symmetric(const PlaneVector& p, int first) {
  Eigen::Matrix2d m;
  m << p[first], p[first + 1], p[first + 1], p[first + 2];
  return m;
}

PlaneSignal Times(const Eigen::Matrix2d& m, const PlaneSignal& s) {
  return {m(0, 0) * s[0] + m(0, 1) * s[1], m(1, 0) * s[0] + m(1, 1) * s[1]};
}

PlaneSignal Combined(const PlaneSignal& a, double factor, const PlaneSignal& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1]};
}

// Returns a signal as one matrix: a row per time, with a column per displacement for axis u and
// then for axis v.
Eigen::MatrixXd Beside(const PlaneSignal& s) {
  Eigen::MatrixXd m(s[0].rows(), 2 * s[0].cols());
  m << s[0], s[1];
  return m;
}

// The equations for one set of responses on a given time grid.
class Equations {
 public:
  Equations(const ArmResponses& r, const ArmFitOptions& options)
      : r_(r),
        bin_(std::max(1, static_cast<int>(std::lround(options.bin / r.dt)))),
        bins_((static_cast<int>(r.position[0].rows()) - r.before) / bin_),
        position_(Binned(r.position, 0)),
        velocity_(Binned(r.velocity, 0)),
        acceleration_(Binned(r.acceleration, 0)),
        force_(Beside(Binned(r.force, 0))) {}

  int bins() const { return bins_; }

  // Returns the measured minus the modelled force and, if requested, the derivatives of the
  // modelled force.
  Eigen::MatrixXd Residual(const PlaneVector& p,
                           std::array<Eigen::MatrixXd, kPlaneParameters>* slopes) const {
    const Eigen::Matrix2d M = Symmetric(p, plane::kMass), D = Symmetric(p, plane::kDamping),
                          K = Symmetric(p, plane::kStiffness);
    const double gain = p[plane::kGain], delay = p[plane::kDelay];
    const PlaneSignal late_x = Binned(r_.position, delay), late_v = Binned(r_.velocity, delay);
    const PlaneSignal x = Combined(position_, gain, late_x), v = Combined(velocity_, gain, late_v);
    const Eigen::MatrixXd modelled =
        -Beside(Combined(Combined(Times(M, acceleration_), 1, Times(D, v)), 1, Times(K, x)));
    if (slopes) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Matrix2d& unit = Units()[static_cast<std::size_t>(k)];
        const auto at = [&](int first) -> Eigen::MatrixXd& {
          return (*slopes)[static_cast<std::size_t>(first + k)];
        };
        at(plane::kMass) = -Beside(Times(unit, acceleration_));
        at(plane::kDamping) = -Beside(Times(unit, v));
        at(plane::kStiffness) = -Beside(Times(unit, x));
      }
      (*slopes)[plane::kGain] = -Beside(Combined(Times(D, late_v), 1, Times(K, late_x)));
      // d x(t − τ)/dτ = −v(t − τ)
      (*slopes)[plane::kDelay] =
          gain * Beside(Combined(Times(D, Binned(r_.acceleration, delay)), 1, Times(K, late_v)));
    }
    return force_ - modelled;
  }

 private:
  // Returns averages over bins after the onset, for the signal `delay` [s] earlier, which is
  // interpolated linearly.
  PlaneSignal Binned(const PlaneSignal& signal, double delay) const {
    const double shift = delay / r_.dt;
    const int whole = static_cast<int>(std::floor(shift));
    const double rest = shift - whole;
    PlaneSignal result;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Eigen::MatrixXd& s = signal[axis];
      result[axis].resize(bins_, s.cols());
      for (int b = 0; b < bins_; ++b) {
        const int first = r_.before + b * bin_ - whole;
        result[axis].row(b) = (1 - rest) * s.middleRows(first, bin_).colwise().mean();
        if (rest > 0) result[axis].row(b) += rest * s.middleRows(first - 1, bin_).colwise().mean();
      }
    }
    return result;
  }

  const ArmResponses& r_;
  int bin_, bins_;
  PlaneSignal position_, velocity_, acceleration_;
  Eigen::MatrixXd force_;
};

// Fits by the Levenberg-Marquardt method, with errors whitened by the inverse of `root`.
class LevenbergMarquardt {
 public:
  LevenbergMarquardt(const Equations& equations, const Eigen::MatrixXd& root,
                     const ArmFitOptions& options)
      : equations_(equations), root_(root), options_(options) {}

  // Makes the fit subtract `share` times the squared errors of the equations `all`.
  void Correct(const Equations& all, double share) {
    all_ = &all;
    share_ = share;
  }

  struct Result {
    PlaneVector value;
    double cost = std::numeric_limits<double>::infinity();
  };

  Result From(const PlaneVector& p) const {
    PlaneMatrix H;
    PlaneVector g;
    Result best = {p, Linearise(p, &H, &g)};
    double damping = 1e-3;
    for (int i = 0; i < kMaxSteps && damping < 1e8; ++i) {
      PlaneMatrix A = H;
      // If the reflex has no gain, its delay has no effect, so the column of the delay is zero.
      A.diagonal() += damping * (H.diagonal() + PlaneVector::Constant(1e-12 * H.trace()));
      const PlaneVector next = Bounded(best.value + A.ldlt().solve(g));
      PlaneMatrix next_H;
      PlaneVector next_g;
      const double cost = Linearise(next, &next_H, &next_g);
      if (!(cost < best.cost)) {
        damping *= 10;
        continue;
      }
      const bool done = best.cost - cost <= kMinDecrease * std::abs(best.cost);
      best = {next, cost};
      H = next_H;
      g = next_g;
      damping = std::max(1e-12, damping / 10);
      if (done) break;
    }
    return best;
  }

  // Starts from several delays, because the error has several minima.
  Result Everywhere() const {
    Result best;
    for (double delay = options_.min_delay + kDelayStep / 2; delay < options_.max_delay;
         delay += kDelayStep) {
      PlaneVector start;
      start << 1, 0, 1, 8, 0, 8, 150, 0, 150, 0.3, delay;
      const Result found = From(start);
      if (found.cost < best.cost) best = found;
    }
    return best;
  }

 private:
  PlaneVector Bounded(PlaneVector p) const {
    p[plane::kGain] = std::clamp(p[plane::kGain], 0.0, kMaxGain);
    p[plane::kDelay] = std::clamp(p[plane::kDelay], options_.min_delay, options_.max_delay);
    return p;
  }

  double Linearise(const PlaneVector& p, PlaneMatrix* H, PlaneVector* g) const {
    const double cost = Linearise(equations_, p, H, g);
    if (!all_) return cost;
    PlaneMatrix all_H;
    PlaneVector all_g;
    const double all_cost = Linearise(*all_, p, &all_H, &all_g);
    *H -= share_ * all_H;
    *g -= share_ * all_g;
    return cost - share_ * all_cost;
  }

  double Linearise(const Equations& equations, const PlaneVector& p, PlaneMatrix* H,
                   PlaneVector* g) const {
    std::array<Eigen::MatrixXd, kPlaneParameters> slopes;
    Eigen::MatrixXd residual = equations.Residual(p, &slopes);
    const auto L = root_.triangularView<Eigen::Lower>();
    L.solveInPlace(residual);
    for (Eigen::MatrixXd& slope : slopes) L.solveInPlace(slope);
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      (*g)[row] = slopes[i].cwiseProduct(residual).sum();
      for (std::size_t j = 0; j <= i; ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        (*H)(row, column) = (*H)(column, row) = slopes[i].cwiseProduct(slopes[j]).sum();
      }
    }
    return residual.squaredNorm();
  }

  const Equations& equations_;
  const Eigen::MatrixXd& root_;
  const ArmFitOptions& options_;
  const Equations* all_ = nullptr;
  double share_ = 0;
};

// Returns the mean responses to displacements along u and v, by regression on the directions with a
// constant. The function uses a weight for each displacement.
ArmResponses MeanResponses(const ArmResponses& r, const Eigen::VectorXd& weight) {
  const Eigen::RowVector2d mean = (weight.transpose() * r.direction) / weight.sum();
  const Eigen::MatrixX2d centred = r.direction.rowwise() - mean;
  const Eigen::MatrixX2d weighted = weight.asDiagonal() * centred;
  const Eigen::Matrix2d S = weighted.transpose() * centred;
  if (!(std::abs(S.determinant()) > 1e-3 * S.trace() * S.trace()))
    throw InputError(
        "The displacements lie along one line, but identification of the arm needs displacements "
        "in a plane. Record displacements in at least four directions.");
  const Eigen::MatrixX2d share = weighted * S.inverse();
  ArmResponses result;
  result.dt = r.dt;
  result.before = r.before;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    result.position[axis] = r.position[axis] * share;
    result.velocity[axis] = r.velocity[axis] * share;
    result.acceleration[axis] = r.acceleration[axis] * share;
    result.force[axis] = r.force[axis] * share;
  }
  result.direction = Eigen::Matrix2d::Identity();
  return result;
}

// Returns a square root of the covariance over time of the forces that the model does not explain.
Eigen::MatrixXd NoiseRoot(const Equations& all, const PlaneVector& p) {
  const Eigen::MatrixXd e = all.Residual(p, nullptr);
  Eigen::MatrixXd C = e * e.transpose() / static_cast<double>(e.cols());
  const double mean = C.trace() / static_cast<double>(C.rows());
  C.diagonal().array() += kShrinkage * mean + 1e-18;
  return C.llt().matrixL();
}

// The equations are weighted by the inverse of a noise covariance of `times` dimensions. This
// covariance is estimated from the 2 N response curves of N displacements. In the following
// formulas, n is the number of curves, p is the number of times, and q is the number of parameters
// per curve. The variance of the estimate is (n − 1)/(n − 1 − (p − q)) times the variance with the
// true covariance. The variance that is computed with the estimated covariance is too small by the
// factor (n − (p − q))/n (Rao 1967, "Least squares theory using an estimated dispersion matrix";
// Williams 1967). The result is the product of both corrections. The parameters belong to four mean
// curves.
double NoiseIsEstimated(int count, int times) {
  const double n = 2.0 * count, surplus = times - kPlaneParameters / 4.0;
  return n / (n - surplus) * (n - 1) / (n - 1 - surplus);
}

}  // namespace

// Student's quantile, approximated by the first term of its expansion (Abramowitz & Stegun 26.7.5).
double ArmFit::half_width(int parameter) const {
  constexpr double kZ = 1.6448536269514722;
  const double freedom = std::max(4, count - kPlaneParameters);
  return kZ * (1 + (kZ * kZ + 1) / (4 * freedom)) * std::sqrt(covariance(parameter, parameter));
}

ArmFit FitArm(const ArmResponses& r, const ArmFitOptions& options) {
  const int count = r.count();
  if (count < 2 * kPlaneParameters)
    throw InputError("There are only " + std::to_string(count) +
                     " usable displacements; at least " + std::to_string(2 * kPlaneParameters) +
                     " are needed. Record a longer run.");
  const ArmResponses mean = MeanResponses(r, Eigen::VectorXd::Ones(count));
  const Equations equations(mean, options), all(r, options);
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(equations.bins(), equations.bins());
  ArmFit fit;
  fit.count = count;
  fit.value = LevenbergMarquardt(equations, root, options).Everywhere().value;
  for (int k = 0; k < kWhitenings; ++k) {
    root = NoiseRoot(all, fit.value);
    fit.value = LevenbergMarquardt(equations, root, options).Everywhere().value;
  }
  const PlaneVector uncorrected = fit.value;
  LevenbergMarquardt corrected(equations, root, options);
  corrected.Correct(all, 4.0 / (static_cast<double>(count) * count));
  fit.value = corrected.From(uncorrected).value;
  const Eigen::MatrixXd rest = equations.Residual(fit.value, nullptr);
  fit.residual = std::sqrt(rest.squaredNorm() / static_cast<double>(rest.size()));

  RandomStream random(options.seed, "identify arm");
  Eigen::MatrixXd drawn(kPlaneParameters, options.resamples);
  for (int k = 0; k < options.resamples; ++k) {
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(count);
    for (int i = 0; i < count; ++i)
      weight[std::min(count - 1, static_cast<int>(count * random.Uniform()))] += 1;
    const ArmResponses resampled = MeanResponses(r, weight);
    const Equations again(resampled, options);
    drawn.col(k) = LevenbergMarquardt(again, root, options).From(uncorrected).value;
  }
  const Eigen::MatrixXd deviation = drawn.colwise() - PlaneVector(drawn.rowwise().mean());
  fit.covariance = NoiseIsEstimated(count, equations.bins()) * deviation * deviation.transpose() /
                   (options.resamples - 1.0);
  return fit;
}

PlaneVector FitArmWithoutInstruments(const ArmResponses& r, const ArmFitOptions& options) {
  const Equations all(r, options);
  const Eigen::MatrixXd root = Eigen::MatrixXd::Identity(all.bins(), all.bins());
  return LevenbergMarquardt(all, root, options).Everywhere().value;
}

}  // namespace predictor
