#include "evaluation/fidelity_perceived.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "core/linear_algebra.h"
#include "evaluation/statistics_samples.h"

namespace predictor {
namespace {

// Weber fractions of hand and arm (Jones 1989: force 7 %; Jones & Hunter 1990 and 1993: stiffness
// 23 %, viscosity 34 %).
constexpr NoticeableDifference kForce = {0.07, 0.10};
constexpr NoticeableDifference kMass = {0.20, 0.20};
constexpr NoticeableDifference kStiffness = {0.22, 0.23};
constexpr NoticeableDifference kViscosity = {0.34, 0.34};
constexpr double kIntervalHalf = 1.645;  // half of a 90 % interval [standard errors]

// The verdict about a difference [share of a] with a standard error. A verdict other than
// kUndecided needs evidence: the whole 90 % interval must support it.
Noticed VerdictOn(double difference, double error, const NoticeableDifference& jnd) {
  // Without repeats, the standard errors are unknown, so the verdict is based only on the values.
  const double half = error == error ? kIntervalHalf * error : 0;
  const double low = difference - half, high = difference + half;
  if (high < jnd.low) return Noticed::kNo;
  if (low > jnd.high) return Noticed::kYes;
  if (low >= jnd.low || high <= jnd.high) return Noticed::kPerhaps;
  return Noticed::kUndecided;
}

// Returns the sum of the forces of both hands along an axis, or an empty result if there are no
// hands.
std::vector<double> TotalForce(const FidelitySignals& signals, const std::string& axis) {
  std::vector<double> total;
  for (const char* hand : {"left", "right"}) {
    const FidelityChannel* channel = FindChannel(signals, std::string(hand) + " force " + axis);
    if (!channel) continue;
    total.resize(channel->samples.size());
    for (std::size_t i = 0; i < total.size(); ++i) total[i] += channel->samples[i];
  }
  return total;
}

// Returns the magnitude of the force of one hand, or an empty result if the hand is absent.
std::vector<double> ForceSize(const FidelitySignals& signals, const std::string& hand) {
  std::vector<double> size;
  for (const char* axis : {"x", "y", "z"}) {
    const FidelityChannel* channel = FindChannel(signals, hand + " force " + axis);
    if (!channel) return {};
    size.resize(channel->samples.size());
    for (std::size_t i = 0; i < size.size(); ++i)
      size[i] = std::hypot(size[i], channel->samples[i]);
  }
  return size;
}

std::span<const double> Part(const std::vector<double>& samples, const SampleRange& range) {
  const std::size_t end = std::min(range.end, samples.size());
  const std::size_t begin = std::min(range.begin, end);
  return std::span(samples).subspan(begin, end - begin);
}

// If the standard deviation of the motion is below this value [m], the hand does not lead the
// object but yields to it. In this case, motion and force show the stiffness and mass of the hand
// itself, with the opposite sign.
constexpr double kLed = 5e-3;

// Smooths a signal with w = (1 − cos)² and differentiates it through integration by parts. The mean
// of x' weighted with w equals the mean of −x weighted with w'. The mean of x'' weighted with w
// equals the mean of x weighted with w'' (modulating functions). Motion and force therefore pass
// through exactly the same filter, and noise is not differentiated sample by sample.
class Kernels {
 public:
  explicit Kernels(std::size_t length) : values_(3, std::vector<double>(length)) {
    const double rate = 2 * std::numbers::pi / static_cast<double>(length);  // [1/sample]
    const double area = 1.5 * static_cast<double>(length);
    for (std::size_t i = 0; i < length; ++i) {
      const double at = rate * (static_cast<double>(i) + 0.5);
      const double c = std::cos(at), s = std::sin(at);
      const double per_second = rate * kFidelityRate;
      values_[0][i] = (1 - c) * (1 - c) / area;
      values_[1][i] = -2 * (1 - c) * s * per_second / area;
      values_[2][i] = 2 * (s * s + (1 - c) * c) * per_second * per_second / area;
    }
  }
  std::size_t size() const { return values_[0].size(); }
  // Returns the smoothed signal (order 0), or its first or second derivative [1/s], [1/s²].
  double Apply(std::size_t order, std::span<const double> samples) const {
    double sum = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) sum += values_[order][i] * samples[i];
    return sum;
  }

 private:
  std::vector<std::vector<double>> values_;
};

struct Estimate {
  double mean = kUndefined, error = kUndefined;
};

// Returns the mean over the parts and its standard error. The parts, and not the samples, are the
// independent repeats.
Estimate OverParts(std::span<const SampleRange> parts,
                   const std::function<double(const SampleRange&)>& figure) {
  std::vector<double> figures;
  for (const SampleRange& part : parts)
    if (const double x = figure(part); x == x) figures.push_back(x);
  return {Mean(figures), SampleDeviation(figures) / std::sqrt(static_cast<double>(figures.size()))};
}

PerceivedQuantity MakeQuantity(const std::string& name, const std::string& unit, const Estimate& a,
                               const Estimate& b, const NoticeableDifference& jnd) {
  PerceivedQuantity quantity;
  quantity.name = name;
  quantity.unit = unit;
  quantity.a = a.mean;
  quantity.b = b.mean;
  quantity.error_a = a.error;
  quantity.error_b = b.error;
  quantity.jnd = jnd;
  return Perceive(quantity);
}

void CompareForces(const FidelitySignals& a, std::span<const SampleRange> parts_a,
                   const FidelitySignals& b, std::span<const SampleRange> parts_b,
                   std::vector<PerceivedQuantity>* to) {
  for (const char* hand : {"left", "right"}) {
    const std::vector<double> force_a = ForceSize(a, hand), force_b = ForceSize(b, hand);
    if (force_a.empty() || force_b.empty()) continue;
    const auto rms = [](const std::vector<double>& force) {
      return [&force](const SampleRange& part) { return RootMeanSquare(Part(force, part)); };
    };
    to->push_back(MakeQuantity(std::string(hand) + " force", "N", OverParts(parts_a, rms(force_a)),
                               OverParts(parts_b, rms(force_b)), kForce));
  }
}

struct Dynamics {
  Estimate mass, viscosity, stiffness;
  bool separable = false;  // mass and stiffness can be distinguished in every part
};

Dynamics DynamicsOf(const FidelitySignals& signals, std::span<const SampleRange> parts,
                    const std::string& axis) {
  const FidelityChannel* position = FindChannel(signals, "position " + axis);
  const std::vector<double> force = TotalForce(signals, axis);
  Dynamics dynamics;
  if (!position || force.empty()) return dynamics;
  double least = 1;
  const auto fit = [&](double ApparentImpedance::*which) {
    return OverParts(parts, [&](const SampleRange& part) {
      const auto impedance = FitImpedance(Part(position->samples, part), Part(force, part));
      least = std::min(least, impedance.separable == impedance.separable ? impedance.separable : 0);
      return impedance.*which;
    });
  };
  dynamics.viscosity = fit(&ApparentImpedance::viscosity);
  dynamics.mass = fit(&ApparentImpedance::mass);
  dynamics.stiffness = fit(&ApparentImpedance::stiffness);
  dynamics.separable = least >= kSeparable;
  return dynamics;
}

}  // namespace

ApparentImpedance FitImpedance(std::span<const double> position, std::span<const double> force,
                               double span) {
  constexpr ApparentImpedance kNone = {kUndefined, kUndefined, kUndefined, kUndefined};
  const Kernels kernels(static_cast<std::size_t>(std::lround(span * kFidelityRate)));
  const std::size_t n = std::min(position.size(), force.size()), length = kernels.size();
  if (n < length + 8) return kNone;
  const auto rows = static_cast<Eigen::Index>(n - length + 1);
  Eigen::MatrixX4d motion(rows, 4);  // v, x, 1, a
  Eigen::VectorXd push(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto x = position.subspan(at, length);
    motion.row(i) << kernels.Apply(1, x), kernels.Apply(0, x), 1, kernels.Apply(2, x);
    push[i] = kernels.Apply(0, force.subspan(at, length));
  }
  const auto spread = [](const Eigen::VectorXd& x) {
    return (x.array() - x.mean()).square().sum();
  };
  const Eigen::VectorXd a = motion.col(3);
  if (!(spread(motion.col(1)) > kLed * kLed * static_cast<double>(rows))) return kNone;
  const Eigen::MatrixXd base = motion.leftCols<3>();
  const Eigen::VectorXd rest = a - base * LeastSquares(base, a);
  ApparentImpedance found;
  found.separable = rest.squaredNorm() / spread(a);
  Eigen::VectorXd solution = LeastSquares(base, push);
  if (found.separable >= kSeparable) {
    solution = LeastSquares(motion, push);
    found.mass = solution[3];
  }
  found.viscosity = solution[0];
  found.stiffness = solution[1];
  return found;
}

PerceivedQuantity Perceive(PerceivedQuantity q) {
  q.difference = (q.b - q.a) / std::abs(q.a);
  q.error = std::hypot(q.error_a * q.b / q.a, q.error_b) / std::abs(q.a);
  q.noticed = VerdictOn(std::abs(q.difference), q.error, q.jnd);
  return q;
}

std::vector<PerceivedQuantity> ComparePerceived(const FidelitySignals& a,
                                                std::span<const SampleRange> parts_a,
                                                const FidelitySignals& b,
                                                std::span<const SampleRange> parts_b) {
  std::vector<PerceivedQuantity> quantities;
  CompareForces(a, parts_a, b, parts_b, &quantities);
  for (const std::string axis : {"x", "y", "z"}) {
    const Dynamics of_a = DynamicsOf(a, parts_a, axis), of_b = DynamicsOf(b, parts_b, axis);
    if (of_a.viscosity.mean != of_a.viscosity.mean || of_b.viscosity.mean != of_b.viscosity.mean)
      continue;
    quantities.push_back(
        MakeQuantity("viscosity " + axis, "N·s/m", of_a.viscosity, of_b.viscosity, kViscosity));
    const bool separable = of_a.separable && of_b.separable;
    if (separable)
      quantities.push_back(MakeQuantity("mass " + axis, "kg", of_a.mass, of_b.mass, kMass));
    quantities.push_back(
        MakeQuantity((separable ? "stiffness " : "stiffness minus ω²·mass ") + axis, "N/m",
                     of_a.stiffness, of_b.stiffness, kStiffness));
  }
  return quantities;
}

}  // namespace predictor
