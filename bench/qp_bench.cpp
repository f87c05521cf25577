#include <algorithm>
#include <cmath>

#include "qp_candidates.h"
#include "samples.h"
#include "sections.h"

namespace predictor::bench {
namespace {

struct Score {
  std::vector<double> us;        // for each problem, the median over the repetitions
  std::vector<double> residual;  // of the solved problems
  int failed = 0;                // the solver reported failure, or its residual exceeds 1e-6
};

constexpr std::size_t kBlock = 50;  // number of problems that a candidate solves consecutively

// The candidates take turns after each block of problems. A disturbance therefore affects all
// candidates equally. Within a block, the candidate's code stays in the cache.
std::vector<Score> Run(const ProblemSet& set,
                       const std::vector<std::unique_ptr<Candidate>>& candidates, int repetitions) {
  const std::size_t count = set.problems.size();
  std::vector<std::vector<std::vector<double>>> times(candidates.size(),
                                                      std::vector<std::vector<double>>(count));
  std::vector<Score> scores(candidates.size());
  Answer answer;
  const auto block = [&](std::size_t c, std::size_t first, bool judge) {
    for (std::size_t p = first; p < std::min(first + kBlock, count); ++p) {
      const Problem& problem = set.problems[p];
      times[c][p].push_back(Microseconds([&] { candidates[c]->Solve(problem, &answer); }));
      if (!judge) continue;
      const double residual = Residual(problem, candidates[c]->hard(), answer);
      if (!(residual <= 1e-6)) ++scores[c].failed;
      if (std::isfinite(residual)) scores[c].residual.push_back(residual);
    }
  };
  for (int repetition = 0; repetition < repetitions; ++repetition)
    for (std::size_t first = 0; first < count; first += kBlock)
      for (std::size_t c = 0; c < candidates.size(); ++c) block(c, first, repetition == 0);
  for (std::size_t c = 0; c < candidates.size(); ++c)
    for (const auto& t : times[c]) scores[c].us.push_back(Median(t));
  return scores;
}

// Prints the distance of the weighted solution from the hard solution, if a hard solution exists.
void PrintYield(const ProblemSet& set) {
  const auto weighed = MakeDaqp(set.problems[0], false);
  const auto hard = MakeDaqp(set.problems[0], true);
  std::vector<double> slack, slack_rotation, distance;
  Answer w, h;
  for (const Problem& problem : set.problems) {
    hard->Solve(problem, &h);
    if (!(Residual(problem, true, h) <= 1e-6)) continue;
    weighed->Solve(problem, &w);
    const int n = problem.weighed.n();
    const Eigen::Map<const Eigen::VectorXd> xw(w.solution.x.data(), n), xh(h.solution.x.data(), n);
    const Vector6 s = problem.E * xw - problem.e;
    slack.push_back(s.head<3>().norm());
    slack_rotation.push_back(s.tail<3>().norm());
    distance.push_back((xw - xh).head(n - problem.weighed.m()).lpNorm<Eigen::Infinity>());
  }
  if (slack.empty()) {
    std::printf("  with equality rows, none of the %zu problems has a solution\n",
                set.problems.size());
    return;
  }
  std::printf(
      "  where the hard problem has a solution (%zu of %zu): slack of the relative pose by weight "
      "p50 %.1e, p99 %.1e m/s and p50 %.1e, p99 %.1e rad/s; joint speeds differ by p50 %.1e, p99 "
      "%.1e rad/s\n",
      slack.size(), set.problems.size(), Median(slack), Quantile(slack, 0.99),
      Median(slack_rotation), Quantile(slack_rotation, 0.99), Median(distance),
      Quantile(distance, 0.99));
}

void PrintGap(const ProblemSet& set) {
  double gap = 0;
  int known = 0;
  for (const Problem& problem : set.problems) {
    known += problem.gap >= 0;
    gap = std::max(gap, problem.gap);
  }
  if (known > 0)
    std::printf(
        "  replayed solutions differ from the recorded commands by at most %.1e rad/s (%d ticks)\n",
        gap, known);
}

}  // namespace

void CompareSolvers(const std::vector<ProblemSet>& sets, int repetitions) {
  for (const ProblemSet& set : sets) {
    const auto candidates = MakeCandidates(set.problems[0]);
    const std::vector<Score> scores = Run(set, candidates, repetitions);
    const double ours = Median(scores[0].us);
    Heading("QP solvers: " + set.name + ", " + std::to_string(set.problems.size()) +
            " problems of " + std::to_string(set.problems[0].weighed.n()) + " variables");
    std::printf("%-18s %-22s %8s %8s %8s %10s %10s %9s\n", "solver", "relative pose by", "p50 us",
                "p99 us", "/ ours", "KKT p50", "KKT max", "unsolved");
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const Score& s = scores[c];
      std::printf(
          "%-18s %-22s %8.2f %8.2f %8.2f %10.1e %10.1e %9d\n", candidates[c]->name().c_str(),
          candidates[c]->hard() ? "six equality rows" : "weight", Median(s.us),
          Quantile(s.us, 0.99), Median(s.us) / ours, s.residual.empty() ? NAN : Median(s.residual),
          s.residual.empty() ? NAN : Quantile(s.residual, 1), s.failed);
    }
    PrintGap(set);
    PrintYield(set);
    std::fflush(stdout);
  }
}

}  // namespace predictor::bench
