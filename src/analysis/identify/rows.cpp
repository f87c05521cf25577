#include "analysis/identify/rows.h"

#include <cmath>
#include <numbers>

#include "models/arm_model.h"

namespace predictor {
namespace {

// Largest share of a window's weight during which the joint may have been at rest. Above this
// share, the row contains too little information about the joint's friction.
constexpr double kMaxRestShare = 0.1;

int TicksOf(double window, double dt) {
  return std::max(4, 2 * static_cast<int>(std::lround(window / dt / 2)));
}

// Returns the matrix L(w) with I w = L(w) (xx xy yy xz yz zz).
Eigen::Matrix<double, 3, 6> InertiaTimes(const Vector3& w) {
  Eigen::Matrix<double, 3, 6> L;
  L << w.x(), w.y(), 0, w.z(), 0, 0,  //
      0, w.x(), w.y(), 0, w.z(), 0,   //
      0, 0, 0, w.x(), w.y(), w.z();
  return L;
}

// Returns the columns of the wrench about O, in axes of W, that moves a body with parameters π (in
// O).
Eigen::Matrix<double, 6, 10> BodyRegressor(const Matrix3& R_WO, const Vector3& a, const Vector3& w,
                                           const Vector3& dw) {
  Eigen::Matrix<double, 6, 10> Y = Eigen::Matrix<double, 6, 10>::Zero();
  Y.block<3, 1>(0, 0) = a;
  Y.block<3, 3>(0, 1) = (Skew(dw) + Skew(w) * Skew(w)) * R_WO;
  Y.block<3, 3>(3, 1) = -Skew(a) * R_WO;
  const Vector3 w_O = R_WO.transpose() * w;
  const Vector3 dw_O = R_WO.transpose() * dw;
  Y.block<3, 6>(3, 4) = R_WO * (InertiaTimes(dw_O) + Skew(w_O) * InertiaTimes(w_O));
  return Y;
}

// Removes from wrenches about A the components that the attachment's joint does not transmit.
void Transmit(JointType joint, const Vector3& axis_W, Eigen::Ref<Eigen::MatrixXd> wrenches) {
  switch (joint) {
    case JointType::kFixed:
      break;
    case JointType::kSpherical:
      wrenches.bottomRows<3>().setZero();
      break;
    case JointType::kRevolute:
      wrenches.bottomRows<3>() -= (axis_W * axis_W.transpose() * wrenches.bottomRows<3>()).eval();
      break;
    case JointType::kPrismatic:
      wrenches.topRows<3>() -= (axis_W * axis_W.transpose() * wrenches.topRows<3>()).eval();
      break;
  }
}

// Returns the wrench about A that the damping of the attachment's joint exerts on the load while it
// moves relative to the cobot with the twist V.
Wrench AttachmentDamping(const AttachmentSpec& spec, const Vector3& axis_W, const Twist& V) {
  Wrench F = Wrench::Zero();
  switch (spec.joint) {
    case JointType::kFixed:
      break;
    case JointType::kSpherical:
      F.tail<3>() = -spec.damping * V.tail<3>();
      break;
    case JointType::kRevolute:
      F.tail<3>() = -spec.damping * axis_W.dot(V.tail<3>()) * axis_W;
      break;
    case JointType::kPrismatic:
      F.head<3>() = -spec.damping * axis_W.dot(V.head<3>()) * axis_W;
      break;
  }
  return F;
}

Vector3 Position(const PoseRecord& r) { return Vector3(r.p[0], r.p[1], r.p[2]); }
Vector6 Six(const std::array<double, 6>& x) { return Eigen::Map<const Vector6>(x.data()); }

}  // namespace

RowBuilder::RowBuilder(const Scenario& nominal, double window)
    : attachment_(nominal.object.attachment),
      gravity_(nominal.environment.gravity),
      dt_(1 / nominal.rate),
      ticks_(TicksOf(window, dt_)),
      hop_(ticks_ / 2),
      robot_(LoadCobotModel(nominal)),
      load_(LoadObject(nominal.object, nominal.folder())),
      data_(*robot_),
      regressor_(*robot_, gravity_),
      end_effector_(robot_->Frame(nominal.cobot.end_effector)),
      A_(robot_->Frame(nominal.cobot.end_effector, attachment_.on_end_effector.ToPose())),
      rows_(static_cast<std::size_t>(robot_->dof())) {
  for (int i = 0; i < ticks_; ++i) {
    const double phase = 2 * std::numbers::pi * (i + 0.5) / ticks_;
    weight_.push_back((1 - std::cos(phase)) / ticks_);
  }
  const int n = robot_->dof();
  x_.setZero(n, columns() - kFrictionColumns);
  y_.setZero(n);
}

RowBuilder::Sample RowBuilder::Take(const TickRecord& r) const {
  Sample s;
  s.tick = r.tick;
  s.ran = r.ran != 0;
  s.q = Eigen::Map<const Eigen::VectorXd>(r.cobot_q.data(), robot_->dof());
  s.torque = Eigen::Map<const Eigen::VectorXd>(r.cobot_torque.data(), robot_->dof());
  s.X_WO = FromRecord(r.object.pose);
  s.V_WE = Six(r.end_effector.twist);
  for (std::size_t h = 0; h < kHands; ++h) {
    s.F_D_W[h].setZero();
    s.p_WD[h] = Position(r.hands[h].virtual_.pose);
    if (r.hands[h].present) s.F_D_W[h] = Six(r.hands[h].wrench) + Six(r.hands[h].coupling);
  }
  return s;
}

bool RowBuilder::Sample::IsFinite() const {
  bool finite = q.allFinite() && torque.allFinite() && predictor::IsFinite(X_WO) &&
                X_WO.q.squaredNorm() > 0 && V_WE.allFinite();
  for (std::size_t h = 0; h < kHands; ++h)
    finite = finite && p_WD[h].allFinite() && F_D_W[h].allFinite();
  return finite;
}

void RowBuilder::Add(const TickRecord& record) {
  recorded_joints_ = record.cobot_dof;
  if (record.cobot_dof != robot_->dof()) return;
  if (any_ && record.tick <= last_[2].tick) return;  // otherwise a window would be filled twice
  Sample sample = Take(record);
  if (!sample.IsFinite()) {
    ++not_finite_;
    consecutive_ = 0;
    return;
  }
  any_ = true;
  last_[0] = last_[1];
  last_[1] = last_[2];
  last_[2] = std::move(sample);
  consecutive_ = last_[2].tick == last_[1].tick + 1 ? std::min(3, consecutive_ + 1) : 1;
  if (consecutive_ == 3 && last_[0].ran && last_[1].ran) AddEquation(last_[0], last_[1], last_[2]);
}

// Computes speed and acceleration from positions alone, so that both belong to the time at which
// the tick's forces act. The window smooths the noise of the differences.
void RowBuilder::AddEquation(const Sample& before, const Sample& now, const Sample& after) {
  const JointVector v = (after.q - before.q) / (2 * dt_);
  const JointVector a = (after.q - 2 * now.q + before.q) / (dt_ * dt_);
  data_.UpdateKinematics(*robot_, now.q, v);
  x_.leftCols(10 * robot_->dof()) = regressor_.Compute(now.q, v, a);
  y_ = now.torque;
  AddLoad(before, now, after);
  Accumulate(v, now.tick);
}

// Computes the motion of the load in the same way as AddEquation computes the motion of the joints.
void RowBuilder::AddLoad(const Sample& before, const Sample& now, const Sample& after) {
  const Pose& X = now.X_WO;
  const Vector3 w_before = RotationError(X.q, before.X_WO.q) / dt_;
  const Vector3 w_after = RotationError(after.X_WO.q, X.q) / dt_;
  const Vector3 w = (w_before + w_after) / 2;
  const Vector3 against_gravity =
      (after.X_WO.p - 2 * X.p + before.X_WO.p) / (dt_ * dt_) + Vector3(0, 0, gravity_);
  const Pose X_WA = data_.FramePose(*robot_, A_);
  const Vector3 r_AO = X.p - X_WA.p;
  Eigen::Matrix<double, 6, 11> wrench;  // columns of the load's parameters, then one for the hands
  wrench.leftCols<10>() = BodyRegressor(X.R(), against_gravity, w, (w_after - w_before) / dt_);
  wrench.bottomLeftCorner<3, 10>() += Skew(r_AO) * wrench.topLeftCorner<3, 10>();
  wrench.col(10).setZero();
  for (std::size_t h = 0; h < kHands; ++h)
    wrench.col(10) += ShiftWrench(now.F_D_W[h], now.p_WD[h] - X_WA.p);
  const Vector3 axis_W = X_WA.q * attachment_.axis.normalized();
  Transmit(attachment_.joint, axis_W, wrench);
  Twist V_WO;
  V_WO << (after.X_WO.p - before.X_WO.p) / (2 * dt_), w;
  const Twist relative = ShiftTwist(V_WO, -r_AO) -
                         ShiftTwist(now.V_WE, X_WA.p - data_.FramePose(*robot_, end_effector_).p);
  wrench.col(10) -= AttachmentDamping(attachment_, axis_W, relative);
  Jacobian J;
  data_.FrameJacobian(*robot_, A_, &J);
  x_.rightCols<10>() = J.transpose() * wrench.leftCols<10>();
  y_ += J.transpose() * wrench.col(10);
}

void RowBuilder::Accumulate(const JointVector& v, std::uint64_t tick) {
  ++used_;
  for (int j = 0; j < v.size(); ++j) {
    JointRows& rows = rows_[static_cast<std::size_t>(j)];
    if (std::abs(v[j]) < kTurning) continue;
    rows.moving[v[j] > 0 ? 1 : 0] += dt_;
    if (tick % 16 == 0) rows.speed.push_back(static_cast<float>(std::abs(v[j])));
  }
  const long newest = static_cast<long>(tick) / hop_;
  for (long index = std::max(0L, newest - 1); index <= newest; ++index) {
    Window& w = open_[static_cast<std::size_t>(index % 2)];
    if (w.index != index) {
      w.index = index;
      w.ticks = 0;
      w.x.setZero(robot_->dof(), columns());
      w.y.setZero(robot_->dof());
      w.still.setZero(robot_->dof());
    }
    const double h = weight_[static_cast<std::size_t>(static_cast<long>(tick) - index * hop_)];
    for (int j = 0; j < v.size(); ++j) {
      w.x(j, 0) += h * v[j];
      w.x(j, 1) += h * (v[j] > 0 ? 1 : -1);
      if (std::abs(v[j]) < kStill) w.still[j] += h;
    }
    w.x.rightCols(x_.cols()) += h * x_;
    w.y += h * y_;
    if (++w.ticks == ticks_) Close(&w);
  }
}

void RowBuilder::Close(Window* w) {
  for (int j = 0; j < robot_->dof(); ++j) {
    if (w->still[j] > kMaxRestShare) continue;
    if (!w->x.row(j).allFinite() || !std::isfinite(w->y[j])) continue;  // overflow of large numbers
    JointRows& rows = rows_[static_cast<std::size_t>(j)];
    rows.window.push_back(w->index);
    rows.y.push_back(w->y[j]);
    for (int c = 0; c < w->x.cols(); ++c) rows.x.push_back(w->x(j, c));
  }
}

}  // namespace predictor
