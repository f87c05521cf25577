#include "qp_set.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "haptics/assemble.h"

namespace predictor::bench {
namespace {

// Returns the problem that rendering solved in its last Render.
Problem Extract(const Renderer& renderer) {
  Problem problem;
  problem.weighed = renderer.qp();
  problem.hard = problem.weighed;
  const TaskTerm relative = renderer.assembler().PrecedenceTerms().at(0);
  Qp term(problem.hard.n(), problem.hard.m());
  AddByWeight(relative, &term);
  problem.hard.H() -= term.H();
  problem.hard.f() -= term.f();
  problem.E.setZero(6, problem.hard.n());
  problem.E.middleCols(relative.first, relative.J.cols()) = relative.J;
  problem.e = relative.rate;
  return problem;
}

JointVector RandomPosture(const RobotModel& model, bool stretched, std::mt19937_64* random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  JointVector q(model.dof());
  for (int j = 0; j < q.size(); ++j) {
    const double lower = std::max(model.position_lower()[j], -3.0);
    const double upper = std::min(model.position_upper()[j], 3.0);
    const double kind = uniform(*random);
    q[j] = lower + uniform(*random) * (upper - lower);
    if (kind < 0.15) q[j] = lower + 0.05 * (2 * uniform(*random) - 1);
    if (kind > 0.85) q[j] = upper + 0.05 * (2 * uniform(*random) - 1);
  }
  // The Panda's elbow is straight at zero, just beyond its joint limit of −0.07 rad.
  if (stretched && q.size() == 7) q[3] = -0.07 - 0.05 * uniform(*random);
  return q;
}

}  // namespace

ProblemSet FromRecording(const Recording& recording, const std::string& name, int stride) {
  ProblemSet set{name, {}};
  RenderInput input(recording);
  Renderer renderer(recording.scenario, input.models(), recording.lead, recording.dt);
  RenderResult result;
  for (std::size_t k = 1; k + 1 < recording.ticks.size(); ++k) {
    input.Load(recording, k);
    // The set contains this problem even if rendering reports an error.
    std::ignore = renderer.Render(input.arms(), input.target, input.last, &result);
    if (k % static_cast<std::size_t>(stride) != 0) continue;
    set.problems.push_back(Extract(renderer));
    const DeviceCommand sent = CommandAt(recording, k);
    double gap = recording.ticks[k].guard_altered ? -1 : 0;
    for (std::size_t i = 0; i < kHands && gap >= 0; ++i)
      gap = std::max(gap, (sent.v[i] - result.v[i]).lpNorm<Eigen::Infinity>());
    set.problems.back().gap = gap;
  }
  return set;
}

ProblemSet AtTheLimits(const Recording& recording, int count) {
  ProblemSet set{"at limits and singularities", {}};
  RenderInput input(recording);
  Renderer renderer(recording.scenario, input.models(), recording.lead, recording.dt);
  RenderResult result;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto random_vector = [&](double size) {
    return Vector3(size * normal(random), size * normal(random), size * normal(random));
  };
  for (int k = 0; k < count; ++k) {
    const auto models = input.models();
    std::array<JointVector, kHands> q;
    std::array<JointVector, kHands> sent;
    for (std::size_t i = 0; i < kHands; ++i) {
      q[i] = RandomPosture(*models[i], k % 3 == static_cast<int>(i), &random);
      sent[i] = JointVector::Zero(q[i].size());
      for (auto& v : sent[i]) v = 0.1 * normal(random);
    }
    input.Place(q, sent);
    for (std::size_t i = 0; i < kHands; ++i) {
      FrameMotion& D = input.target.handle[i];
      const Pose X = input.Handle(static_cast<int>(i));
      D.X_W.p = X.p + random_vector(0.02);
      D.X_W.q = RotationFromVector(random_vector(0.1)) * X.q;
      D.V_W << random_vector(0.05), random_vector(0.2);
      D.A_W << random_vector(0.2), random_vector(0.5);
    }
    // Random postures may be invalid. The set contains their problems nevertheless.
    std::ignore = renderer.Render(input.arms(), input.target, input.last, &result);
    set.problems.push_back(Extract(renderer));
    set.problems.back().gap = -1;
  }
  return set;
}

}  // namespace predictor::bench
