#include "haptics/stability.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kFrequencies = 160;
constexpr double kLowest = 0.1;    // [Hz]
constexpr double kHighest = 100;   // [Hz]
constexpr double kNoLimit = 1000;  // a margin beyond this says nothing more

using Complex = std::complex<double>;

// Damping of a hand's axis.
double HandDamping(const HandSpec& hand, double stiffness) {
  return 2 * hand.damping_ratio * std::sqrt(hand.mass * stiffness);
}

// Pairs the eigenvalues of one frequency with those of the next, nearest first.
void Follow(const Eigen::VectorXcd& before, Eigen::VectorXcd* now) {
  for (int i = 0; i < before.size(); ++i) {
    int best = i;
    for (int j = i + 1; j < now->size(); ++j)
      if (std::abs((*now)[j] - before[i]) < std::abs((*now)[best] - before[i])) best = j;
    std::swap((*now)[i], (*now)[best]);
  }
}

}  // namespace

double HapticLoop::Lag(const VelocityLoopSpec& loop, double dt) {
  return 2 * loop.damping_ratio / (2 * kPi * loop.bandwidth) + loop.delay - dt / 2;
}

HapticLoop::HapticLoop(const LinearModel& world, const Scenario& scenario, double dt)
    : scenario_(scenario), dt_(dt) {
  const Eigen::Index n = world.A.rows();
  omega_.resize(kFrequencies);
  admittance_.resize(kFrequencies);
  for (int k = 0; k < kFrequencies; ++k) {
    const double f = kLowest * std::pow(kHighest / kLowest, k / (kFrequencies - 1.0));
    omega_[k] = 2 * kPi * f;
    Eigen::MatrixXcd sI = -world.A.cast<Complex>();
    for (Eigen::Index i = 0; i < n; ++i) sI(i, i) += Complex(0, omega_[k]);
    admittance_[k] = world.C.cast<Complex>() * sI.partialPivLu().solve(world.B.cast<Complex>());
  }
}

std::array<Complex, 12> HapticLoop::HandAndDevice(const HandSpec& hand, double lead, double omega) const {
  const Complex s(0, omega);
  const RenderingSpec& r = scenario_.rendering;
  std::array<Complex, 12> diagonal;
  diagonal.fill(0);
  for (int i = 0; i < kHands; ++i) {
    if (!scenario_.Has(i)) continue;
    const ArmSpec& arm = scenario_.arm(i);
    const double w = 2 * kPi * arm.loop.bandwidth;
    const Complex arm_loop = w * w / (s * s + 2.0 * arm.loop.damping_ratio * w * s + w * w) *
                             std::exp(-s * (arm.loop.delay + dt_ / 2));
    const Complex low_pass = 1.0 / (1.0 + s / (2 * kPi * r.lead_cutoff));
    // The estimate of the wrench: the sensor's filter and delay, and a tick until it is used.
    Complex sensor = std::exp(-s * (arm.sensor.delay + dt_));
    if (arm.sensor.low_pass > 0) sensor /= 1.0 + s / (2 * kPi * arm.sensor.low_pass);
    for (int axis = 0; axis < 6; ++axis) {
      const bool turn = axis >= 3;
      const double gain = turn ? r.ko / 2 : r.kp;  // (9) takes half the angle
      const Complex device = arm_loop * (1.0 + lead * low_pass * s + gain / s) / (1.0 + arm_loop * gain / s);
      const double stiffness = turn ? hand.rotation_stiffness : hand.stiffness[axis];
      const double damping = turn ? hand.rotation_damping : HandDamping(hand, stiffness);
      Complex impedance = (stiffness / s + damping) * (1.0 + hand.reflex_gain * std::exp(-s * hand.reflex_delay));
      if (!turn) {
        impedance += hand.visual_stiffness[axis] / s * std::exp(-s * hand.visual_delay);
        impedance += hand.mass * s;
      }
      diagonal[static_cast<std::size_t>(6 * i + axis)] = sensor * impedance * device;
    }
  }
  return diagonal;
}

StabilityMargin HapticLoop::Margin(const HandSpec& hand, double lead) const {
  StabilityMargin margin{kNoLimit, 0};
  Eigen::VectorXcd before;
  Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(12);
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    const auto diagonal = HandAndDevice(hand, lead, omega_[k]);
    Eigen::MatrixXcd L = admittance_[k];
    for (int row = 0; row < 12; ++row) L.row(row) *= diagonal[static_cast<std::size_t>(row)];
    solver.compute(L, false);
    Eigen::VectorXcd now = solver.eigenvalues();
    if (k > 0) Follow(before, &now);
    for (int i = 0; k > 0 && i < now.size(); ++i) {
      // A locus that crosses the negative real axis at −x leaves 1/x of gain.
      const double a = before[i].imag();
      const double b = now[i].imag();
      if (a * b > 0 || a == b) continue;
      const double t = a / (a - b);
      const double x = before[i].real() + t * (now[i].real() - before[i].real());
      if (x >= 0 || -1 / x >= margin.gain) continue;
      margin.gain = -1 / x;
      margin.frequency = (omega_[k - 1] + t * (omega_[k] - omega_[k - 1])) / (2 * kPi);
    }
    before = now;
  }
  return margin;
}

LeadChoice ChooseLead(const HapticLoop& loop, const Scenario& scenario, double dt, double margin) {
  LeadChoice best;
  for (int i = 0; i < kHands; ++i)
    if (scenario.Has(i)) best.lag = std::max(best.lag, HapticLoop::Lag(scenario.arm(i).loop, dt));
  constexpr int kSteps = 5;
  for (int k = kSteps; k >= 0; --k) {
    const double lead = best.lag * k / kSteps;
    const StabilityMargin m = loop.Margin(scenario.operator_.hand, lead);
    if (m.gain <= best.margin.gain) continue;
    best.lead = lead;
    best.margin = m;
    if (m.gain >= margin) break;
  }
  return best;
}

}  // namespace predictor
