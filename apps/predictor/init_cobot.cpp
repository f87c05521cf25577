#include "init_cobot.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "init_posture.h"
#include "models/arm_chain.h"
#include "models/last_link.h"
#include "models/robot.h"
#include "scenario/paths.h"
#include "simulation/link_gaps.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxCobots = 5;
constexpr double kBaseHeights[] = {0, 0.3, 0.6, 0.9};      // to try [m]
constexpr double kAttachments[] = {0.05, 0.1, 0.15, 0.2};  // distances from E to try [m]
constexpr double kClearance = 0.02;                        // of the object from all links [m]
constexpr double kFloorClearance = 0.1;                    // of the object [m]

// Attaches the object as close to the end-effector as the links permit. Returns whether the
// attached object is clear of the links and of the floor.
bool Attach(const LinkGaps& gaps, const InitPosture& posture, const Vector3& outward,
            const InitObject& object, InitCobot* cobot) {
  return std::ranges::any_of(kAttachments, [&](double distance) {
    cobot->attachment = distance * outward;
    const Vector3 p_WO = cobot->ObjectAt(object);
    if (p_WO.z() - object.half_height < kFloorClearance / 2) return false;
    const ObjectGaps gap = gaps.At(posture.q, {p_WO, Quaternion::Identity()});
    return std::min(gap.links.distance, gap.hand.distance) > kClearance;
  });
}

// Returns the robot of `base` in suitable postures, with its base at the same height as in `base`.
std::vector<InitCobot> InPostures(const InitCobot& base, const fs::path& folder,
                                  const InitObject& object, double tilt) {
  Scenario scenario;  // of which only cobot and object matter
  scenario.file = folder / "init.yaml";
  scenario.cobot.model = base.model;
  scenario.cobot.remove_links = base.remove_links;
  scenario.cobot.end_effector = base.end_effector;
  scenario.cobot.base.xyz.z() = base.base_height;
  scenario.object.primitive = object.primitive;
  const auto model =
      RobotModel::Load({base.model, folder, base.remove_links, scenario.cobot.base.ToPose()});
  const FrameId tip = model->Frame(base.end_effector);
  const Vector3 outward = LastLinkDirection(*model, tip);
  const double lowest = kFloorClearance + 2 * object.half_height + kAttachments[0];
  const std::vector<InitPosture> postures =
      FindPostures(*model, tip, {object.primitive.mass, outward, tilt, lowest});
  if (postures.empty()) return {};
  const LinkGaps gaps(scenario);
  std::vector<InitCobot> cobots;
  for (const InitPosture& p : postures) {
    InitCobot cobot = base;
    cobot.posture = {p.q.data(), p.q.data() + p.q.size()};
    cobot.X_WE = p.X_WE;
    cobot.tilt = tilt;
    if (Attach(gaps, p, outward, object, &cobot)) cobots.push_back(cobot);
    if (cobots.size() == kMaxCobots) break;
  }
  return cobots;
}

}  // namespace

Vector3 InitCobot::ObjectAt(const InitObject& object) const {
  return X_WE * attachment - Vector3(0, 0, object.half_height);
}

InitCobot PandaCobot() {
  InitCobot cobot{kPandaUrdf, "panda_link8", {"panda_hand"}, 0, {0, -0.3, 0, -2.0, 0, 1.7, 0.785}};
  const auto model = RobotModel::Load({cobot.model, ".", cobot.remove_links, {}});
  RobotData data(*model);
  const JointVector q = Eigen::Map<const Eigen::VectorXd>(cobot.posture.data(), model->dof());
  data.UpdateKinematics(*model, q, JointVector::Zero(model->dof()));
  cobot.X_WE = data.FramePose(*model, model->Frame(cobot.end_effector));
  cobot.attachment = cobot.X_WE.q.conjugate() * Vector3(0, 0, -kAttachments[0]);
  return cobot;
}

std::vector<InitCobot> OwnCobots(const std::string& urdf, const std::string& end_effector,
                                 const fs::path& scenario, const InitObject& object, double tilt) {
  const fs::path folder = fs::absolute(scenario).parent_path();
  std::string name = urdf;
  if (!urdf.starts_with("package://")) {
    if (!fs::exists(urdf)) throw InputError("--urdf", Quote(urdf) + " does not exist.");
    name = fs::proximate(fs::absolute(urdf), folder).string();
  }
  const ArmChain arm = FindArm(ReadUrdf(ResolveModelPath(name, folder), {}, folder), end_effector);
  InitCobot cobot{name, arm.end_effector, arm.remove_links, arm.removed_mass, {}};
  for (const double height : kBaseHeights) {
    cobot.base_height = height;
    std::vector<InitCobot> cobots = InPostures(cobot, folder, object, tilt);
    if (!cobots.empty()) return cobots;
  }
  return {};
}

}  // namespace predictor
