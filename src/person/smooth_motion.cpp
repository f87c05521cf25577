// Smooths and differentiates postures without phase shift.
#include <algorithm>
#include <cmath>

#include "core/butterworth.h"
#include "person/body_loads.h"

namespace predictor::person {
namespace {

void FilterForward(double cutoff, double dt, std::vector<BodyVector>* q) {
  using Filter = Butterworth<BodyVector>;
  Filter filter(Filter::Pass::kLow, cutoff, dt, q->front());
  for (BodyVector& x : *q) x = filter.Update(x);
}

// Returns `q` extended by `n` samples on either side, by point reflection about its ends.
std::vector<BodyVector> Continued(std::span<const BodyVector> q, std::size_t n) {
  std::vector<BodyVector> all;
  all.reserve(q.size() + 2 * n);
  for (std::size_t i = n; i > 0; --i) all.push_back(2 * q.front() - q[i]);
  all.insert(all.end(), q.begin(), q.end());
  for (std::size_t i = 1; i <= n; ++i) all.push_back(2 * q.back() - q[q.size() - 1 - i]);
  return all;
}

}  // namespace

std::vector<BodyMotion> SmoothMotion(std::span<const BodyVector> q, double dt) {
  std::vector<BodyMotion> motion(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) motion[i].q = q[i];
  if (q.size() < 3) return motion;
  // The effect of the ends vanishes within about 0.5 s.
  const std::size_t margin =
      std::min(q.size() - 1, static_cast<std::size_t>(std::ceil(3 / (kMotionCutoff * dt))));
  std::vector<BodyVector> all = Continued(q, margin);
  const double pass = std::min(kMotionCutoff / 0.802, 0.25 / dt);
  for (int direction = 0; direction < 2; ++direction) {
    FilterForward(pass, dt, &all);
    std::reverse(all.begin(), all.end());
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    const std::size_t k = i + margin;
    motion[i].q = all[k];
    motion[i].v = (all[k + 1] - all[k - 1]) / (2 * dt);
    motion[i].a = (all[k + 1] - 2 * all[k] + all[k - 1]) / (dt * dt);
  }
  return motion;
}

}  // namespace predictor::person
