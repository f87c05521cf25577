#include "analysis/identify/fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/least_squares.h"
#include "core/linear_algebra.h"

namespace predictor {
namespace {

constexpr double kHuber = 1.345;  // 95 % efficiency for normal errors
constexpr int kIterations = 30;
constexpr double kConverged = 1e-3;  // change of a residual scale that counts as converged
constexpr double kDependent = 1e-6;  // share of a unit column's squared length that must be
                                     // independent of the others
constexpr int kMinLag = 10;      // minimum lag of the scores' autocovariance; half of it is due to
                                 // overlapping windows [windows]
constexpr int kExcessLags = 40;  // lags of the residuals' autocorrelation [windows]
// Lower bound of the residuals' scale, which is necessary because the simulated world moves in
// steps.
constexpr double kMinScale = 0.01;  // [N·m]
constexpr double kTiny = 1e-9;      // [N·m]

double Median(std::vector<double> x) {
  if (x.empty()) return 0;
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

double RobustScale(const Eigen::VectorXd& r) {
  std::vector<double> sizes(static_cast<std::size_t>(r.size()));
  for (Eigen::Index i = 0; i < r.size(); ++i)  // NaN cannot be sorted
    sizes[static_cast<std::size_t>(i)] = std::isfinite(r[i]) ? std::abs(r[i]) : HUGE_VAL;
  return std::max(kMinScale, 1.4826 * Median(std::move(sizes)));
}

// Returns the sum of a(k) a(k + lag) over all windows k for which both factors exist.
double LaggedProduct(const std::vector<long>& window, const Eigen::VectorXd& r, long lag,
                     double* pairs) {
  double sum = 0;
  *pairs = 0;
  for (std::size_t i = 0, k = 0; i < window.size(); ++i) {
    while (k < window.size() && window[k] < window[i] + lag) ++k;
    if (k == window.size()) break;
    if (window[k] != window[i] + lag) continue;
    sum += r[static_cast<Eigen::Index>(i)] * r[static_cast<Eigen::Index>(k)];
    ++*pairs;
  }
  return sum;
}

// Returns the variance of the residuals' mean, divided by the variance for the same number of
// independent residuals.
double VarianceExcess(const std::vector<long>& window, const Eigen::VectorXd& r, double scale) {
  const Eigen::VectorXd clipped = r.cwiseMin(3 * scale).cwiseMax(-3 * scale);
  double pairs = 0;
  const double own = LaggedProduct(window, clipped, 0, &pairs) / std::max(1.0, pairs);
  if (!(own > 0)) return 1;
  double excess = 1;
  for (int lag = 1; lag <= kExcessLags; ++lag) {
    const double product = LaggedProduct(window, clipped, lag, &pairs);
    if (pairs > 0) excess += 2 * (1 - lag / (kExcessLags + 1.0)) * product / pairs / own;
  }
  return std::max(1.0, excess);
}

// The curvature and the gradient of the weighted sum of squares, for all parameters.
struct Normal {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  explicit Normal(int parameters)
      : H(Eigen::MatrixXd::Zero(parameters, parameters)), g(Eigen::VectorXd::Zero(parameters)) {}

  void Add(const FitRows& rows, const Eigen::VectorXd& weight, Eigen::Index from,
           Eigen::Index count) {
    const auto x = rows.x.middleRows(from, count);
    const Eigen::MatrixXd weighted = weight.segment(from, count).asDiagonal() * x;
    const Eigen::MatrixXd part = x.transpose() * weighted;
    const Eigen::VectorXd slope = weighted.transpose() * rows.y.segment(from, count);
    for (std::size_t a = 0; a < rows.index.size(); ++a) {
      g[rows.index[a]] += slope[static_cast<Eigen::Index>(a)];
      for (std::size_t b = 0; b < rows.index.size(); ++b)
        H(rows.index[a], rows.index[b]) +=
            part(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
    }
  }
};

Normal NormalOf(const FitProblem& problem, const std::vector<Eigen::VectorXd>& weight) {
  Normal normal(problem.parameters);
  for (std::size_t j = 0; j < problem.joints.size(); ++j)
    normal.Add(problem.joints[j], weight[j], 0, problem.joints[j].y.size());
  return normal;
}

Eigen::LDLT<Eigen::MatrixXd> Factor(const Eigen::MatrixXd& H, const FitModel& model) {
  Eigen::MatrixXd free = H(model.free, model.free);
  free.diagonal() += model.precision(model.free);
  free.diagonal() *= 1 + 1e-12;
  free.diagonal().array() += std::numeric_limits<double>::min();
  return free.ldlt();
}

Eigen::VectorXd SolveFor(const Normal& normal, const FitModel& model) {
  Eigen::VectorXd value = Eigen::VectorXd::Zero(normal.g.size());
  const Eigen::VectorXd slope = normal.g(model.free);
  const Eigen::VectorXd solution = Factor(normal.H, model).solve(slope);
  value(model.free) = solution;
  return value;
}

Eigen::VectorXd Residual(const FitRows& rows, const Eigen::VectorXd& value) {
  const Eigen::VectorXd own = value(rows.index);
  return rows.y - rows.x * own;
}

// Performs one iteration of reweighting. Returns the largest relative change of a joint's scale.
double Reweigh(const FitProblem& problem, Fit* fit) {
  double change = 0;
  for (std::size_t j = 0; j < problem.joints.size(); ++j) {
    const FitRows& rows = problem.joints[j];
    fit->residual[j] = Residual(rows, fit->value);
    const double scale = RobustScale(fit->residual[j]);
    change = std::max(change, std::abs(scale - fit->scale[j]) / scale);
    fit->scale[j] = scale;
    fit->excess[j] = VarianceExcess(rows.window, fit->residual[j], scale);
    const double unit = 1 / (scale * scale * fit->excess[j]);
    fit->weight[j] = fit->residual[j].unaryExpr([scale, unit](double r) {
      return unit * std::min(1.0, kHuber * scale / std::max(std::abs(r), kTiny));
    });
  }
  return change;
}

// Returns the first window of any joint, and the number of windows from the first to the last
// window.
std::pair<long, long> WindowsOf(const FitProblem& problem) {
  long first = std::numeric_limits<long>::max(), last = 0;
  for (const FitRows& rows : problem.joints) {
    if (rows.window.empty()) continue;
    first = std::min(first, rows.window.front());
    last = std::max(last, rows.window.back());
  }
  return {first, last - first + 1};
}

// Returns the scores of the requested estimates, one column per window. A score is the window's
// contribution to the error of the estimate.
Eigen::MatrixXd Influence(const FitProblem& problem, const FitModel& model, const Fit& fit,
                          const Eigen::MatrixXd& G) {
  std::vector<int> place(static_cast<std::size_t>(problem.parameters), -1);
  for (std::size_t i = 0; i < model.free.size(); ++i)
    place[static_cast<std::size_t>(model.free[i])] = static_cast<int>(i);
  const auto [first, count] = WindowsOf(problem);
  Eigen::MatrixXd influence = Eigen::MatrixXd::Zero(G.rows(), std::max(0L, count));
  for (std::size_t j = 0; j < problem.joints.size(); ++j) {
    const FitRows& rows = problem.joints[j];
    Eigen::MatrixXd G_j = Eigen::MatrixXd::Zero(G.rows(), rows.x.cols());
    for (std::size_t c = 0; c < rows.index.size(); ++c) {
      const int at = place[static_cast<std::size_t>(rows.index[c])];
      if (at >= 0) G_j.col(static_cast<Eigen::Index>(c)) = G.col(at);
    }
    const double shown = std::sqrt(fit.residual[j].squaredNorm() /
                                   std::max<double>(1, static_cast<double>(rows.y.size())));
    const double floor = std::max(1.0, kMinScale / std::max(shown, kTiny));
    const Eigen::VectorXd score = floor * fit.weight[j].cwiseProduct(fit.residual[j]);
    const Eigen::MatrixXd part = G_j * rows.x.transpose() * score.asDiagonal();
    for (std::size_t i = 0; i < rows.window.size(); ++i)
      influence.col(rows.window[i] - first) += part.col(static_cast<Eigen::Index>(i));
  }
  return influence;
}

// Computes Andrews' lag for Bartlett's kernel, assuming AR(1) processes with the scores'
// autocorrelations.
int LagFor(const Eigen::MatrixXd& scores) {
  const Eigen::Index n = scores.cols();
  double above = 0, below = 0;
  for (Eigen::Index i = 0; i < scores.rows(); ++i) {
    const double own = scores.row(i).squaredNorm();
    if (!(own > 0)) continue;
    const double next = scores.row(i).head(n - 1).dot(scores.row(i).tail(n - 1));
    const double rho = std::clamp(next / own, -0.97, 0.97);
    // The variance of the innovations is chosen such that each score has variance 1.
    above += 4 * rho * rho / std::pow(1 - rho, 4);
    below += (1 + rho) * (1 + rho) / ((1 - rho) * (1 - rho));
  }
  if (!(below > 0)) return kMinLag;
  const double lag = 1.1447 * std::cbrt(above / below * static_cast<double>(n));
  return std::clamp(static_cast<int>(std::ceil(lag)), kMinLag,
                    std::max(kMinLag, static_cast<int>(n / 8)));
}

Eigen::MatrixXd LongRunCovariance(const Eigen::MatrixXd& scores, int lag) {
  const Eigen::Index n = scores.cols();
  Eigen::MatrixXd S = scores * scores.transpose();
  for (int l = 1; l <= lag; ++l) {
    const Eigen::MatrixXd product = scores.leftCols(n - l) * scores.rightCols(n - l).transpose();
    S += (1 - l / (lag + 1.0)) * (product + product.transpose());
  }
  return S;
}

// Returns the rate at which the scores decrease with a change of the parameters. The rate is
// computed with the mean slope of Huber's ψ of each joint, which is smaller than the mean of the
// joint's weights.
Normal Slope(const FitProblem& problem, const Fit& fit) {
  Normal slope(problem.parameters);
  for (std::size_t j = 0; j < problem.joints.size(); ++j) {
    const FitRows& rows = problem.joints[j];
    const auto inner = (fit.residual[j].array().abs() < kHuber * fit.scale[j]).cast<double>();
    const double mean = rows.y.size() > 0 ? inner.mean() : 0;
    const double unit = 1 / (fit.scale[j] * fit.scale[j] * fit.excess[j]);
    slope.Add(rows, Eigen::VectorXd::Constant(rows.y.size(), mean * unit), 0, rows.y.size());
  }
  return slope;
}

void AddCovariance(const FitProblem& problem, const FitModel& model, const std::vector<int>& wanted,
                   Fit* fit) {
  const Normal normal = Slope(problem, *fit);
  const Eigen::LDLT<Eigen::MatrixXd> factor = Factor(normal.H, model);
  const auto free = static_cast<Eigen::Index>(model.free.size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(free, static_cast<Eigen::Index>(wanted.size()));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto at = std::lower_bound(model.free.begin(), model.free.end(), wanted[i]);
    if (at != model.free.end() && *at == wanted[i])
      rows(at - model.free.begin(), static_cast<Eigen::Index>(i)) = 1;
  }
  const Eigen::MatrixXd G = factor.solve(rows).transpose();
  const Eigen::MatrixXd scores = Influence(problem, model, *fit, G);
  const int lag = LagFor(scores);
  const Eigen::MatrixXd data = normal.H(model.free, model.free);
  const double spent = factor.solve(data).trace();
  double independent = 0;
  for (std::size_t j = 0; j < problem.joints.size(); ++j)
    independent += static_cast<double>(problem.joints[j].window.size()) / fit->excess[j];
  const double left = std::max(independent - spent, 0.05 * independent);
  const Eigen::VectorXd precision = model.precision(model.free);
  fit->covariance = independent / left * LongRunCovariance(scores, lag) +
                    G * precision.asDiagonal() * G.transpose();
  fit->quantile = StudentQuantile95(static_cast<double>(scores.cols()) / (1.5 * lag));
}

}  // namespace

Fit FitRobustly(const FitProblem& problem, const FitModel& model, const std::vector<int>& wanted) {
  Fit fit;
  for (const FitRows& rows : problem.joints) {
    fit.scale.push_back(RobustScale(rows.y));
    fit.excess.push_back(1);
    fit.residual.push_back(rows.y);
    fit.weight.push_back(
        Eigen::VectorXd::Constant(rows.y.size(), 1 / (fit.scale.back() * fit.scale.back())));
  }
  for (int i = 0; i < kIterations; ++i) {
    fit.value = SolveFor(NormalOf(problem, fit.weight), model);
    if (Reweigh(problem, &fit) < kConverged) break;
  }
  AddCovariance(problem, model, wanted, &fit);
  return fit;
}

CrossValidation CrossValidate(const FitProblem& problem, const FitModel& model, const Fit& fit,
                              const std::vector<double>& scale, int blocks) {
  const auto [first, count] = WindowsOf(problem);
  const auto start = [&, first = first, count = count](const FitRows& rows, int block) {
    const long at = first + count * block / blocks;
    return std::lower_bound(rows.window.begin(), rows.window.end(), at) - rows.window.begin();
  };
  std::vector<Normal> parts(static_cast<std::size_t>(blocks), Normal(problem.parameters));
  Normal whole(problem.parameters);
  for (int b = 0; b < blocks; ++b) {
    Normal& part = parts[static_cast<std::size_t>(b)];
    for (std::size_t j = 0; j < problem.joints.size(); ++j) {
      const FitRows& rows = problem.joints[j];
      part.Add(rows, fit.weight[j], start(rows, b), start(rows, b + 1) - start(rows, b));
    }
    whole.H += part.H;
    whole.g += part.g;
  }
  CrossValidation result;
  result.error_squares.assign(problem.joints.size(), 0);
  result.rows.assign(problem.joints.size(), 0);
  for (int b = 0; b < blocks; ++b) {
    Normal others = whole;
    others.H -= parts[static_cast<std::size_t>(b)].H;
    others.g -= parts[static_cast<std::size_t>(b)].g;
    const Eigen::VectorXd value = SolveFor(others, model);
    double loss = 0, terms = 0;
    for (std::size_t j = 0; j < problem.joints.size(); ++j) {
      const FitRows& rows = problem.joints[j];
      const Eigen::VectorXd own = value(rows.index);
      for (Eigen::Index i = start(rows, b); i < start(rows, b + 1); ++i) {
        const double r = rows.y[i] - rows.x.row(i).dot(own);
        const double u = std::abs(r) / scale[j];
        loss += u < kHuber ? u * u / 2 : kHuber * (u - kHuber / 2);
        result.error_squares[j] += r * r;
        ++result.rows[j];
        ++terms;
      }
    }
    if (terms > 0) result.loss.push_back(loss / terms);
  }
  return result;
}

void CloseGaps(FitProblem* problem) {
  std::map<long, long> number;
  for (const FitRows& rows : problem->joints)
    for (const long window : rows.window) number[window] = 0;
  long last = 0, next = 0;
  for (auto& [window, dense] : number) {
    next += std::min<long>(window - last, kExcessLags + 1);
    last = window;
    dense = next;
  }
  for (FitRows& rows : problem->joints)
    for (long& window : rows.window) window = number.at(window);
}

std::vector<int> BaseParameters(const FitProblem& problem, const Fit& fit,
                                const std::vector<int>& always, const std::vector<int>& among,
                                double* condition) {
  const Normal normal = NormalOf(problem, fit.weight);
  std::vector<int> all = always;
  all.insert(all.end(), among.begin(), among.end());
  const auto size = static_cast<Eigen::Index>(all.size());
  Eigen::VectorXd length = normal.H.diagonal()(all).cwiseMax(0).cwiseSqrt();
  const double longest = length.maxCoeff();
  for (double& l : length) l = l > 1e-9 * longest ? 1 / l : 0;
  const Eigen::MatrixXd gram = length.asDiagonal() * normal.H(all, all) * length.asDiagonal();
  // Each step of this pivoted Cholesky factorisation chooses the column that is furthest from the
  // span of the previous columns.
  Eigen::MatrixXd rest = gram;
  std::vector<int> chosen;
  std::vector<bool> taken(all.size(), false);
  for (Eigen::Index step = 0; step < size; ++step) {
    Eigen::Index best = -1;
    const bool first_ones = step < static_cast<Eigen::Index>(always.size());
    for (Eigen::Index i = 0; i < size; ++i) {
      if (taken[static_cast<std::size_t>(i)]) continue;
      if (first_ones && i >= static_cast<Eigen::Index>(always.size())) break;
      if (best < 0 || rest(i, i) > rest(best, best)) best = i;
    }
    if (best < 0) break;
    taken[static_cast<std::size_t>(best)] = true;
    if (!(rest(best, best) > kDependent)) {
      if (first_ones) continue;
      break;
    }
    chosen.push_back(static_cast<int>(best));
    const Eigen::VectorXd column = rest.col(best) / rest(best, best);
    rest -= (column * rest.row(best)).eval();
  }
  const Eigen::MatrixXd base = gram(chosen, chosen);
  const Eigen::VectorXd modes =
      SymmetricModesOf(base, Eigen::MatrixXd::Identity(base.rows(), base.cols())).eigenvalues;
  *condition = modes.size() > 0 ? std::sqrt(modes.tail<1>()[0] / std::max(modes[0], 1e-300)) : 0;
  std::vector<int> parameters;
  for (const int i : chosen)
    if (i >= static_cast<int>(always.size()))
      parameters.push_back(all[static_cast<std::size_t>(i)]);
  std::sort(parameters.begin(), parameters.end());
  return parameters;
}

}  // namespace predictor
