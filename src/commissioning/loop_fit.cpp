#include "commissioning/loop_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/format.h"
#include "core/linear_algebra.h"
#include "rig/velocity_loop.h"

namespace predictor::commissioning {
namespace {

constexpr double kNoLimit = 1e9;
constexpr int kParameters = 4;        // ln bandwidth, ln damping ratio, delay, gain
constexpr double kDifference = 1e-4;  // step of a logarithm for a numerical derivative
constexpr int kIterations = 60;
constexpr double kConverged = 1e-7;
constexpr int kLags = 40;  // lags of the residuals' autocorrelation [samples]
// The following limits determine whether a fit is refused.
constexpr std::size_t kMinSamples = 300;
constexpr double kMaxRelativeWidth = 0.10;  // half-width of the intervals of bandwidth and damping
                                            // ratio
constexpr double kMaxDelayWidth = 0.002;    // half-width [s]
constexpr double kMaxGainError = 0.05;      // largest deviation from 1
constexpr double kMaxMisfit = 0.25;
constexpr double kMaxLateShare = 0.05,
                 kMaxLostShare = 0.05;  // share of the ticks; share of the samples
constexpr double kBlock = 0.25;         // time over which the misfit is evaluated [s]
constexpr double kShows = 6;  // least motion of a block to be evaluated, as a multiple of the noise
constexpr double kCounts = 0.05;  // least share of the largest block's motion, see Misfit
constexpr double kFits = 3;  // least motion of a block to be fitted, as a multiple of the noise
constexpr std::size_t kMinBlock = 8;  // samples per block

using Records = std::span<const LoopRecord>;

// The response of a loop without delay to a record's commands, interpolated by Hermite cubics.
class Response {
 public:
  Response(const LoopRecord& record, double bandwidth, double damping_ratio)
      : q_(record.u.size() + 1), v_(record.u.size() + 1) {
    VelocityLoop loop({bandwidth, damping_ratio, 0}, 0, LoopRecord::kStep, kNoLimit, kNoLimit);
    for (std::size_t k = 0; k < record.u.size(); ++k) {
      loop.Step(record.u[k]);
      q_[k + 1] = loop.q();
      v_[k + 1] = loop.v();
    }
  }
  double q(double t) const {
    double x = 0;
    const std::size_t k = Before(t, &x);
    const double d = q_[k + 1] - q_[k];
    const double a = LoopRecord::kStep * v_[k] - d, b = d - LoopRecord::kStep * v_[k + 1];
    return q_[k] + x * d + x * (1 - x) * (a * (1 - x) + b * x);
  }
  double v(double t) const {
    double x = 0;
    const std::size_t k = Before(t, &x);
    return (1 - x) * v_[k] + x * v_[k + 1];
  }

 private:
  // Returns the index of the step before t, and the position of t within the step.
  std::size_t Before(double t, double* x) const {
    const double steps = std::clamp(t / LoopRecord::kStep, 0.0, static_cast<double>(q_.size() - 1));
    const double k = std::min(std::floor(steps), static_cast<double>(q_.size() - 2));
    *x = steps - k;
    return static_cast<std::size_t>(k);
  }
  std::vector<double> q_, v_;
};

struct Parameters {
  Eigen::Vector<double, kParameters> x;  // in the order given at kParameters
  double bandwidth() const { return std::exp(x[0]); }
  double damping_ratio() const { return std::exp(x[1]); }
  double delay() const { return x[2]; }
  double gain() const { return x[3]; }
};

// Calls `use(from, to)` with the range of samples of each block, in order.
template <class Use>
void ForBlocks(const std::vector<LoopRecord::Sample>& samples, const Use& use) {
  for (std::size_t from = 0, to = 0; from < samples.size(); from = to) {
    const double end = samples[from].time + kBlock;
    while (to < samples.size() && samples[to].time < end) ++to;
    if (to - from >= kMinBlock) use(from, to);
  }
}

// An arm applies each command in its own cycle, slightly earlier or later, and the resulting
// position offset persists. During a swing, this offset drifts by up to the amplitude of the fast
// motion. Positions are therefore compared with one another only within a block. `rows` has one row
// for each sample.
template <class Rows>
void Centre(const LoopRecord& record, Rows* rows) {
  ForBlocks(record.samples, [&](std::size_t from, std::size_t to) {
    auto block =
        rows->middleRows(static_cast<Eigen::Index>(from), static_cast<Eigen::Index>(to - from));
    const auto mean = block.colwise().mean().eval();
    block.rowwise() -= mean;
  });
}

Eigen::VectorXd Residual(const LoopRecord& record, const Parameters& p) {
  const Response response(record, p.bandwidth(), p.damping_ratio());
  Eigen::VectorXd r(static_cast<Eigen::Index>(record.samples.size()));
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const LoopRecord::Sample& s = record.samples[static_cast<std::size_t>(i)];
    r[i] = s.q - p.gain() * response.q(s.time - p.delay());
  }
  Centre(record, &r);
  return r;
}

// Derivatives of the model with respect to the parameters.
Eigen::MatrixXd Slopes(const LoopRecord& record, const Parameters& p) {
  const double f = p.bandwidth(), zeta = p.damping_ratio();
  const double up = std::exp(kDifference), down = 1 / up;
  const Response at(record, f, zeta), f_up(record, f * up, zeta), f_down(record, f * down, zeta);
  const Response zeta_up(record, f, zeta * up), zeta_down(record, f, zeta * down);
  Eigen::MatrixXd J(static_cast<Eigen::Index>(record.samples.size()), kParameters);
  for (Eigen::Index i = 0; i < J.rows(); ++i) {
    const double t = record.samples[static_cast<std::size_t>(i)].time - p.delay();
    J.row(i) << p.gain() * (f_up.q(t) - f_down.q(t)) / (2 * kDifference),
        p.gain() * (zeta_up.q(t) - zeta_down.q(t)) / (2 * kDifference), -p.gain() * at.v(t),
        at.q(t);
  }
  Centre(record, &J);
  return J;
}

// Fits all records by the Gauss–Newton method with Levenberg–Marquardt damping.
class Fitter {
 public:
  explicit Fitter(Records records) : records_(records) {}

  Parameters Run() {
    Parameters best = Start();
    double cost = Cost(best), damping = 1e-3;
    for (int i = 0; i < kIterations && damping < 1e9; ++i) {
      Linearise(best);
      Eigen::MatrixXd damped = H_;
      damped.diagonal() *= 1 + damping;
      const Eigen::VectorXd step = Solve(damped, g_);
      Parameters next = best;
      next.x += step;
      const double next_cost = Sane(next) ? Cost(next) : HUGE_VAL;
      if (!(next_cost <= cost)) {
        damping *= 10;
        continue;
      }
      best = next;
      cost = next_cost;
      damping *= 0.1;
      const double scaled =
          std::max({std::abs(step[0]), std::abs(step[1]), std::abs(step[2]) * 100});
      if (scaled < kConverged) break;
    }
    Linearise(best);
    return best;
  }

  // Computes (JᵀJ)⁻¹ from the derivatives at the solution.
  Eigen::MatrixXd Spread() const {
    return Solve(H_, Eigen::MatrixXd::Identity(H_.rows(), H_.cols()));
  }
  std::vector<Eigen::VectorXd> Residuals(const Parameters& p) const {
    std::vector<Eigen::VectorXd> all;
    for (const LoopRecord& record : records_) all.push_back(Residual(record, p));
    return all;
  }

 private:
  static bool Sane(const Parameters& p) {
    return p.bandwidth() > 0.5 && p.bandwidth() < 300 && p.damping_ratio() > 0.02 &&
           p.damping_ratio() < 20 && std::abs(p.delay()) < 0.5;
  }
  double Cost(const Parameters& p) const {
    double cost = 0;
    for (const Eigen::VectorXd& r : Residuals(p)) cost += r.squaredNorm();
    return cost;
  }

  // Returns the loop that fits best among several initial loops.
  Parameters Start() const {
    Parameters best;
    double least = HUGE_VAL;
    for (const double bandwidth : {6.0, 12.0, 24.0, 48.0})
      for (const double delay : {0.0, 0.004, 0.010, 0.020, 0.040}) {
        Parameters p;
        p.x << std::log(bandwidth), std::log(0.8), delay, 1;
        if (const double cost = Cost(p); cost < least) {
          least = cost;
          best = p;
        }
      }
    return best;
  }

  void Linearise(const Parameters& p) {
    H_.setZero(kParameters, kParameters);
    g_.setZero(kParameters);
    for (const LoopRecord& record : records_) {
      const Eigen::MatrixXd J = Slopes(record, p);
      H_ += J.transpose() * J;
      g_ += J.transpose() * Residual(record, p);
    }
  }

  Records records_;
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
};

// Returns the factor by which the variance of a mean of residuals exceeds the variance for the same
// number of independent residuals.
double Excess(const std::vector<Eigen::VectorXd>& residuals) {
  double own = 0, excess = 1;
  for (const Eigen::VectorXd& r : residuals) own += r.squaredNorm();
  for (int lag = 1; lag <= kLags && own > 0; ++lag) {
    double product = 0;
    for (const Eigen::VectorXd& r : residuals)
      if (r.size() > lag) product += r.head(r.size() - lag).dot(r.tail(r.size() - lag));
    excess += 2 * (1 - lag / (kLags + 1.0)) * product / own;
  }
  return std::max(1.0, excess);
}

// Returns the sum of squares about the best-fitting line.
double SquaresAboutLine(const Eigen::VectorXd& y) {
  const auto n = static_cast<double>(y.size());
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(y.size(), -1, 1);
  const double slope = x.dot(y) / x.squaredNorm();
  return std::max(0.0, y.squaredNorm() - n * y.mean() * y.mean() - slope * slope * x.squaredNorm());
}

double MotionSquares(const LoopRecord& record, std::size_t from, std::size_t to) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(to - from));
  for (std::size_t i = from; i < to; ++i)
    q[static_cast<Eigen::Index>(i - from)] = record.samples[i].q - record.samples[from].q;
  return SquaresAboutLine(q);
}

long CountBlocks(const LoopRecord& record) {
  long blocks = 0;
  ForBlocks(record.samples, [&](std::size_t, std::size_t) { ++blocks; });
  return blocks;
}

// Returns the blocks whose motion exceeds the noise.
LoopRecord FittableBlocks(const LoopRecord& record, double noise) {
  LoopRecord fittable{record.joint, record.u, {}, {}};
  ForBlocks(record.samples, [&](std::size_t from, std::size_t to) {
    const double least = kFits * noise;
    if (MotionSquares(record, from, to) < static_cast<double>(to - from) * least * least) return;
    for (std::size_t i = from; i < to; ++i) fittable.samples.push_back(record.samples[i]);
  });
  return fittable;
}

// Returns the unexplained share of the motion in the worst block. Blocks correspond to frequencies
// of the chirp. An arm may apply each command one cycle earlier or later. Within a block, the
// accumulated offset can be as large as the smallest motion of the fastest swings. This motion is
// some hundredths of a milliradian, so such blocks contain no information about the loop.
// Therefore, the function evaluates only blocks whose motion is a sufficient share of the largest
// block's motion.
double Misfit(const LoopRecord& record, const Eigen::VectorXd& residual, double noise) {
  double largest = 0;
  ForBlocks(record.samples, [&](std::size_t from, std::size_t to) {
    largest = std::max(largest, MotionSquares(record, from, to) / static_cast<double>(to - from));
  });
  double worst = 0;
  ForBlocks(record.samples, [&](std::size_t from, std::size_t to) {
    const auto n = static_cast<Eigen::Index>(to - from);
    const double own = static_cast<double>(n) * noise * noise;
    const double motion = MotionSquares(record, from, to);
    if (motion < kShows * kShows * own) return;
    if (motion < kCounts * kCounts * static_cast<double>(n) * largest) return;
    const double left = SquaresAboutLine(residual.segment(static_cast<Eigen::Index>(from), n));
    worst = std::max(worst, std::sqrt(std::max(0.0, left - own) / motion));
  });
  return worst;
}

constexpr const char* kQuiet =
    "Close other programs on this computer, use a separate network for the arm, and measure again.";

void CheckGaps(const Gaps& gaps) {
  if (gaps.late_share() <= kMaxLateShare && gaps.lost_share() <= kMaxLostShare) return;
  throw InputError(
      "The measurement has too many gaps: " + GapsText(gaps) +
      Formatted(" (limits %.0f %% and %.0f %%). ", 1e2 * kMaxLateShare, 1e2 * kMaxLostShare) +
      kQuiet +
      (gaps.lost_share() > kMaxLostShare ? " Run `predictor devices` to check that the "
                                           "arm sends at the machine file's sample_rate."
                                         : ""));
}

// Throws InputError with a message that mentions gaps in the measurement as a possible reason.
[[noreturn]] void Refuse(const Gaps& gaps, const std::string& why) {
  throw InputError(why + (gaps.late + gaps.lost == 0
                              ? " No tick was late and no sample was lost."
                              : " Gaps in the measurement may also be the reason: " +
                                    GapsText(gaps) + ". " + kQuiet));
}

void Check(const LoopFit& fit) {
  if (fit.misfit > kMaxMisfit)
    Refuse(fit.gaps,
           Formatted("A second-order velocity loop does not explain the motion (worst misfit %.0f "
                     "%%). A hand may have been on the handle, the arm may have touched something, "
                     "or an acceleration limit may have cut the commands.",
                     1e2 * fit.misfit));
  if (std::abs(fit.gain.value - 1) > kMaxGainError)
    Refuse(fit.gaps,
           Formatted("The joint moved by only %.2f times the commanded distance. Something "
                     "limits its speed, or another program moves the joint.",
                     fit.gain.value));
  const bool sure = fit.bandwidth.half_width <= kMaxRelativeWidth * fit.bandwidth.value &&
                    fit.damping_ratio.half_width <= kMaxRelativeWidth * fit.damping_ratio.value &&
                    fit.delay.half_width <= kMaxDelayWidth;
  if (!sure)
    Refuse(fit.gaps,
           Formatted(
               "The loop cannot be identified precisely enough (± %.1f Hz, ± %.2f, ± %.1f ms) "
               "because the encoder's noise is %.3f mrad. Measure again, or measure more joints.",
               fit.bandwidth.half_width, fit.damping_ratio.half_width, 1e3 * fit.delay.half_width,
               1e3 * fit.noise));
}

}  // namespace

VelocityLoopSpec LoopFit::spec() const {
  return {bandwidth.value, damping_ratio.value, std::max(0.0, delay.value)};
}

double LoopFit::lag() const {
  return delay.value + damping_ratio.value / (std::numbers::pi * bandwidth.value);
}

LoopFit FitLoop(Records all) {
  LoopFit fit;
  std::vector<LoopRecord> records;
  std::size_t samples = 0;
  for (const LoopRecord& record : all) fit.gaps += record.gaps;
  CheckGaps(fit.gaps);
  for (const LoopRecord& record : all) {
    const double noise = NoiseOf(record);
    fit.noise = std::max(fit.noise, noise);
    records.push_back(FittableBlocks(record, noise));
    if (record.u.empty()) records.back().samples.clear();
    if (records.back().samples.empty())
      records.pop_back();
    else
      samples += records.back().samples.size();
  }
  if (samples < kMinSamples)
    throw InputError("The measurement has too few samples of the arm in motion. Measure again.");
  Fitter fitter(records);
  const Parameters p = fitter.Run();
  const std::vector<Eigen::VectorXd> residuals = fitter.Residuals(p);
  double squares = 0;
  for (const Eigen::VectorXd& r : residuals) squares += r.squaredNorm();
  double freedom = static_cast<double>(samples) - kParameters;
  for (const LoopRecord& record : records) freedom -= static_cast<double>(CountBlocks(record));
  const Eigen::MatrixXd covariance = squares / freedom * Excess(residuals) * fitter.Spread();
  const double t = StudentQuantile95(freedom);
  const auto half = [&](int i) {
    return covariance(i, i) >= 0 ? t * std::sqrt(covariance(i, i)) : HUGE_VAL;
  };
  fit.bandwidth = {p.bandwidth(), p.bandwidth() * half(0)};
  fit.damping_ratio = {p.damping_ratio(), p.damping_ratio() * half(1)};
  fit.delay = {p.delay(), half(2)};
  fit.gain = {p.gain(), half(3)};
  fit.residual = std::sqrt(squares / static_cast<double>(samples));
  for (std::size_t r = 0; r < records.size(); ++r)
    fit.misfit = std::max(fit.misfit, Misfit(records[r], residuals[r], fit.noise));
  Check(fit);
  return fit;
}

std::string LoopText(const LoopFit& fit, const VelocityLoopSpec& before) {
  std::string text;
  AppendLine(&text, "Velocity loop; ± is half the 95 %% interval");
  AppendLine(&text, "  bandwidth      %6.2f ± %.2f Hz   (was %.1f)", fit.bandwidth.value,
             fit.bandwidth.half_width, before.bandwidth);
  AppendLine(&text, "  damping ratio  %6.3f ± %.3f      (was %.2f)", fit.damping_ratio.value,
             fit.damping_ratio.half_width, before.damping_ratio);
  AppendLine(&text, "  delay          %6.2f ± %.2f ms   (was %.1f)", 1e3 * fit.delay.value,
             1e3 * fit.delay.half_width, 1e3 * before.delay);
  AppendLine(&text,
             "  lag of slow motion %.1f ms; gain %.4f; residual %.4f mrad rms (noise %.4f); "
             "worst misfit %.0f %%",
             1e3 * fit.lag(), fit.gain.value, 1e3 * fit.residual, 1e3 * fit.noise,
             1e2 * fit.misfit);
  AppendLine(&text, "  %s", GapsText(fit.gaps).c_str());
  return text;
}

}  // namespace predictor::commissioning
