// predictor-ign-mover FILE.sdf PLUGIN Q...: moves an exported scene in ign-physics for 5 s by the
// control law below, and prints the object's position after each step. Q... are the start positions
// of the cobot's joints. gazebo_test.cpp compares this program's output with the motion in our DART
// world.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FrameSemantics.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/Joint.hh>
#include <ignition/physics/Link.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
#include <sdf/Root.hh>
#include <sdf/World.hh>
#include <string>
#include <vector>

namespace physics = ignition::physics;

using Features =
    physics::FeatureList<physics::ForwardStep, physics::sdf::ConstructSdfWorld,
                         physics::GetModelFromWorld, physics::GetLinkFromModel,
                         physics::GetJointFromModel, physics::GetBasicJointState,
                         physics::GetBasicJointProperties, physics::SetBasicJointState,
                         physics::LinkFrameSemantics, physics::AddLinkExternalForceTorque>;

int main(int count, char** arguments) {
  if (count < 4) return 2;
  sdf::Root root;
  if (const sdf::Errors errors = root.Load(arguments[1]); !errors.empty()) {
    std::fprintf(stderr, "%s\n", errors.front().Message().c_str());
    return 1;
  }
  ignition::plugin::Loader loader;
  loader.LoadLib(arguments[2]);
  const auto engine = physics::RequestEngine3d<Features>::From(
      loader.Instantiate("ignition::physics::dartsim::Plugin"));
  if (engine == nullptr) return 3;
  const auto world = engine->ConstructWorld(*root.WorldByIndex(0));
  const auto model = world->GetModel("predictor_scene");
  const auto object = model->GetLink("object");
  std::vector<double> start;
  std::vector<decltype(model->GetJoint(0))> joints;
  for (std::size_t i = 0; i < model->GetJointCount(); ++i) {
    const auto joint = model->GetJoint(i);
    if (joint->GetDegreesOfFreedom() != 1) continue;
    if (joints.size() + 3 >= static_cast<std::size_t>(count)) return 4;
    start.push_back(std::atof(arguments[3 + joints.size()]));
    joint->SetPosition(0, start.back());
    joints.push_back(joint);
  }
  physics::ForwardStep::Output output;
  physics::ForwardStep::State state;
  physics::ForwardStep::Input input;
  const double stiffness[] = {600, 600, 600, 600, 100, 100, 20};
  const double damping[] = {30, 30, 30, 30, 3, 3, 0.5};
  for (int step = 0; step < 5000; ++step) {
    const double t = 0.001 * step;
    for (std::size_t j = 0; j < joints.size(); ++j)
      joints[j]->SetForce(0, -stiffness[j] * (joints[j]->GetPosition(0) - start[j]) -
                                 damping[j] * joints[j]->GetVelocity(0));
    const Eigen::Vector3d force(10 * std::sin(t), 5 * std::sin(2 * t), 0);
    object->AddExternalForce(physics::RelativeForce3d(physics::FrameID::World(), force),
                             physics::RelativePosition3d(*object, Eigen::Vector3d::Zero()));
    world->Step(output, state, input);
    const Eigen::Vector3d p = object->FrameDataRelativeToWorld().pose.translation();
    std::printf("%.17g %.17g %.17g\n", p.x(), p.y(), p.z());
  }
  return 0;
}
