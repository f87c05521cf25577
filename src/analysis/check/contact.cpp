#include "analysis/check/contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "models/object_model.h"
#include "simulation/mujoco/contact_law.h"

namespace predictor {
namespace {

constexpr double kScanRatio = 1.6;  // of successive stiffnesses
constexpr double kPrecision = 1.05;
constexpr double kAtRest = 0.05;      // frequency that counts as rest [Hz]
constexpr double kSameNormal = 0.99;  // cosine of the angle between normals that count as equal
constexpr double kPoints = 4;         // where a flat face touches another

// Returns the outward normal of the surface from which the point lies farthest outside. This
// surface is a side of a box, or the cap or mantle of a cylinder.
Vector3 FacingSide(const FixtureSpec& fixture, const Vector3& p) {
  if (fixture.shape == FixtureShape::kBox) {
    Eigen::Index axis = 0;
    (p.cwiseAbs() - fixture.size / 2).maxCoeff(&axis);
    return std::copysign(1.0, p[axis]) * Vector3::Unit(axis);
  }
  const double radial = p.head<2>().norm() - fixture.size.x();
  if (std::abs(p.z()) - fixture.size.y() / 2 >= radial || p.head<2>().isZero())
    return std::copysign(1.0, p.z()) * Vector3::UnitZ();
  return Vector3(p.x(), p.y(), 0).normalized();
}

// Returns the normal in the fixture's own frame.
Vector3 NormalInFixture(const FixtureSpec& fixture, const Vector3& p) {
  switch (fixture.shape) {
    case FixtureShape::kBox:
    case FixtureShape::kCylinder:
      return FacingSide(fixture, p);
    case FixtureShape::kPlane:
      return Vector3::UnitZ();
    default: {
      const double half = fixture.shape == FixtureShape::kCapsule ? fixture.size.y() / 2 : 0;
      const Vector3 away = p - std::clamp(p.z(), -half, half) * Vector3::UnitZ();
      return away.isZero() ? Vector3(Vector3::UnitZ()) : Vector3(away.normalized());
    }
  }
}

bool IsSameKind(const FixtureSpec& a, const FixtureSpec& b) {
  return a.stiffness == b.stiffness && a.damping == b.damping &&
         (a.stiffness ||
          (a.time_constant == b.time_constant && a.damping_ratio == b.damping_ratio));
}

}  // namespace

Vector3 NormalToward(const FixtureSpec& fixture, const Vector3& p_W) {
  const Pose X_WG = fixture.X_WG();
  return X_WG.q * NormalInFixture(fixture, X_WG.Inverse() * p_W);
}

WallLimit StiffestStableWall(const LinearModel& world, const Scenario& scenario,
                             const HandSpec& hand, double lead, const Wall& wall, LoopModel model) {
  WallLimit limit;
  const auto is_stable = [&](double stiffness) {
    Wall varied = wall;
    varied.stiffness = stiffness;
    double frequency = 0;
    const HapticLoop loop(WithWall(world, varied), scenario, 1 / scenario.rate, model);
    const bool stable = loop.GrowthRate(hand, lead, 1, &frequency) <= HapticLoop::kGrowing;
    if (!stable) limit.frequency = frequency;
    return stable;
  };
  double stable = 0, unstable = kSoftestWall;
  while (is_stable(unstable)) {
    stable = unstable;
    if (stable >= kStiffestWall) return {kStiffestWall, 0, false};
    unstable = std::min(kScanRatio * unstable, kStiffestWall);
  }
  if (stable == 0) return limit;
  while (unstable > kPrecision * stable) {
    const double middle = std::sqrt(stable * unstable);
    (is_stable(middle) ? stable : unstable) = middle;
  }
  limit.stiffness = stable;
  return limit;
}

Wall FixtureWall::Varying() const {
  Wall varying = wall;
  varying.inertia = 0;
  if (!yields) varying.damping = 0;
  return varying;
}

std::vector<double> FeltFrequencies() {
  constexpr double kLowest = 0.1, kHighest = 40, kPerDecade = 20;
  std::vector<double> frequencies;
  for (int k = 0; frequencies.empty() || frequencies.back() < kHighest; ++k)
    frequencies.push_back(std::min(kHighest, kLowest * std::pow(10, k / kPerDecade)));
  return frequencies;
}

double DampingOf(const std::complex<double>& impedance, double frequency) {
  return impedance.imag() / (2 * std::numbers::pi * frequency);
}

std::vector<FixtureWall> WallsOf(const Scenario& s, const LinearModel& world, const Pose& X_WO) {
  std::vector<FixtureWall> walls;
  const auto& fixtures = s.environment.fixtures;
  for (std::size_t i = 0; i < fixtures.size() && s.hands().count() > 0; ++i) {
    if (!fixtures[i].Touches("object")) continue;
    Wall wall;
    wall.hand = *s.hands().begin();
    wall.p_DC = X_WO.p - X_WO * HandlePose(s, wall.hand).p;
    wall.normal = NormalToward(fixtures[i], X_WO.p);
    const auto same = std::find_if(walls.begin(), walls.end(), [&](const FixtureWall& w) {
      return w.wall.normal.dot(wall.normal) > kSameNormal &&
             IsSameKind(fixtures[w.fixtures[0]], fixtures[i]);
    });
    if (same != walls.end()) {
      same->fixtures.push_back(i);
      continue;
    }
    const ContactLaw law = ContactLawOf(fixtures[i], MassAt(world, wall));
    wall.stiffness = law.stiffness, wall.damping = law.damping, wall.inertia = law.inertia;
    walls.push_back({{i}, wall, fixtures[i].stiffness.has_value()});
  }
  return walls;
}

std::vector<ContactReport> CheckContacts(const Scenario& s, const LinearModel& world,
                                         const Pose& X_WO, double lead) {
  std::vector<ContactReport> reports;
  const double dt = 1 / s.rate;
  const HandSpec& hand = s.operator_.hand;
  for (const FixtureWall& at : WallsOf(s, world, X_WO)) {
    ContactReport report{at};
    const Wall& wall = report.wall;
    const auto is_stable = [&](double points) {
      Wall touched = wall;
      touched.stiffness *= points, touched.damping *= points, touched.inertia *= points;
      return HapticLoop(WithWall(world, touched), s, dt).GrowthRate(hand, lead, 1) <=
             HapticLoop::kGrowing;
    };
    report.stable = is_stable(1) && (!report.yields || is_stable(kPoints));
    report.limit = StiffestStableWall(world, s, hand, lead, report.Varying());
    const LinearModel touching = WithWall(world, wall);
    const auto felt = [&](double frequency) {
      return ImpedanceAt(touching, s, lead, dt, wall.normal, frequency);
    };
    report.at_rest = felt(kAtRest);
    report.moving = felt(kFeltFrequency);
    for (const double frequency : FeltFrequencies())
      report.spectrum.push_back({frequency, felt(frequency)});
    reports.push_back(std::move(report));
  }
  return reports;
}

}  // namespace predictor
