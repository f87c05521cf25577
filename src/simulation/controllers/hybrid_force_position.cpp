// Hybrid force and position control (Raibert & Craig 1981, "Hybrid position/force control of
// manipulators"; Khatib 1987, "A unified approach for motion and force control of robot
// manipulators"). Along the axes of W that S selects, the cobot exerts a set force. Along the other
// axes, a spring holds the position of the set-point x_d, which is that of the start unless there
// is a trajectory.
//
//   F = S (F_d + I + k_p (F_d − F_m)) + (1 − S) K (x_d − x),   İ = k_i (F_d − F_m)
//
// F_m is the force of the cobot on the load. The wrist sensor measures F_m, including the load's
// weight. I is bounded, so that it does not wind up while the load moves freely. The damping, the
// orientation and the torques are described in wrench_control.h. The memory contains I and the last
// F_d − F_m.
#include <algorithm>
#include <array>
#include <string>

#include "simulation/controllers/controllers.h"
#include "simulation/controllers/set_point.h"
#include "simulation/controllers/wrench_control.h"

namespace predictor::controllers {
namespace {

struct HybridParameters {
  WrenchControlParameters control;
  std::string axes = "z";
  Vector3 force = {0, 0, 0};            // F_d [N]
  double gain = 0.2;                    // k_p
  double integral_gain = 5;             // k_i [1/s]
  double integral_limit = 20;           // of |I| along each axis [N]
  Vector3 stiffness = {500, 500, 500};  // K [N/m]
  SetPointParameters set_point;
};

template <class V>
void Fields(V& v, HybridParameters& p) {
  v("force_axes", p.axes,
    Word("axes of W that are force-controlled", {"x", "y", "z", "xy", "xz", "yz", "xyz"}));
  v("set_force", p.force, Number("N", "force of the cobot on the load, in W", Within(1e4)));
  v("force_gain", p.gain, Number("", "proportional gain of the force", From(0, 10)));
  v("force_integral_gain", p.integral_gain,
    Number("1/s", "integral gain of the force", From(0, 1000)));
  v("force_integral_limit", p.integral_limit,
    Number("N", "largest force of the integral term along each axis", From(0, 1e4)));
  v("stiffness_translation", p.stiffness,
    Number("N/m", "stiffness of the spring along the other axes, towards the set-point",
           From(0, 1e5)));
  Fields(v, p.control);
  Fields(v, p.set_point);
}

class HybridForcePosition final : public WrenchControl {
 public:
  HybridForcePosition(const ControllerContext& context, const HybridParameters& parameters)
      : WrenchControl(context, parameters.control),
        p_(parameters),
        set_point_(parameters.set_point.trajectory, context.X_WE_start) {
    for (int i = 0; i < 3; ++i) selected_[i] = p_.axes.find("xyz"[i]) != std::string::npos ? 1 : 0;
    free_ = Vector3::Ones() - selected_;
  }

  bool uses_wrist_sensor() const noexcept override { return true; }
  std::span<double> memory() noexcept override { return memory_; }
  Vector6 set_point_axes() const noexcept override {
    Vector6 axes = WrenchControl::set_point_axes();
    axes.head<3>() = (free_.cwiseProduct(p_.stiffness).array() > 0).cast<double>();
    return axes;
  }
  void Start(const ControllerInput&) noexcept override { memory_.fill(0); }

  void Advance(const ControllerInput& input, double dt) noexcept override {
    const Vector3 error = selected_.cwiseProduct(p_.force + input.F_E_W.head<3>());
    auto integral = Vector3::Map(memory_.data());
    integral = (integral + dt * p_.integral_gain * error)
                   .cwiseMax(-p_.integral_limit)
                   .cwiseMin(p_.integral_limit);
    Vector3::Map(memory_.data() + 3) = error;
  }

 private:
  // Along the axes of the set force, the set-point rests.
  FrameMotion SetPoint(double time) const noexcept override {
    FrameMotion motion = set_point_.At(time);
    motion.V_W.head<3>() = free_.cwiseProduct(motion.V_W.head<3>());
    return motion;
  }

  Wrench Command(const Pose& set_point, const Pose& X, const Twist&) noexcept override {
    const auto integral = Vector3::Map(memory_.data()), error = Vector3::Map(memory_.data() + 3);
    Wrench F = Wrench::Zero();
    F.head<3>() = selected_.cwiseProduct(p_.force) + integral + p_.gain * error +
                  free_.cwiseProduct(p_.stiffness).cwiseProduct(set_point.p - X.p);
    return F;
  }

  double Potential(const Pose& X, const Pose& set_point) const noexcept override {
    const Vector3 e = set_point.p - X.p;
    return 0.5 * e.dot(free_.cwiseProduct(p_.stiffness).cwiseProduct(e)) -
           selected_.cwiseProduct(p_.force).dot(X.p);
  }

  HybridParameters p_;
  SetPointTrajectory set_point_;
  Vector3 selected_, free_;  // diagonals of S and 1 − S
  std::array<double, 6> memory_ = {};
};

}  // namespace

const ControllerKind kHybridForcePosition = ControllerKindOf<HybridForcePosition, HybridParameters>(
    "hybrid_force_position", "a set force along some axes, a spring along the others");

}  // namespace predictor::controllers
