#include "simulation/equilibrium.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/text.h"

namespace predictor {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTolerance = 1e-8;  // tolerance of accelerations [rad/s², m/s²]
constexpr int kIterations = 1000;
constexpr double kMaxStep = 0.1;      // maximum change of a coordinate in an iteration [rad, m]
constexpr double kPseudoTime = 0.01;  // first step of the flow, squared [s²]
constexpr double kDifference = 1e-6;  // step of finite differences [rad, m]
constexpr double kUnstable = -0.01;  // eigenvalue of M⁻¹ H below which the scene is unstable [1/s²]
constexpr double kNudge = 0.01;      // away from an unstable equilibrium [rad, m]

// Searches by the implicit flow M dq = τ r(q ⊕ dq), where r is the generalised force at rest. While
// the pseudo-time τ is small, this is a heavily damped motion; when τ is large, it is Newton's
// method.
class EquilibriumSearch {
 public:
  EquilibriumSearch(ControlledScene* scene, mjData* data) : scene_(*scene), data_(data) {
    options_ = scene_.model()->opt;
    scene_.model()->opt.disableflags |= mjDSBL_FRICTIONLOSS;
    // Contacts must be solved more accurately than kTolerance.
    scene_.model()->opt.tolerance = 1e-14;
  }
  ~EquilibriumSearch() { scene_.model()->opt = options_; }

  // Returns the largest remaining acceleration; the search succeeded if it is below kTolerance.
  double Run() {
    VectorXd r = Force();
    double tau = kPseudoTime;
    double before = Residual();
    for (int i = 0; i < kIterations; ++i) {
      const MatrixXd H = Stiffness();
      const MatrixXd M = Inertia();
      const Modes modes = ModesOf(Solve(M, H));
      Eigen::Index worst = 0;
      const double softest = modes.eigenvalues.real().minCoeff(&worst);
      if (before < kTolerance && softest > kUnstable) return before;
      if (before < kTolerance) {
        // An unstable equilibrium (an object balanced above its joint): push the object off.
        const VectorXd away = modes.eigenvectors.col(worst).real();
        Move(kNudge * away / away.lpNorm<Eigen::Infinity>());
        tau = kPseudoTime;
      } else {
        // Limits the pseudo-time so that the flow still leaves unstable equilibria.
        if (softest < 0) tau = std::min(tau, -0.5 / softest);
        Move(Solve(M / tau + H, r));
      }
      r = Force();
      const double now = Residual();
      if (!std::isfinite(now)) return now;
      tau *= std::clamp(2 * before / now, 0.3, 10.0);
      before = now;
    }
    return before;
  }

 private:
  int nv() const { return static_cast<int>(scene_.model()->nv); }

  // Generalised force M·qacc at rest in the present posture [N·m, N].
  VectorXd Force() {
    std::fill_n(data_->qvel, nv(), 0.0);
    std::fill_n(data_->qacc_warmstart, nv(), 0.0);
    if (!scene_.Update(data_) || !scene_.ApplyController(0, data_)) {
      return VectorXd::Constant(nv(), std::nan(""));
    }
    mj_forwardSkip(scene_.model(), data_, mjSTAGE_VEL, 1);
    VectorXd r(nv());
    mj_mulM(scene_.model(), data_, r.data(), data_->qacc);
    return r;
  }

  double Residual() const {
    return Eigen::Map<const VectorXd>(data_->qacc, nv()).lpNorm<Eigen::Infinity>();
  }

  MatrixXd Inertia() const {
    MatrixXd M(nv(), nv());
    mj_fullM(scene_.model(), data_, M.data());  // symmetric: the storage order does not matter
    return M;
  }

  // Moves by dq in the tangent space, limited in each coordinate.
  void Move(VectorXd dq) {
    const double largest = dq.lpNorm<Eigen::Infinity>();
    if (largest > kMaxStep) dq *= kMaxStep / largest;
    mj_integratePos(scene_.model(), data_->qpos, dq.data(), 1);
  }

  // H = −∂r/∂q by central differences.
  MatrixXd Stiffness() {
    const VectorXd start = Eigen::Map<VectorXd>(data_->qpos, scene_.model()->nq);
    MatrixXd H(nv(), nv());
    for (int i = 0; i < nv(); ++i) {
      const VectorXd step = kDifference * VectorXd::Unit(nv(), i);
      Eigen::Map<VectorXd> q(data_->qpos, start.size());
      mj_integratePos(scene_.model(), data_->qpos, step.data(), 1);
      const VectorXd ahead = Force();
      q = start;
      mj_integratePos(scene_.model(), data_->qpos, step.data(), -1);
      H.col(i) = (Force() - ahead) / (2 * kDifference);
      q = start;
    }
    Force();
    return H;
  }

  ControlledScene& scene_;
  mjData* data_;
  mjOption options_;
};

// The reason why the cobot cannot hold the object in the posture where the search ended, and the
// key that sets it; "" if nothing prevents it.
struct Obstacle {
  std::string key, text;
};

Obstacle ObstacleIn(const ControlledScene& scene) {
  const RobotModel& robot = scene.robot();
  if (scene.outcome() == ControllerOutcome::kFailed)
    return {"cobot.controller", "its program does not answer, or with torques that are not finite"};
  for (int j = 0; j < robot.dof(); ++j) {
    const double limit = scene.effort_limit()[j];
    if (std::fabs(scene.torque()[j]) < limit) continue;
    return {"cobot.effort_limit",
            "joint " + Quote(robot.joint_name(j)) + " would need more than its effort limit of " +
                FormatNumber(limit) + " " + robot.effort_unit(j) + " (set by this key)"};
  }
  for (int j = 0; j < robot.dof(); ++j) {
    const double q = scene.q()[j];
    if (q >= robot.position_lower()[j] && q <= robot.position_upper()[j]) continue;
    return {"cobot.controller",
            "it sags until joint " + Quote(robot.joint_name(j)) + " reaches its position limit"};
  }
  return {};
}

}  // namespace

void FindEquilibrium(ControlledScene* scene, mjData* data) {
  mj_resetData(scene->model(), data);
  for (int j = 0; j < scene->posture().size(); ++j) {
    data->qpos[scene->scene().qpos[static_cast<std::size_t>(j)]] = scene->posture()[j];
  }
  const double residual = EquilibriumSearch(scene, data).Run();
  Obstacle obstacle = ObstacleIn(*scene);
  if (residual < kTolerance && obstacle.text.empty()) return;
  if (obstacle.text.empty()) obstacle = {"cobot.posture", "no static equilibrium was found"};
  throw InputError::At(obstacle.key,
                       obstacle.key +
                           ": the cobot cannot hold the object at cobot.posture: " + obstacle.text +
                           ". Increase the stiffness of cobot.controller, choose another "
                           "cobot.posture, use a lighter object, or add a table.");
}

}  // namespace predictor
