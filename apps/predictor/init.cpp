// predictor init: writes a commented scenario that runs unchanged, for one or two arms, a given
// cobot and an object. Places the object and the arms at the cobot's end-effector.
#include <Eigen/SVD>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "core/types.h"
#include "models/robot.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPanda =
    "package://example-robot-data/robots/panda_description/urdf/panda.urdf";

// Mass of the object [kg]; a smaller mass leaves too little stability margin.
constexpr double kMass = 9;
constexpr double kMaxLoad = 0.6;  // maximum load of a cobot's joint at rest, relative to its limit

// A cobot as in the scenario, and the pose of its end-effector.
struct Cobot {
  std::string model, remove_links, end_effector;
  std::vector<double> posture;  // [rad] or [m]
  Pose X_WE;
};

struct Object {
  const char *name, *shape;
  double half_height;  // from its centre to the cobot above it [m]
  double handle_y;     // distance of the left and right handle from the centre [m]
  double handle_z;     // height of the handles above the centre [m]
};

const Object& ObjectNamed(const std::string& name) {
  static constexpr Object kObjects[] = {
      {"box", "shape: box, size: [0.3, 0.3, 0.2]", 0.1, 0.12, -0.1},
      {"bar", "shape: box, size: [0.2, 0.5, 0.1]", 0.05, 0.25, -0.05},
      {"ball", "shape: sphere, size: [0.15, 0, 0]", 0.15, 0.1, -0.1}};
  return *std::ranges::find_if(kObjects, [&](const Object& o) { return name == o.name; });
}

std::shared_ptr<const RobotModel> LoadCobot(const std::string& model,
                                            const std::vector<std::string>& remove,
                                            const fs::path& folder) {
  RobotSource source;
  source.model = model;
  source.folder = folder;
  source.remove_links = remove;
  return RobotModel::Load(source);
}

// The link that is carried by the most joints; the last one if there are several.
std::string LastLink(const RobotModel& model) {
  std::string last;
  int most = -1;
  for (const std::string& link : model.link_names())
    if (const int body = model.Frame(link).body; body >= most) {
      most = body;
      last = link;
    }
  return last;
}

// The largest joint torque that holds the robot and the object at rest, relative to its limit.
// `data` must be after UpdateDynamics.
double LoadOf(const RobotModel& model, const RobotData& data, const Jacobian& J) {
  double load = 0;
  for (int j = 0; j < model.dof(); ++j) {
    const double torque = data.gravity()[j] + kMass * kStandardGravity * J(2, j);
    load = std::max(load, std::abs(torque) / model.effort_limit()[j]);
  }
  return load;
}

// How well a posture suits carrying. Good postures have the end-effector in front of the base,
// pointing down, far from singular configurations. Negative if the posture is unsuitable.
// `relaxed`: the end-effector may be anywhere above the base.
double Suitability(const Pose& X_WE, const Jacobian& J, bool relaxed) {
  const Vector3 tool = X_WE.q * Vector3::UnitZ();
  const Vector3& p = X_WE.p;
  const bool placed = p.x() > 0.25 && p.x() < 0.8 && std::abs(p.y()) < 0.2 && p.z() > 0.3 &&
                      p.z() < 0.9 && tool.z() < -0.9;
  if (!placed && !(relaxed && p.z() > 0.2)) return -1;
  return Eigen::JacobiSVD<Eigen::MatrixXd>(Eigen::MatrixXd(J)).singularValues().minCoeff();
}

// Chooses the most suitable of many postures in the middle of the joints' ranges. The candidates
// are the same in each call.
void ChoosePosture(const RobotModel& model, Cobot* cobot) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-0.7, 0.7);
  RobotData data(model);
  const FrameId tip = model.Frame(cobot->end_effector);
  const JointVector rest = JointVector::Zero(model.dof());
  JointVector q = rest;
  Jacobian J(6, model.dof());
  for (const bool relaxed : {false, true}) {
    double best = 0;
    for (int trial = 0; trial < 20'000; ++trial) {
      for (int j = 0; j < model.dof(); ++j) {
        const double low = std::max(model.position_lower()[j], -2.5);
        const double high = std::min(model.position_upper()[j], 2.5);
        q[j] = 0.5 * (low + high) + 0.5 * (high - low) * share(random);
      }
      data.UpdateDynamics(model, q, rest, kStandardGravity);
      data.FrameJacobian(model, tip, &J);
      if (LoadOf(model, data, J) > kMaxLoad) continue;
      const double suits = Suitability(data.FramePose(model, tip), J, relaxed);
      if (suits <= best) continue;
      best = suits;
      cobot->posture.assign(q.data(), q.data() + q.size());
      cobot->X_WE = data.FramePose(model, tip);
    }
    if (best > 0) return;
  }
  throw InputError(cobot->model, "No posture was found in which this robot can carry 9 kg.");
}

Cobot Panda() {
  Cobot cobot{kPanda,
              "\n  remove_links: [panda_hand]",
              "panda_link8",
              {0, -0.3, 0, -2.0, 0, 1.7, 0.785},
              {}};
  const auto model = LoadCobot(kPanda, {"panda_hand"}, ".");
  RobotData data(*model);
  const JointVector q = Eigen::Map<const Eigen::VectorXd>(cobot.posture.data(), model->dof());
  data.UpdateKinematics(*model, q, JointVector::Zero(model->dof()));
  cobot.X_WE = data.FramePose(*model, model->Frame(cobot.end_effector));
  return cobot;
}

// `urdf`: a file, or package://...; it must be in a folder from which the scenario may read it.
Cobot OwnCobot(const std::string& urdf, const fs::path& scenario) {
  const fs::path folder = fs::absolute(scenario).parent_path();
  std::string name = urdf;
  if (!urdf.starts_with("package://")) {
    if (!fs::exists(urdf)) throw InputError("--urdf", Quote(urdf) + " does not exist.");
    name = fs::proximate(fs::absolute(urdf), folder).string();
  }
  const auto model = LoadCobot(name, {}, folder);
  Cobot cobot{name, "", LastLink(*model), {}, {}};
  ChoosePosture(*model, &cobot);
  return cobot;
}

std::string List(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double value : values) words.push_back(Formatted("%.4g", value));
  return "[" + Join(words) + "]";
}
std::string List(const Vector3& p) { return List(std::vector<double>{p.x(), p.y(), p.z()}); }

// Rotations about the fixed axes x, y, z [rad], as in URDF.
Vector3 RollPitchYaw(const Quaternion& q) {
  const Eigen::Vector3d zyx = q.toRotationMatrix().eulerAngles(2, 1, 0);
  return {zyx[2], zyx[1], zyx[0]};
}

// The text of one arm with its base at `base` in the world [m].
std::string ArmText(const char* side, const Vector3& base) {
  return Formatted(
      "    %s:\n"
      "      model: %s\n"
      "      remove_links: [panda_hand]\n"
      "      base: {xyz: %s}  # in the world [m]\n"
      "      end_effector: panda_link8\n"
      "      handle: {xyz: [0, 0, 0.1], rpy: [3.14159265, 0, -0.78539816]}  # on the end-effector\n"
      "      posture: [0, -0.5, 0, -2.3, 0, 1.8, 0.785]  # at the start [rad]\n"
      "      elbow: panda_link4\n",
      side, kPanda, List(base).c_str());
}

std::string CobotText(const InitOptions& o, const Cobot& cobot) {
  return Formatted(
      "# %s: a scenario to start from. Check it with `predictor check %s.yaml`, run it with\n"
      "# `predictor run %s.yaml`. `predictor schema scenario` lists all keys.\n"
      "predictor: 1\n"
      "name: %s\n"
      "mode: emulate\n"
      "duration: 16  # [s]\n"
      "seed: 1\n"
      "\n"
      "# The simulated cobot.\n"
      "cobot:\n"
      "  model: %s%s\n"
      "  end_effector: %s  # link that holds the object\n"
      "  posture: %s  # at the start [rad]\n"
      "  joint_friction: {viscous: 1.0}\n"
      "  controller:  # compliant sideways, stiff vertically, so that people can guide the object\n"
      "    type: cartesian_impedance\n"
      "    stiffness: {translation: [5, 5, 500], rotation: [100, 100, 100]}  # [N/m], [N·m/rad]\n"
      "    damping_ratio: 1\n"
      "\n",
      o.name.c_str(), o.name.c_str(), o.name.c_str(), fs::path(o.name).filename().c_str(),
      cobot.model.c_str(), cobot.remove_links.c_str(), cobot.end_effector.c_str(),
      List(cobot.posture).c_str());
}

std::string ObjectText(const InitOptions& o, const Cobot& cobot) {
  const Object& object = ObjectNamed(o.object);
  std::string text = Formatted(
      "# The object that the cobot holds from above, and the handles that people hold.\n"
      "object:\n"
      "  primitive: {%s, mass: %g}  # [m], [kg]\n"
      "  attachment:\n"
      "    joint: spherical\n"
      "    damping: 0.1  # of the ball joint [N·m·s/rad]\n"
      "    on_end_effector: {xyz: %s, rpy: %s}\n"
      "    on_object: {xyz: [0, 0, %.4g]}\n\n"
      "handles:  # on the object [m]\n",
      object.shape, kMass, List(cobot.X_WE.q.conjugate() * Vector3(0, 0, -0.05)).c_str(),
      List(RollPitchYaw(cobot.X_WE.q.conjugate())).c_str(), object.half_height);
  if (o.arms == 1) return text + Formatted("  left: {xyz: [0, 0, %.4g]}\n\n", object.handle_z);
  Append(&text, "  left: {xyz: [0, -%.4g, %.4g]}\n  right: {xyz: [0, %.4g, %.4g]}\n\n",
         object.handle_y, object.handle_z, object.handle_y, object.handle_z);
  return text;
}

std::string DeviceText(const InitOptions& o, const Cobot& cobot) {
  const Vector3 shift = cobot.X_WE.p - Panda().X_WE.p;
  std::string text =
      "# The haptic arms; here they are simulated. Real ones: predictor run SCENARIO --machine "
      "FILE\n"
      "device:\n"
      "  type: simulated\n"
      "  arms:\n";
  if (o.arms == 1) return text + ArmText("left", shift + Vector3(0.15, 0, -0.15)) + "\n";
  const double y = 0.13 + ObjectNamed(o.object).handle_y;
  return text + ArmText("left", shift + Vector3(0.1, -y, -0.25)) +
         ArmText("right", shift + Vector3(0.1, y, -0.25)) + "\n";
}

constexpr const char* kOperatorText =
    "# A simulated operator. To guide the object yourself, replace this section by `type: "
    "browser`\n"
    "# and take the operator's hands in the viewer.\n"
    "operator:\n"
    "  type: virtual\n"
    "  script:\n"
    "    - {action: grip, start: 0, duration: 0.5}\n"
    "    - {action: move, start: 1, duration: 3, by: [0, 0, 0.05]}\n"
    "    - {action: move, start: 4, duration: 4, by: [0, 0.08, 0]}\n"
    "    - {action: move, start: 8, duration: 4, by: [0, -0.08, 0]}\n"
    "    - {action: put_down, start: 12, duration: 3, by: [0, 0, -0.05]}\n";

}  // namespace

int InitCommand(const InitOptions& options) {
  const std::string file = options.name + ".yaml";
  options.RefuseToReplace(file);
  const Cobot cobot = options.urdf.empty() ? Panda() : OwnCobot(options.urdf, file);
  std::ofstream out(file);
  out << CobotText(options, cobot) << ObjectText(options, cobot) << DeviceText(options, cobot)
      << kOperatorText;
  if (!out.flush()) throw InputError(file, "The file could not be written.");
  if (!options.quiet)
    WriteOut("Wrote " + file + ". Next: predictor check " + file + "; predictor run " + file +
             "\n");
  return kFinished;
}

}  // namespace predictor
