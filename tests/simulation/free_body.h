// Simulates a free body among fixtures in either engine, for comparisons with closed forms.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "scenes.h"
#include "simulation/dart/dart_engine.h"
#include "simulation/engine.h"

namespace predictor {

inline constexpr double kFormAccuracy = 0.02;   // of a closed form, relative
inline constexpr double kOneStep = 1e-3;        // [s]
inline constexpr double kBodyMass = 2;          // [kg]
inline const Vector3 kOrigin = {2, 0, 1};       // out of the cobot's reach [m]
inline const Vector3 kBlock = {0.2, 0.2, 0.1};  // [m]

inline FixtureSpec Fixture(FixtureShape shape, const Vector3& size, const Vector3& xyz,
                           const Vector3& rpy = Vector3::Zero()) {
  FixtureSpec fixture;
  fixture.shape = shape;
  fixture.size = size;
  fixture.xyz = xyz;
  fixture.rpy = rpy;
  return fixture;
}

// Returns a table whose top is at kOrigin.
inline FixtureSpec TableTop(double friction) {
  FixtureSpec table = Fixture(FixtureShape::kBox, {4, 1, 0.1}, kOrigin - Vector3(0, 0, 0.05));
  table.friction = friction;
  return table;
}

inline Scenario SceneOfBody(Shape shape, const Vector3& size,
                            const std::vector<FixtureSpec>& fixtures, double gravity,
                            EngineKind kind) {
  Scenario s = PandaScene();
  s.object.primitive = PrimitiveSpec{};
  s.object.primitive->shape = shape;
  s.object.primitive->size = size;
  s.object.primitive->mass = kBodyMass;
  s.environment.fixtures = fixtures;
  s.environment.gravity = gravity;
  s.simulation.engine = kind;
  return s;
}

// The scene contains the cobot, which does not touch the body.
class FreeBody {
 public:
  FreeBody(Shape shape, const Vector3& size, const std::vector<FixtureSpec>& fixtures,
           double gravity = kGravity, EngineKind kind = EngineKind::kMujoco)
      : FreeBody(SceneOfBody(shape, size, fixtures, gravity, kind)) {}
  explicit FreeBody(const Scenario& s)
      : robot_(RobotModel::Load(
            {s.cobot.model, s.folder(), s.cobot.remove_links, s.cobot.base.ToPose(), "cobot"})),
        engine_(s.simulation.engine == EngineKind::kDart
                    ? MakeDartEngine(s, *robot_, Holding::kFree)
                    : MakeEngine(s, *robot_, false, Holding::kFree)) {}

  void Place(const Pose& X, const Vector3& v = Vector3::Zero()) {
    FrameMotion O;
    O.X_W = X;
    O.V_W.head<3>() = v;
    engine_->Clear();
    engine_->MoveObject(O);
    ASSERT_TRUE(engine_->Prepare());
  }
  // Simulates the body under the wrench F and averages the contacts' forces.
  void Run(double duration, const Wrench& F = Wrench::Zero()) {
    engine_->SetObjectWrench(F);
    const int steps = static_cast<int>(std::lround(duration / kOneStep));
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < steps; ++k) {
      ASSERT_TRUE(engine_->Advance()) << engine_->Failure();
      for (int i = 0; i < engine_->contact_count(); ++i) sum += engine_->contact(i).force_W;
      ASSERT_TRUE(engine_->Prepare());
    }
    mean_force_ = sum / steps;
  }
  // Returns how high the body rises above `level` in this time [m].
  double Rise(double duration, double level) {
    double highest = -HUGE_VAL;
    for (int k = 0; k < static_cast<int>(std::lround(duration / kOneStep)); ++k) {
      Run(kOneStep);
      highest = std::max(highest, pose().p.z() - level);
    }
    return highest;
  }
  Pose pose() const { return engine_->PoseOf(SceneBody::kObject); }
  Vector3 velocity() const { return engine_->MotionOf(SceneBody::kObject).V_W.head<3>(); }
  double tilt() const { return std::acos(std::min(1.0, pose().R()(2, 2))); }  // [rad]
  Engine& engine() { return *engine_; }

  // ContactForce returns the mean of the contacts' forces in the last Run, because a sliding body
  // hops. Depth returns the greatest penetration [m].
  const Vector3& ContactForce() const { return mean_force_; }
  double Depth() const {
    double depth = 0;
    for (int i = 0; i < engine_->contact_count(); ++i)
      depth = std::max(depth, engine_->contact(i).depth);
    return depth;
  }

 private:
  std::shared_ptr<const RobotModel> robot_;
  std::unique_ptr<Engine> engine_;
  Vector3 mean_force_ = Vector3::Zero();
};

// ---- a slope -----------------------------------------------------------------------------------

inline constexpr double kSlope = 20 * M_PI / 180;  // [rad]; its tangent is 0.364

// Returns a slope through kOrigin that falls along x. The slope is a plane or the upper face of a
// box.
inline FixtureSpec Slope(FixtureShape shape, double friction) {
  const Pose X = PoseFromXyzRpy(kOrigin, {0, kSlope, 0});
  const bool plane = shape == FixtureShape::kPlane;
  FixtureSpec slope =
      Fixture(shape, {6, 1, plane ? 0 : 0.1}, X * Vector3(0, 0, plane ? 0 : -0.05), {0, kSlope, 0});
  slope.friction = friction;
  return slope;
}

inline Pose OnSlope(double height) {
  const Pose X = PoseFromXyzRpy(kOrigin, {0, kSlope, 0});
  return {X * Vector3(0, 0, height), X.q};
}

// ---- an impact ---------------------------------------------------------------------------------

// Returns the fraction of its speed that a body keeps if a linear spring and damper pushes it back
// but does not pull it (Schwager & Pöschel, Granular Matter 9:465, 2007, eq. 20).
inline double Restitution(double zeta) {
  const double omega = std::sqrt(1 - zeta * zeta);  // in units of the undamped one
  const double angle = std::atan2(2 * zeta * omega, omega * omega - zeta * zeta);
  return std::exp(-zeta / omega * (M_PI - angle));
}

// Returns the height above the contact to which a ball rises again after it has arrived at the
// speed v [m]. The spring and damper are those of Restitution. The weight of the ball also acts,
// and the motion is integrated in small steps. `omega` is the undamped frequency [rad/s].
inline double HeightOfBounce(double omega, double zeta, double v) {
  constexpr double kSmallStep = 1e-6;  // [s]
  double z = 0, speed = -v;
  for (;;) {
    const double push = -omega * omega * z - 2 * zeta * omega * speed;
    if (push < 0) return z + speed * speed / (2 * kGravity);
    speed += kSmallStep * (push - kGravity);
    z += kSmallStep * speed;
  }
}

}  // namespace predictor
