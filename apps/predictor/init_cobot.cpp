#include "init_cobot.h"

#include <Eigen/SVD>
#include <algorithm>
#include <random>

#include "core/error.h"
#include "core/text.h"
#include "models/arm_chain.h"
#include "models/robot.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxLoad = 0.6;  // maximum load of a joint at rest, relative to its limit
constexpr std::size_t kMaxCandidates = 40, kMaxPostures = 5;

// A posture of the cobot with which the run could begin.
struct Posture {
  double suitability = 0;
  JointVector q;
  Pose X_WE;
};

// Returns the largest joint torque, relative to its limit, that holds the robot and an object of
// `mass` [kg] at rest. `data` must be after UpdateDynamics.
double LoadOf(const RobotModel& model, const RobotData& data, const Jacobian& J, double mass) {
  double load = 0;
  for (int j = 0; j < model.dof(); ++j) {
    const double torque = data.gravity()[j] + mass * kStandardGravity * J(2, j);
    load = std::max(load, std::abs(torque) / model.effort_limit()[j]);
  }
  return load;
}

// Returns how well a posture suits carrying, or a negative number if it is unsuitable. Good
// postures have the end-effector in front of the base, pointing down, far from singular
// configurations. If `relaxed`, the end-effector may be anywhere above the base.
double Suitability(const Pose& X_WE, const Jacobian& J, bool relaxed) {
  const Vector3 tool = X_WE.q * Vector3::UnitZ();
  const Vector3& p = X_WE.p;
  const bool placed = p.x() > 0.25 && p.x() < 0.8 && std::abs(p.y()) < 0.2 && p.z() > 0.3 &&
                      p.z() < 0.9 && tool.z() < -0.9;
  if (!placed && !(relaxed && p.z() > 0.2)) return -1;
  return Eigen::JacobiSVD<Eigen::MatrixXd>(Eigen::MatrixXd(J)).singularValues().minCoeff();
}

// Returns the most suitable of many random postures, best first.
std::vector<Posture> Candidates(const RobotModel& model, const FrameId& tip, double mass,
                                bool relaxed) {
  std::mt19937 random(relaxed ? 2 : 1);
  std::uniform_real_distribution<double> share(-0.7, 0.7);  // in the middle of the joints' ranges
  RobotData data(model);
  const JointVector rest = JointVector::Zero(model.dof());
  Posture trial{0, rest, {}};
  Jacobian J(6, model.dof());
  std::vector<Posture> best;
  for (int k = 0; k < 20'000; ++k) {
    for (int j = 0; j < model.dof(); ++j) {
      const double low = std::max(model.position_lower()[j], -2.5);
      const double high = std::min(model.position_upper()[j], 2.5);
      trial.q[j] = 0.5 * (low + high) + 0.5 * (high - low) * share(random);
    }
    data.UpdateDynamics(model, trial.q, rest, kStandardGravity);
    data.FrameJacobian(model, tip, &J);
    if (LoadOf(model, data, J, mass) > kMaxLoad) continue;
    trial.X_WE = data.FramePose(model, tip);
    trial.suitability = Suitability(trial.X_WE, J, relaxed);
    if (trial.suitability <= 0) continue;
    best.insert(
        std::ranges::upper_bound(best, trial.suitability, std::greater(), &Posture::suitability),
        trial);
    if (best.size() > kMaxCandidates) best.pop_back();
  }
  return best;
}

// Keeps the postures in which the joints' limits let the object sag to its equilibrium. Keeps the
// first ones if no posture does.
void KeepThoseThatMaySag(const RobotModel& model, const FrameId& tip, double mass,
                         std::vector<Posture>* postures) {
  std::vector<Posture> able;
  for (const Posture& posture : *postures) {
    Pose lowered = posture.X_WE;
    lowered.p.z() -= mass * kStandardGravity / kInitStiffness;
    JointVector q = posture.q;
    if (able.size() < kMaxPostures && SolveInverseKinematics(model, tip, lowered, q, 0, &q))
      able.push_back(posture);
  }
  if (!able.empty()) *postures = std::move(able);
  if (postures->size() > kMaxPostures) postures->resize(kMaxPostures);
}

}  // namespace

InitCobot PandaCobot() {
  InitCobot cobot{kPandaUrdf, "panda_link8", {"panda_hand"}, 0, {0, -0.3, 0, -2.0, 0, 1.7, 0.785},
                  {}};
  const auto model = RobotModel::Load({cobot.model, ".", cobot.remove_links, {}});
  RobotData data(*model);
  const JointVector q = Eigen::Map<const Eigen::VectorXd>(cobot.posture.data(), model->dof());
  data.UpdateKinematics(*model, q, JointVector::Zero(model->dof()));
  cobot.X_WE = data.FramePose(*model, model->Frame(cobot.end_effector));
  return cobot;
}

std::vector<InitCobot> OwnCobots(const std::string& urdf, const std::string& end_effector,
                                 const fs::path& scenario, double mass) {
  const fs::path folder = fs::absolute(scenario).parent_path();
  std::string name = urdf;
  if (!urdf.starts_with("package://")) {
    if (!fs::exists(urdf)) throw InputError("--urdf", Quote(urdf) + " does not exist.");
    name = fs::proximate(fs::absolute(urdf), folder).string();
  }
  const ArmChain arm = FindArm(ReadUrdf(ResolveModelPath(name, folder), {}, folder), end_effector);
  const auto model = RobotModel::Load({name, folder, arm.remove_links, {}});
  const FrameId tip = model->Frame(arm.end_effector);
  std::vector<Posture> postures = Candidates(*model, tip, mass, false);
  if (postures.empty()) postures = Candidates(*model, tip, mass, true);
  KeepThoseThatMaySag(*model, tip, mass, &postures);
  std::vector<InitCobot> cobots;
  for (const Posture& p : postures)
    cobots.push_back({name,
                      arm.end_effector,
                      arm.remove_links,
                      arm.removed_mass,
                      {p.q.data(), p.q.data() + p.q.size()},
                      p.X_WE});
  return cobots;
}

}  // namespace predictor
