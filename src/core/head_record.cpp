#include "core/head_record.h"

#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

constexpr double kQuaternionSlip = 1e-6;  // tolerance of the squared norm

// The comparison is false for NaN.
bool Within(double x, double limit) { return std::abs(x) <= limit; }

}  // namespace

bool IsPlausible(const HeadRecord& head) {
  const auto near = [](double x) { return Within(x, kFarthestHead); };
  double norm = 0;
  for (const double x : head.q) norm += x * x;
  const HeadRegistration& r = head.registration;
  return std::ranges::all_of(head.p, near) && std::ranges::all_of(r.t, near) &&
         Within(norm - 1, kQuaternionSlip) && Within(r.yaw, kLargestHeadYaw) &&
         Within(r.residual, kWorstHeadResidual) && Within(head.delay, kLongestHeadDelay);
}

bool IsCredible(const HeadRecord& head, std::uint64_t newest_ns) {
  constexpr auto kLead = static_cast<std::uint64_t>(1e9 * kLongestHeadLead);
  const bool is_near = head.wall_ns <= newest_ns || head.wall_ns - newest_ns < kLead;
  return is_near && IsPlausible(head);
}

}  // namespace predictor
