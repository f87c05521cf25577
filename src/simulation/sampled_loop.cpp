#include "simulation/sampled_loop.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/linear_algebra.h"
#include "simulation/linearise.h"

namespace predictor {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMinShare = 1e-4, kShareFactor = 0.8;  // of the search for a stable share

// The state at the start of a period consists of the states of Linearise, the torque that was
// computed last, and the torques of the preceding sub-steps, beginning with the latest. The number
// of these preceding sub-steps is the length of the delay in sub-steps.
class Periods {
 public:
  Periods(ControlledScene* scene, Engine* engine, double t)
      : slopes_(SlopesOf(scene, engine, t)),
        timing_(scene->timing()),
        step_(engine->step()),
        n_(engine->dof()),
        joints_(slopes_.by_torque.cols()),
        states_(slopes_.torque.cols()) {
    const double cutoff = scene->wrist().cutoff();
    if (slopes_.sensed > 0) sensor_gain_ = cutoff > 0 ? 1 - std::exp(-cutoff * step_) : 1;
    MatrixXd M(n_, n_), step_matrix(n_, n_);
    engine->MassMatrix(M);
    engine->StepMatrix(step_matrix);
    inertia_ = M.diagonal();
    // Removes three parts of the continuous model, which are the controller, the rate of its
    // sensor, and the implicit integration of joint damping by the engine.
    without_ = slopes_.rates - slopes_.by_torque * slopes_.torque;
    const Eigen::LLT<MatrixXd> factor(step_matrix);
    without_.topRows(n_) = factor.solve(M * without_.topRows(n_));
    by_torque_ = slopes_.by_torque;
    by_torque_.topRows(n_) = factor.solve(M * by_torque_.topRows(n_));
  }

  // Returns the matrix of a period of the controller. The arguments scale the dependence of the
  // controller on positions and on velocities.
  MatrixXd Matrix(double of_stiffness, double of_damping) const {
    MatrixXd torque = slopes_.torque;
    torque.leftCols(n_) *= of_stiffness;
    torque.middleCols(n_, n_) *= of_damping;
    const Index size = states_ + (1 + timing_.delay()) * joints_;
    MatrixXd period = MatrixXd::Identity(size, size);
    for (int i = 0; i < timing_.period(); ++i) {
      if (i == 0) period = Computing(torque, size) * period;
      period = Stepping(size) * period;
    }
    if (states_ > 2 * n_ + slopes_.sensed) period = Remembering(size) * period;
    return period;
  }

  double time() const { return timing_.period_time(); }
  Index velocities() const { return n_; }
  double inertia(Index v) const { return inertia_[v]; }
  // Returns the derivative of a joint's torque with respect to the position or the velocity of the
  // same joint.
  double Torque(Index joint, Index state) const { return slopes_.torque(joint, state); }

 private:
  MatrixXd Computing(const MatrixXd& torque, Index size) const {
    MatrixXd T = MatrixXd::Identity(size, size);
    T.middleRows(states_, joints_).setZero();
    T.block(states_, 0, joints_, states_) = torque;
    return T;
  }

  // A sub-step of the engine is semi-implicit, with v' = v + h a and q' = q + h v'.
  MatrixXd Stepping(Index size) const {
    const Index acting = states_ + timing_.delay() * joints_;  // torque of `delay` sub-steps ago
    MatrixXd rates = MatrixXd::Zero(without_.rows(), size);
    rates.leftCols(states_) = without_;
    rates.middleCols(acting, joints_) += by_torque_;
    MatrixXd T = MatrixXd::Identity(size, size);
    T.middleRows(n_, n_) += step_ * rates.topRows(n_);
    T.topRows(n_) += step_ * T.middleRows(n_, n_);
    if (slopes_.sensed > 0)
      T.middleRows(2 * n_, 6) += sensor_gain_ / slopes_.wrist_rate * rates.middleRows(n_, 6);
    if (timing_.delay() == 0) return T;
    const Index past = timing_.delay() * joints_;
    T.bottomRows(past).setZero();
    T.block(states_ + joints_, states_, past, past).setIdentity();
    return T;
  }

  MatrixXd Remembering(Index size) const {
    const Index first = 2 * n_ + slopes_.sensed, memory = states_ - first;
    MatrixXd T = MatrixXd::Identity(size, size);
    T.block(first, 0, memory, states_) += time() * slopes_.rates.bottomRows(memory);
    return T;
  }

  SceneSlopes slopes_;
  const ControlTiming& timing_;
  double step_;  // [s]
  Index n_, joints_, states_;
  double sensor_gain_ = 0;
  VectorXd inertia_;              // diagonal of the mass matrix
  MatrixXd without_, by_torque_;  // rates without the controller, and by the joints' torques
};

// Writes the growth, the frequency and the velocities of the mode that grows fastest. Returns its
// growth.
double FastestGrowth(const Periods& periods, const MatrixXd& matrix, double* frequency = nullptr,
                     VectorXd* velocities = nullptr) {
  const Modes modes = velocities ? ModesOf(matrix) : Modes{EigenvaluesOf(matrix), {}};
  double growth = -std::numeric_limits<double>::infinity();
  for (Index i = 0; i < matrix.rows(); ++i) {
    const std::complex<double> z = modes.eigenvalues[i];
    const double hertz = std::fabs(std::arg(z)) / (2 * std::numbers::pi * periods.time());
    const double rate = std::log(std::abs(z)) / periods.time();
    if (hertz < SampledLoop::kSlowest || !(rate > growth)) continue;
    growth = rate;
    if (frequency) *frequency = hertz;
    if (velocities)
      *velocities =
          modes.eigenvectors.col(i).segment(periods.velocities(), periods.velocities()).cwiseAbs();
  }
  return growth;
}

double StableShare(const Periods& periods, bool stiffness, bool damping) {
  for (double share = kShareFactor; share > kMinShare; share *= kShareFactor) {
    const MatrixXd matrix = periods.Matrix(stiffness ? share : 1, damping ? share : 1);
    if (FastestGrowth(periods, matrix) <= SampledLoop::kGrowing) return share;
  }
  return 0;
}

}  // namespace

SampledLoop JudgeSampledLoop(ControlledScene* scene, Engine* engine, double t) {
  const Periods periods(scene, engine, t);
  SampledLoop loop;
  VectorXd velocities = VectorXd::Zero(periods.velocities());
  loop.growth = FastestGrowth(periods, periods.Matrix(1, 1), &loop.frequency, &velocities);
  double largest = -1;
  Index at = 0;  // of the joint in the velocities
  for (int j = 0; j < scene->torque().size(); ++j) {
    const Index v = engine->layout().v[static_cast<std::size_t>(j)];
    const double energy = periods.inertia(v) * velocities[v] * velocities[v];
    if (energy <= largest) continue;
    largest = energy;
    loop.joint = j;
    at = v;
  }
  loop.stiffness = -periods.Torque(loop.joint, at);
  loop.damping = -periods.Torque(loop.joint, periods.velocities() + at);
  if (loop.is_stable()) return loop;
  loop.stable_damping = StableShare(periods, false, true);
  loop.stable_stiffness = StableShare(periods, true, false);
  loop.stable_both = StableShare(periods, true, true);
  return loop;
}

}  // namespace predictor
