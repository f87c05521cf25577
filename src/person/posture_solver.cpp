#include "person/posture_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "person/posture_follower.h"
#include "person/posture_tasks.h"
#include "qp/qp.h"

namespace predictor::person {
namespace {

static_assert(kBodyJoints <= kMaxQpVariables);

constexpr double kPriorWeight = 1e-3;
constexpr double kLargestStep = 0.4;  // largest step of a joint [rad] or [m]
constexpr double kMaxDamping = 1e4;

// One stage of the solver: the tasks that count, whether the prior counts, and the condition that
// ends the stage.
struct Stage {
  bool hands_only;
  double damping, min_damping;  // initial and smallest damping
  double step;                  // the stage ends below this step [rad], [m] ...
  double error;                 // ... or below this error [m]
  int max_iterations;
};
constexpr Stage kCompromise = {false, 1e-3, 1e-9, 1e-6, 0, 80};
constexpr Stage kExact = {true, 1e-6, 1e-10, 1e-13, 1e-10, 60};
constexpr Stage kFollow = {false, 1e-5, 1e-9, 1e-6, 0, kFollowIterations};

// The memory that the search for a posture needs.
struct Workspace {
  TaskRows rows;
  Qp qp{kBodyJoints, 0};
  QpSolver solver{kBodyJoints, 0};
  QpSolution solution;
};

class Descent {
 public:
  Descent(const PostureTasks& tasks, const BodyModel& model, const PosturePrior& prior,
          Workspace* work)
      : tasks_(tasks),
        prior_(prior),
        lower_(model.lower()),
        upper_(model.upper()),
        rows_(work->rows),
        qp_(work->qp),
        solver_(work->solver),
        solution_(work->solution) {}

  // Improves q after moving it within the limits. Returns the number of iterations.
  int Run(const Stage& stage, BodyVector* q) {
    *q = q->cwiseMax(lower_).cwiseMin(upper_);
    double damping = stage.damping;
    double cost = Cost(stage, *q, true);
    int i = 0;
    while (i < stage.max_iterations && rows_.error().norm() >= stage.error) {
      ++i;
      const BodyVector step = Step(stage, *q, damping);
      const BodyVector trial = (*q + step).cwiseMax(lower_).cwiseMin(upper_);
      const double trial_cost = Cost(stage, trial, false);
      if (trial_cost < cost) {
        *q = trial;
        damping = std::max(stage.min_damping, damping * 0.1);
        if (step.cwiseAbs().maxCoeff() < stage.step) break;
        cost = Cost(stage, *q, true);
      } else {
        if (step.cwiseAbs().maxCoeff() < stage.step) break;
        damping *= 10;
        if (damping > kMaxDamping) break;
        Cost(stage, *q, true);
      }
    }
    return i;
  }

 private:
  double Cost(const Stage& stage, const BodyVector& q, bool with_jacobian) {
    tasks_.Rows(q, stage.hands_only, with_jacobian, &rows_);
    double cost = rows_.error().squaredNorm();
    if (!stage.hands_only)
      cost += (prior_.weight.array() * (q - prior_.comfort).array().square()).sum() +
              prior_.lowering * std::hypot(q[kPelvisZ], kLoweringSmooth);
    return cost;
  }

  BodyVector Step(const Stage& stage, const BodyVector& q, double damping) {
    qp_.Clear();
    const auto J = rows_.jacobian();
    qp_.H().noalias() = J.transpose() * J;
    qp_.f().noalias() = -J.transpose() * rows_.error();
    qp_.H().diagonal().array() += damping;
    if (!stage.hands_only) {
      qp_.H().diagonal() += prior_.weight;
      qp_.f() += prior_.weight.cwiseProduct(q - prior_.comfort);
      const double root = std::hypot(q[kPelvisZ], kLoweringSmooth);
      qp_.f()[kPelvisZ] += prior_.lowering / 2 * q[kPelvisZ] / root;
      qp_.H()(kPelvisZ, kPelvisZ) +=
          prior_.lowering / 2 * kLoweringSmooth * kLoweringSmooth / (root * root * root);
    }
    qp_.lower() = (lower_ - q).cwiseMax(-kLargestStep).cwiseMin(0.0);
    qp_.upper() = (upper_ - q).cwiseMin(kLargestStep).cwiseMax(0.0);
    solver_.Solve(qp_, &solution_);
    if (!solution_.solved) return BodyVector::Zero();
    return Eigen::Map<const BodyVector>(solution_.x.data());
  }

  const PostureTasks& tasks_;
  const PosturePrior& prior_;
  BodyVector lower_, upper_;
  TaskRows& rows_;
  Qp& qp_;
  QpSolver& solver_;
  QpSolution& solution_;
};

}  // namespace

PosturePrior DefaultPrior() {
  PosturePrior prior;
  prior.comfort.setZero();
  prior.weight.setConstant(1);
  prior.weight.segment<6>(kPelvisX) << 30, 60, 20, 20, 30, 30;
  prior.weight.segment<3>(kTorsoFlexion) << 15, 20, 12;
  prior.weight.segment<3>(kNeckFlexion) << 2, 2, 2;
  prior.comfort[kNeckFlexion] = 0.2;
  for (int hand = 0; hand < kHands; ++hand) {
    const auto comfort = [&](ArmJoint joint, double q, double weight) {
      prior.comfort[Of(hand, joint)] = q;
      prior.weight[Of(hand, joint)] = weight;
    };
    comfort(ArmJoint::kShoulderFlexion, 0.3, 1);
    comfort(ArmJoint::kShoulderAbduction, 0.25, 1);
    comfort(ArmJoint::kShoulderRotation, 0.1, 0.5);
    comfort(ArmJoint::kElbowFlexion, 1.2, 1);
    comfort(ArmJoint::kPronation, 0, 0.5);
    comfort(ArmJoint::kWristFlexion, -0.1, 1);
    comfort(ArmJoint::kWristDeviation, 0.1, 2);
  }
  prior.weight *= kPriorWeight;
  return prior;
}

PostureSolver::PostureSolver(const BodyModel& model, const Stance& stance,
                             const std::array<Grip, kHands>& grips, const PosturePrior& prior)
    : model_(model), stance_(stance), grips_(grips), prior_(prior) {}

Posture PostureSolver::Solve(const BodySample& sample, const BodyVector& start) const {
  const PostureTasks tasks(model_, stance_, grips_, prior_, sample);
  Workspace work;
  Descent descent(tasks, model_, prior_, &work);
  Posture posture;
  posture.q = start;
  posture.iterations = descent.Run(kCompromise, &posture.q);
  posture.iterations += descent.Run(kExact, &posture.q);
  tasks.Judge(&posture);
  return posture;
}

struct PostureFollower::Impl {
  Workspace work;
};

PostureFollower::PostureFollower(const PostureSolver& solver)
    : solver_(solver), impl_(std::make_unique<Impl>()) {}
PostureFollower::~PostureFollower() = default;

void PostureFollower::Follow(const BodySample& sample, BodyVector* q) noexcept {
  const PostureTasks tasks(solver_.model(), solver_.stance(), solver_.grips(), solver_.prior(),
                           sample);
  Descent(tasks, solver_.model(), solver_.prior(), &impl_->work).Run(kFollow, q);
}

}  // namespace predictor::person
