// link_poses SCENARIO cobot|left|right Q... prints the pose in W of each link of the robot at joint
// angles Q [rad], from the program's own kinematics. Each line has the link's name, p [m], and q
// (scalar first). The page's tests compare the drawn links with this output.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "core/error.h"
#include "models/robot.h"
#include "scenario/scenario_io.h"

namespace {

using namespace predictor;

std::shared_ptr<const RobotModel> Load(const Scenario& scenario, const std::string& robot) {
  if (robot == "cobot")
    return RobotModel::Load({scenario.cobot.model, scenario.folder(), scenario.cobot.remove_links,
                             scenario.cobot.base.ToPose()});
  if (robot != "left" && robot != "right")
    throw InputError("\"" + robot + "\" is not one of cobot, left, right.");
  const int hand = robot == "left" ? 0 : 1;
  const ArmSpec& arm = scenario.arm(hand);
  return RobotModel::Load({arm.model, scenario.folder(), arm.remove_links, scenario.X_WB(hand)});
}

int Print(int argc, char** argv) {
  if (argc < 3) throw InputError("Usage: link_poses SCENARIO cobot|left|right Q...");
  const auto model = Load(LoadScenario(argv[1]), argv[2]);
  if (argc - 3 != model->dof())
    throw InputError("The robot has " + std::to_string(model->dof()) + " joints.");
  JointVector q(model->dof());
  for (int j = 0; j < model->dof(); ++j) q[j] = std::strtod(argv[3 + j], nullptr);
  RobotData data(*model);
  data.UpdateKinematics(*model, q, JointVector::Zero(model->dof()));
  for (const std::string& link : model->link_names()) {
    const Pose X = data.FramePose(*model, model->Frame(link));
    std::printf("%s %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", link.c_str(), X.p.x(), X.p.y(), X.p.z(),
                X.q.w(), X.q.x(), X.q.y(), X.q.z());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Print(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
