#include "haptics/wall.h"

#include <numbers>

#include "core/linear_algebra.h"
#include "haptics/stability.h"

namespace predictor {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

// Returns the wrench about the handle's origin that a unit force along the normal exerts. The
// transpose of this wrench maps the handle's twist to the point's velocity along the normal.
Vector6 UnitForce(const Wall& wall) {
  Vector6 w;
  w << wall.normal, wall.p_DC.cross(wall.normal);
  return w;
}

// Returns the row that maps the states to a displacement, given the row that maps the states to the
// velocity of this displacement.
RowVectorXd Displacement(const LinearModel& world, const RowVectorXd& velocity) {
  RowVectorXd row = RowVectorXd::Zero(velocity.size());
  row.head(world.dof) = velocity.segment(world.dof, world.dof);
  return row;
}

// Solves (s − A) x = b for s = jω as a system of real equations of twice the size.
Eigen::VectorXcd Response(const MatrixXd& A, const VectorXd& b, double omega) {
  const Eigen::Index n = A.rows();
  MatrixXd system(2 * n, 2 * n);
  system << -A, -omega * MatrixXd::Identity(n, n), omega * MatrixXd::Identity(n, n), -A;
  VectorXd right = VectorXd::Zero(2 * n);
  right.head(n) = b;
  const VectorXd x = Solve(system, right);
  Eigen::VectorXcd response(n);
  response.real() = x.head(n);
  response.imag() = x.tail(n);
  return response;
}

Complex Output(const RowVectorXd& row, const Eigen::VectorXcd& states) {
  return {row.dot(states.real()), row.dot(states.imag())};
}

// Returns the ratio of the real handle's motion to the virtual handle's motion.
Complex Following(const ArmSpec& arm, const RenderingSpec& rendering, double lead, double dt,
                  Complex s) {
  const double w = 2 * std::numbers::pi * arm.loop.bandwidth;
  const Complex loop =
      w * w / (s * s + 2 * arm.loop.damping_ratio * w * s + w * w) * std::exp(-s * arm.loop.delay);
  const double cutoff = HapticLoop::LeadCutoff(rendering, dt);
  const Complex ahead = 1.0 + lead * s * cutoff / (s + cutoff);
  return loop * (s * ahead + rendering.kp) / (s + loop * rendering.kp);
}

// Returns the ratio of the force in the virtual world to the force of the hand.
Complex Sensing(const SensorSpec& sensor, Complex s) {
  const Complex late = std::exp(-s * sensor.delay);
  if (sensor.cutoff_frequency <= 0) return late;
  const double cutoff = 2 * std::numbers::pi * sensor.cutoff_frequency;
  return late * cutoff / (s + cutoff);
}

}  // namespace

LinearModel WithWall(const LinearModel& world, const Wall& wall) {
  const Vector6 w = UnitForce(wall);
  const VectorXd b = world.B.middleCols(6 * wall.hand, 6) * w;
  const RowVectorXd velocity = w.transpose() * world.C.middleRows(6 * wall.hand, 6);
  LinearModel model = world;
  model.A -= b * (wall.stiffness * Displacement(world, velocity) + wall.damping * velocity);
  // The inertial force is proportional to the acceleration: (1 + m b c) dx/dt = A x + B u.
  const double share = wall.inertia / (1 + wall.inertia * velocity.dot(b));
  const RowVectorXd rate = velocity * model.A, input = velocity * model.B;
  model.A -= share * b * rate;
  model.B -= share * b * input;
  return model;
}

double MassAt(const LinearModel& world, const Wall& wall) {
  const Vector6 w = UnitForce(wall);
  const VectorXd b = world.B.middleCols(6 * wall.hand, 6) * w;
  return 1 / (w.transpose() * world.C.middleRows(6 * wall.hand, 6)).dot(b);
}

FeltImpedance ImpedanceAt(const LinearModel& world, const Scenario& scenario, double lead,
                          double dt, const Vector3& direction, double frequency) {
  const double omega = 2 * std::numbers::pi * frequency;
  const Complex s(0, omega);
  const double share = 1.0 / scenario.hands().count();
  // The force is divided equally among the hands, and each part acts through the sensor of its
  // hand.
  Eigen::VectorXcd requested = Eigen::VectorXcd::Zero(world.A.rows()), sensed = requested;
  for (const int h : scenario.hands()) {
    const VectorXd force = share * world.B.middleCols(6 * h, 3) * direction;
    const Eigen::VectorXcd motion = Response(world.A, force, omega);
    requested += motion;
    sensed += Sensing(scenario.arm(h).sensor, s) * motion;
  }
  Complex virtual_handles = 0, real_handles = 0;
  for (const int h : scenario.hands()) {
    const RowVectorXd velocity = direction.transpose() * world.C.middleRows(6 * h, 3);
    const RowVectorXd row = share * Displacement(world, velocity);
    virtual_handles += Output(row, requested);
    real_handles +=
        Following(scenario.arm(h), scenario.rendering, lead, dt, s) * Output(row, sensed);
  }
  return {1.0 / virtual_handles, 1.0 / real_handles};
}

}  // namespace predictor
