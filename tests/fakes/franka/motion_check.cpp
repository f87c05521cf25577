#include "fakes/franka/motion_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace predictor {
namespace {

constexpr double kMillisecond = 1e-3;
constexpr double kRounding = 1e-9;

// Indices in a state's list of errors.
constexpr std::size_t kPositionLimits = 12, kVelocityLimits = 13, kVelocityDiscontinuity = 14,
                      kAccelerationDiscontinuity = 15, kCommunicationConstraints = 25;

FrankaLimits Panda() {
  constexpr double upper[] = {2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973};
  constexpr double lower[] = {-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973};
  constexpr double velocity[] = {2.1750, 2.1750, 2.1750, 2.1750, 2.6100, 2.6100, 2.6100};
  constexpr double acceleration[] = {15, 7.5, 10, 12.5, 15, 20, 20};
  constexpr double jerk[] = {7500, 3750, 5000, 6250, 7500, 10000, 10000};
  FrankaLimits limits{};
  for (std::size_t i = 0; i < limits.size(); ++i)
    limits[i] = {lower[i],        upper[i], lower[i], upper[i], velocity[i],
                 acceleration[i], jerk[i],  0,        0};
  return limits;
}

FrankaLimits Research3() {
  constexpr double upper[] = {2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159};
  constexpr double lower[] = {-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159};
  constexpr double curve_upper[] = {2.75010, 1.79180, 2.90650, -0.1458, 2.81010, 4.52050, 3.01960};
  constexpr double curve_lower[] = {-2.750100, -1.791800, -2.906500, -3.048100,
                                    -2.810100, 0.54092,   -3.019600};
  constexpr double velocity[] = {2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26};
  constexpr double deceleration[] = {6.0, 2.585, 3.50, 4.00, 17.0, 5.5, 17.0};
  constexpr double offset[] = {0.30, 0.20, 0.20, 0.30, 0.35, 0.35, 0.35};
  FrankaLimits limits{};
  for (std::size_t i = 0; i < limits.size(); ++i)
    limits[i] = {lower[i], upper[i], curve_lower[i],  curve_upper[i], velocity[i],
                 10,       5000,     deceleration[i], offset[i]};
  return limits;
}

double Curve(const FrankaJointLimit& limit, double distance) {
  if (limit.curve_deceleration == 0) return limit.velocity;
  const double v =
      std::sqrt(std::max(0.0, 2 * limit.curve_deceleration * distance)) - limit.curve_offset;
  return std::min(limit.velocity, std::max(0.0, v));
}

}  // namespace

FrankaJoints FrankaJointsOf(const JointVector& from) {
  FrankaJoints to{};
  for (int i = 0; i < 7 && i < from.size(); ++i) to[static_cast<std::size_t>(i)] = from[i];
  return to;
}

double FrankaJointLimit::FastestUp(double q) const { return Curve(*this, curve_upper - q); }
double FrankaJointLimit::FastestDown(double q) const { return Curve(*this, q - curve_lower); }

const FrankaLimits& FrankaLimitsOf(std::uint16_t version) {
  static const FrankaLimits panda = Panda(), research3 = Research3();
  return version == 5 ? panda : research3;
}

std::string FrankaDescription() {
  // The Denavit-Hartenberg parameters are from the same specifications.
  constexpr const char* origins[] = {"0 0 0.333",       "0 0 0", "0 -0.316 0", "0.0825 0 0",
                                     "-0.0825 0.384 0", "0 0 0", "0.088 0 0"};
  constexpr double turns[] = {0, -1, 1, 1, -1, 1, 1};
  std::string text =
      "<?xml version=\"1.0\"?>\n<robot name=\"fr3\">\n<link name=\"base\"/>\n"
      "<link name=\"fr3_link0\"/>\n<joint name=\"base_joint\" type=\"fixed\">"
      "<parent link=\"base\"/><child link=\"fr3_link0\"/></joint>\n";
  const FrankaLimits& limits = FrankaLimitsOf(10);
  for (int i = 0; i < 7; ++i) {
    const FrankaJointLimit& l = limits[static_cast<std::size_t>(i)];
    char joint[800];
    std::snprintf(joint, sizeof joint,
                  "<link name=\"fr3_link%d\"/>\n<joint name=\"fr3_joint%d\" type=\"revolute\">\n"
                  "  <origin rpy=\"%.10g 0 0\" xyz=\"%s\"/>\n  <parent link=\"fr3_link%d\"/>\n"
                  "  <child link=\"fr3_link%d\"/>\n  <axis xyz=\"0 0 1\"/>\n"
                  "  <limit effort=\"%g\" lower=\"%.6g\" upper=\"%.6g\" velocity=\"%g\"/>\n"
                  "  <position_based_velocity_limits deceleration_limit=\"%g\" "
                  "velocity_offset=\"%g\"/>\n</joint>\n",
                  i + 1, i + 1, turns[i] * 1.5707963268, origins[i], i, i + 1, i < 4 ? 87.0 : 12.0,
                  l.curve_lower, l.curve_upper, l.velocity, l.curve_deceleration, l.curve_offset);
    text += joint;
  }
  return text + "</robot>\n";
}

void MotionCheck::Begin(const FrankaJoints& q) {
  q_ = q;
  v_ = a_ = {};
  lost_ = 0;
}

std::bitset<41> MotionCheck::Take(const FrankaJoints& v) {
  lost_ = 0;
  return Move(v);
}

std::bitset<41> MotionCheck::Miss() {
  FrankaJoints v;
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = v_[i] + a_[i] * kMillisecond;
  std::bitset<41> wrong = Move(v);
  if (++lost_ >= kMaxLost) wrong.set(kCommunicationConstraints);
  return wrong;
}

std::bitset<41> MotionCheck::Move(const FrankaJoints& v) {
  std::bitset<41> wrong;
  FrankaJoints q = q_, a = a_;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const FrankaJointLimit& limit = limits_[i];
    a[i] = (v[i] - v_[i]) / kMillisecond;
    q[i] = q_[i] + v[i] * kMillisecond;
    const double jerk = (a[i] - a_[i]) / kMillisecond;
    if (v[i] > limit.FastestUp(q_[i]) + kRounding || -v[i] > limit.FastestDown(q_[i]) + kRounding)
      wrong.set(kVelocityLimits);
    if (std::abs(a[i]) > limit.acceleration + 1e3 * kRounding) wrong.set(kVelocityDiscontinuity);
    if (std::abs(jerk) > limit.jerk + 1e6 * kRounding) wrong.set(kAccelerationDiscontinuity);
    // A joint that starts beyond a limit may move back into its range.
    if ((q[i] > limit.upper && v[i] > 0) || (q[i] < limit.lower && v[i] < 0))
      wrong.set(kPositionLimits);
  }
  if (wrong.any()) return wrong;
  q_ = q;
  v_ = v;
  a_ = a;
  return wrong;
}

}  // namespace predictor
