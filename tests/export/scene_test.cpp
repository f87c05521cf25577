// Compares the exported URDF with the simulation's own scene. MuJoCo and RobotModel load the URDF.
#include "simulation/mujoco/scene.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/random.h"
#include "export/files.h"
#include "export/scene_package.h"
#include "export/scenes.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"
#include "simulation/world.h"

namespace predictor::scene_export {
namespace {

namespace fs = std::filesystem;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kExact = 1e-9;
constexpr int kStates = 50;

std::vector<std::string> Shipped() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(PREDICTOR_SOURCE_DIR) / "scenarios")) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

const std::vector<std::string> kOdd = {"odd_spherical", "odd_fixed",
                                       "odd_revolute",  "odd_revolute_ranged",
                                       "odd_prismatic", "odd_prismatic_ranged"};

Scenario ScenarioOf(const std::string& name, const fs::path& folder) {
  if (name.rfind("odd_", 0) != 0)
    return LoadScenario(fs::path(PREDICTOR_SOURCE_DIR) / "scenarios" / (name + ".yaml"));
  const JointType joint = name == "odd_spherical"               ? JointType::kSpherical
                          : name == "odd_fixed"                 ? JointType::kFixed
                          : name.find("prismatic") != name.npos ? JointType::kPrismatic
                                                                : JointType::kRevolute;
  Scenario s = OddScene(folder, joint);
  if (name.find("ranged") != name.npos) s.object.attachment.range = {{-0.1, 0.4}};
  return s;
}

// Returns the angles a, b and c with R = Rx(a) Ry(b) Rz(c).
Vector3 TurnsAboutXyz(const Matrix3& R) {
  return {std::atan2(-R(1, 2), R(2, 2)), std::atan2(R(0, 2), std::hypot(R(1, 2), R(2, 2))),
          std::atan2(-R(0, 1), R(0, 0))};
}

Quaternion Turn(const Vector3& turns) {
  return Quaternion(Eigen::AngleAxisd(turns.x(), Vector3::UnitX()) *
                    Eigen::AngleAxisd(turns.y(), Vector3::UnitY()) *
                    Eigen::AngleAxisd(turns.z(), Vector3::UnitZ()));
}

// The exported scene is a single tree, which does not contain the movable objects.
Scenario Exported(Scenario scenario) {
  scenario.environment.objects.clear();
  return scenario;
}

struct Poses {
  Pose end_effector, object;
  std::array<Pose, kHands> handle;
};

class ExportedScene : public testing::TestWithParam<std::string> {
 protected:
  ExportedScene()
      : scenario(ScenarioOf(GetParam(), folder.path() / "source")),
        to(folder.path() / "package"),
        cobot(RobotModel::Load({scenario.cobot.model, scenario.folder(),
                                scenario.cobot.remove_links, scenario.cobot.base.ToPose()})),
        reference(ComposeScene(Exported(scenario), *cobot)),
        truth(mj_makeData(reference.model.get())) {
    WriteScenePackage(MakeScenePackage(scenario), to, false);
    char error[1000] = "";
    mujoco.reset(mj_loadXML((to / kSceneUrdf).c_str(), nullptr, error, sizeof(error)));
    if (mujoco == nullptr) throw std::runtime_error(error);
    data.reset(mj_makeData(mujoco.get()));
    urdf = ReadUrdf(to / kSceneUrdf, {}, to);
    robot = RobotModel::Build(urdf, Pose::Identity());
    workspace = std::make_unique<RobotData>(*robot);
    q = JointVector::Zero(cobot->dof());
  }

  int Joint(const std::string& name) const {
    const int id = mj_name2id(mujoco.get(), mjOBJ_JOINT, name.c_str());
    EXPECT_GE(id, 0) << name;
    return id;
  }
  int Body(const std::string& name) const {
    const int id = mj_name2id(mujoco.get(), mjOBJ_BODY, name.c_str());
    EXPECT_GE(id, 0) << name;
    return id;
  }
  JointType attachment() const { return scenario.object.attachment.joint; }
  std::vector<std::string> AttachmentJoints() const {
    if (attachment() == JointType::kFixed) return {};
    if (attachment() == JointType::kSpherical) {
      // In the odd scenes, a joint of the cobot already has this name.
      const std::string x = GetParam() == "odd_spherical" ? "attachment_x_" : "attachment_x";
      return {x, "attachment_y", "attachment_z"};
    }
    return {GetParam().rfind("odd_", 0) == 0 ? "attachment_" : "attachment"};
  }

  // Moves the cobot to q and the attachment to `turns` in all three models. If the attachment has
  // one axis, only the first entry is used.
  void MoveTo(const Vector3& turns) {
    for (int j = 0; j < cobot->dof(); ++j) {
      truth->qpos[reference.qpos[static_cast<std::size_t>(j)]] = q[j];
      data->qpos[mujoco->jnt_qposadr[Joint(cobot->joint_name(j))]] = q[j];
    }
    const int joint = mj_name2id(reference.model.get(), mjOBJ_JOINT, "attachment");
    if (joint >= 0) {
      double* at = truth->qpos + reference.model->jnt_qposadr[joint];
      const Quaternion q_OA = scenario.object.attachment.on_object.ToPose().q;
      const Quaternion turn = q_OA * Turn(turns) * q_OA.inverse();  // in O for MuJoCo, not in A
      if (attachment() == JointType::kSpherical) {
        const double quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
        std::copy_n(quaternion, 4, at);
      } else {
        *at = turns[0];
      }
    }
    const std::vector<std::string> names = AttachmentJoints();
    for (std::size_t i = 0; i < names.size(); ++i) {
      data->qpos[mujoco->jnt_qposadr[Joint(names[i])]] = turns[static_cast<int>(i)];
    }
    JointVector all(robot->dof());
    for (int j = 0; j < robot->dof(); ++j) {
      all[j] = data->qpos[mujoco->jnt_qposadr[Joint(robot->joint_name(j))]];
    }
    mj_forward(reference.model.get(), truth.get());
    mj_forward(mujoco.get(), data.get());
    workspace->UpdateDynamics(*robot, all, JointVector::Zero(robot->dof()),
                              scenario.environment.gravity);
  }

  void MoveAnywhere() {
    Vector3 turns;
    for (int i = 0; i < 3; ++i) turns[i] = 3 * random.Uniform() - 1.5;
    for (int j = 0; j < cobot->dof(); ++j) {
      const double lower = std::max(cobot->position_lower()[j], -3.0);
      const double upper = std::min(cobot->position_upper()[j], 3.0);
      q[j] = lower + (upper - lower) * random.Uniform();
    }
    MoveTo(turns);
  }

  static Pose At(const double* p, const double* quat) {
    return {Vector3(p[0], p[1], p[2]), Quaternion(quat[0], quat[1], quat[2], quat[3])};
  }
  Poses Truth() const {
    const auto body = [&](int id) { return At(truth->xpos + 3 * id, truth->xquat + 4 * id); };
    Poses poses{body(reference.end_effector), body(reference.object), {}};
    for (int hand = 0; hand < kHands; ++hand) {
      if (scenario.Has(hand))
        poses.handle[static_cast<std::size_t>(hand)] =
            poses.object * scenario.handle(hand).pose.ToPose();
    }
    return poses;
  }
  void ExpectPose(const std::string& link, const Pose& expected) const {
    const int id = Body(link);
    const Pose in_mujoco = At(data->xpos + 3 * id, data->xquat + 4 * id);
    EXPECT_LT(PoseError(expected, in_mujoco).norm(), kExact) << link;
    const Pose computed = workspace->FramePose(*robot, robot->Frame(link));
    EXPECT_LT(PoseError(expected, computed).norm(), kExact) << link;
  }
  void ExpectPoses(const Poses& expected) const {
    ExpectPose(scenario.cobot.end_effector, expected.end_effector);
    ExpectPose("object", expected.object);
    for (int hand = 0; hand < kHands; ++hand) {
      const auto h = static_cast<std::size_t>(hand);
      const std::string link = std::string(kHandNames[h]) + "_handle";
      if (scenario.Has(hand))
        ExpectPose(link, expected.handle[h]);
      else
        EXPECT_LT(mj_name2id(mujoco.get(), mjOBJ_BODY, link.c_str()), 0);
    }
  }

  // Returns the mass matrix of a MuJoCo model, restricted to the cobot's joints.
  static RowMatrix CobotBlock(const mjModel* model, mjData* state, const std::vector<int>& dof) {
    RowMatrix all(model->nv, model->nv);
    mj_fullM(model, state, all.data());
    return all(dof, dof);
  }

  test::TemporaryFolder folder;
  Scenario scenario;
  fs::path to;
  std::shared_ptr<const RobotModel> cobot;
  Scene reference;
  DataPtr truth;
  ModelPtr mujoco;
  DataPtr data;
  UrdfModel urdf;
  std::shared_ptr<const RobotModel> robot;
  std::unique_ptr<RobotData> workspace;
  JointVector q;
  RandomStream random{1, "export"};
};

std::string NameOf(const testing::TestParamInfo<std::string>& name) { return name.param; }

INSTANTIATE_TEST_SUITE_P(Shipped, ExportedScene, testing::ValuesIn(Shipped()), NameOf);
INSTANTIATE_TEST_SUITE_P(Odd, ExportedScene, testing::ValuesIn(kOdd), NameOf);

// The odd cobots cannot run, because they have no controller that holds them.
class ExportedRun : public ExportedScene {};
INSTANTIATE_TEST_SUITE_P(Shipped, ExportedRun, testing::ValuesIn(Shipped()), NameOf);

TEST_P(ExportedScene, IsOneTreeWithTheSameJoints) {
  EXPECT_EQ(urdf.links[static_cast<std::size_t>(urdf.root)].name, "world");
  EXPECT_EQ(Files(to).count("package.xml"), 1u);
  const std::size_t turns = AttachmentJoints().size();
  EXPECT_EQ(mujoco->nv, cobot->dof() + static_cast<int>(turns));
  EXPECT_EQ(robot->dof(), mujoco->nv);
  const mjModel& sim = *reference.model;
  for (int j = 0; j < cobot->dof(); ++j) {
    const int id = Joint(cobot->joint_name(j));
    const int dof = mujoco->jnt_dofadr[id];
    const int sim_dof = reference.dof[static_cast<std::size_t>(j)];
    const int sim_id = sim.dof_jntid[sim_dof];
    EXPECT_EQ(mujoco->jnt_type[id], sim.jnt_type[sim_id]);
    EXPECT_EQ(mujoco->jnt_limited[id], sim.jnt_limited[sim_id]);
    EXPECT_EQ(mujoco->jnt_range[2 * id], sim.jnt_range[2 * sim_id]);
    EXPECT_EQ(mujoco->jnt_range[2 * id + 1], sim.jnt_range[2 * sim_id + 1]);
    EXPECT_EQ(mujoco->dof_damping[dof], sim.dof_damping[sim_dof]);
    EXPECT_EQ(mujoco->dof_frictionloss[dof], sim.dof_frictionloss[sim_dof]);
  }
  const std::string readme = Read(to / "README.txt");
  std::size_t at = 0;
  for (int j = 0; j < cobot->dof(); ++j) {  // in the order of the topic
    at = readme.find("  " + std::to_string(j) + "  " + cobot->joint_name(j) + "\n", at);
    ASSERT_NE(at, std::string::npos) << readme;
  }
}

TEST_P(ExportedScene, HasTheAttachmentsAxes) {
  const auto& range = scenario.object.attachment.range;
  for (const std::string& name : AttachmentJoints()) {
    const int id = Joint(name);
    const bool slides = attachment() == JointType::kPrismatic;
    EXPECT_EQ(mujoco->jnt_type[id], slides ? mjJNT_SLIDE : mjJNT_HINGE);
    EXPECT_EQ(mujoco->jnt_limited[id], slides || range);
    EXPECT_EQ(mujoco->dof_damping[mujoco->jnt_dofadr[id]], scenario.object.attachment.damping);
    if (range) {
      EXPECT_EQ(mujoco->jnt_range[2 * id], (*range)[0]);
      EXPECT_EQ(mujoco->jnt_range[2 * id + 1], (*range)[1]);
    }
  }
}

TEST_P(ExportedScene, HasTheEffortLimitsThatAreUsed) {
  const std::vector<double>& limits = scenario.cobot.effort_limit;
  for (int j = 0; j < cobot->dof(); ++j) {
    const double expected = limits.empty() ? cobot->effort_limit()[j] : OneOrEach(limits, j);
    const int id = Joint(cobot->joint_name(j));
    EXPECT_EQ(mujoco->jnt_actfrclimited[id] != 0, std::isfinite(expected));
    if (std::isfinite(expected)) {
      EXPECT_EQ(mujoco->jnt_actfrcrange[2 * id + 1], expected);
    }
  }
}

TEST_P(ExportedScene, WeighsTheSame) {
  EXPECT_NEAR(mujoco->body_subtreemass[0], reference.model->body_subtreemass[0], kExact);
  EXPECT_NEAR(robot->mass(), reference.model->body_subtreemass[0], kExact);
  const ObjectModel object = LoadObject(scenario.object, scenario.folder());
  const int id = Body("object");
  EXPECT_EQ(mujoco->body_mass[id], object.mass);
  EXPECT_LT((Eigen::Map<Vector3>(mujoco->body_ipos + 3 * id) - object.com).norm(), kExact);
  const double* r = mujoco->body_iquat + 4 * id;
  const Matrix3 R = Quaternion(r[0], r[1], r[2], r[3]).toRotationMatrix();
  const Eigen::Map<Vector3> moments(mujoco->body_inertia + 3 * id);
  EXPECT_LT((R * moments.asDiagonal() * R.transpose() - object.inertia).norm(), kExact);
  const auto link = std::find_if(urdf.links.begin(), urdf.links.end(),
                                 [](const UrdfLink& l) { return l.name == "object"; });
  EXPECT_LT((link->inertia - object.inertia).norm(), kExact);
  EXPECT_LT((link->com - object.com).norm(), kExact);
}

TEST_P(ExportedScene, StandsWhereTheSimulationDoesAnywhere) {
  for (int i = 0; i < kStates; ++i) {
    MoveAnywhere();
    ExpectPoses(Truth());
  }
}

TEST_P(ExportedRun, StandsWhereTheRunStarts) {
  const World world(scenario);
  const WorldState& start = world.state();
  const AttachmentSpec& spec = scenario.object.attachment;
  const Pose X_EA = start.end_effector.X_W.Inverse() * start.object.X_W * spec.on_object.ToPose();
  q = start.q;
  MoveTo(TurnsAboutXyz((spec.on_end_effector.ToPose().Inverse() * X_EA).R()));
  Poses expected{start.end_effector.X_W, start.object.X_W, {}};
  for (std::size_t h = 0; h < kHands; ++h) expected.handle[h] = start.handle[h].X_W;
  ExpectPoses(expected);
}

// Compares the inertia and the weight in the cobot's joint coordinates.
TEST_P(ExportedScene, MovesAsHeavily) {
  std::vector<int> sim_dof, mujoco_dof, robot_dof;
  for (int j = 0; j < cobot->dof(); ++j) {
    sim_dof.push_back(reference.dof[static_cast<std::size_t>(j)]);
    mujoco_dof.push_back(mujoco->jnt_dofadr[Joint(cobot->joint_name(j))]);
    for (int k = 0; k < robot->dof(); ++k)
      if (robot->joint_name(k) == cobot->joint_name(j)) robot_dof.push_back(k);
  }
  for (int i = 0; i < kStates; ++i) {
    MoveAnywhere();
    const RowMatrix M = CobotBlock(reference.model.get(), truth.get(), sim_dof);
    EXPECT_LT((CobotBlock(mujoco.get(), data.get(), mujoco_dof) - M).norm(), kExact * M.norm());
    EXPECT_LT((Eigen::MatrixXd(workspace->M())(robot_dof, robot_dof) - M).norm(),
              kExact * M.norm());
    for (std::size_t j = 0; j < sim_dof.size(); ++j) {
      const double weight = truth->qfrc_bias[sim_dof[j]];
      EXPECT_NEAR(data->qfrc_bias[mujoco_dof[j]], weight, 1e-7);
      EXPECT_NEAR(workspace->bias()[robot_dof[j]], weight, 1e-7);
    }
  }
}

TEST_P(ExportedScene, HasFloorAndTableWhereTheyAre) {
  const auto geom_on = [&](const std::string& body) {
    const int id = mj_name2id(mujoco.get(), mjOBJ_BODY, body.c_str());
    return id < 0 ? -1 : mujoco->body_geomadr[id];
  };
  mj_forward(mujoco.get(), data.get());
  const auto top_of = [&](int geom) {
    return data->geom_xpos[3 * geom + 2] + mujoco->geom_size[3 * geom + 2];
  };
  ASSERT_EQ(geom_on("floor") >= 0, scenario.environment.floor);
  if (scenario.environment.floor) {
    EXPECT_NEAR(top_of(geom_on("floor")), 0, kExact);
  }
  const auto& table = scenario.environment.table;
  ASSERT_EQ(geom_on("table") >= 0, table.has_value());
  if (!table) return;
  const int geom = geom_on("table");
  EXPECT_NEAR(top_of(geom), table->top.z(), kExact);
  EXPECT_LT((2 * Eigen::Map<Vector3>(mujoco->geom_size + 3 * geom) - table->size).norm(), kExact);
  EXPECT_NEAR(data->geom_xpos[3 * geom], table->top.x(), kExact);
}

// Along a fixture's own axes, its bounding box must be the bounding box of its shape.
TEST_P(ExportedScene, HasTheFixturesWhereTheyAre) {
  mj_forward(mujoco.get(), data.get());
  for (std::size_t i = 0; i < scenario.environment.fixtures.size(); ++i) {
    const FixtureSpec& fixture = scenario.environment.fixtures[i];
    const int body = mj_name2id(mujoco.get(), mjOBJ_BODY, ("fixture_" + std::to_string(i)).c_str());
    ASSERT_GE(body, 0);
    Vector3 low = Vector3::Constant(1e9), high = -low;
    for (int k = 0; k < mujoco->body_geomnum[body]; ++k) {
      const int geom = mujoco->body_geomadr[body] + k;
      const Vector3 middle =
          fixture.X_WG().Inverse() * Vector3(Eigen::Map<Vector3>(data->geom_xpos + 3 * geom));
      const Vector3 half = Eigen::Map<Vector3>(mujoco->geom_aabb + 6 * geom + 3);
      low = low.cwiseMin(middle - half);
      high = high.cwiseMax(middle + half);
    }
    const double a = fixture.size.x(), b = fixture.size.y();
    const bool caps = fixture.shape == FixtureShape::kCapsule;
    Vector3 extent = fixture.size;  // of a box
    if (caps || fixture.shape == FixtureShape::kCylinder)
      extent = {2 * a, 2 * a, caps ? b + 2 * a : b};
    if (fixture.shape == FixtureShape::kSphere) extent.setConstant(2 * a);
    if (fixture.shape == FixtureShape::kPlane) {
      EXPECT_NEAR(high.z(), 0, kExact);
      extent = {a, b, -low.z()};
    }
    EXPECT_LT((high - low - extent).norm(), kExact) << NameOf(fixture.shape);
    const bool centred = fixture.shape != FixtureShape::kPlane;
    EXPECT_TRUE(!centred || (high + low).norm() < kExact) << NameOf(fixture.shape);
  }
}

// Collects all elements with this name, at any depth.
void Collect(const tinyxml2::XMLElement* from, const std::string& name,
             std::vector<const tinyxml2::XMLElement*>* found) {
  for (auto* e = from->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    if (e->Name() == name) found->push_back(e);
    Collect(e, name, found);
  }
}

TEST_P(ExportedScene, NamesFilesOfThePackageOnlyAndAllOfThem) {
  tinyxml2::XMLDocument doc;
  ASSERT_EQ(doc.LoadFile((to / kSceneUrdf).c_str()), tinyxml2::XML_SUCCESS);
  std::vector<const tinyxml2::XMLElement*> naming;
  for (const char* element : {"mesh", "texture"}) Collect(doc.RootElement(), element, &naming);
  std::set<std::string> named, stems;
  for (const auto* element : naming) {
    const std::string file = element->Attribute("filename");
    EXPECT_EQ(file.rfind("meshes/", 0), 0u) << file;
    EXPECT_EQ(file.find(".."), std::string::npos) << file;
    EXPECT_TRUE(fs::is_regular_file(to / file)) << file;
    if (named.insert(file).second) {
      EXPECT_TRUE(stems.insert(fs::path(file).stem()).second) << file;
    }
  }
  std::set<std::string> there;
  for (const auto& [path, text] : Files(to)) {
    if (path.rfind("meshes/", 0) == 0) there.insert(path);
    if (path.rfind("meshes/", 0) == 0) continue;
    EXPECT_EQ(text.find(PREDICTOR_SOURCE_DIR), std::string::npos) << path;
    EXPECT_EQ(text.find(folder.path().string()), std::string::npos) << path;
    EXPECT_EQ(text.find("package://e"), std::string::npos) << path;
  }
  EXPECT_EQ(there, named);  // the shipped models have no textures
}

// The format permits these omissions, but URDF-Importer cannot load a file that has them.
TEST_P(ExportedScene, HasWhatUrdfImporterNeeds) {
  tinyxml2::XMLDocument doc;
  ASSERT_EQ(doc.LoadFile((to / kSceneUrdf).c_str()), tinyxml2::XML_SUCCESS);
  const tinyxml2::XMLElement* scene = doc.RootElement();
  ASSERT_NE(scene->Attribute("name"), nullptr);
  for (auto* joint = scene->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    if (joint->Attribute("type", "fixed") == nullptr) {
      ASSERT_NE(joint->FirstChildElement("axis"), nullptr) << joint->Attribute("name");
    }
    if (const auto* limit = joint->FirstChildElement("limit")) {
      EXPECT_NE(limit->Attribute("effort"), nullptr);
      EXPECT_NE(limit->Attribute("velocity"), nullptr);
    }
  }
  const std::set<std::string> still = {"world", "floor", "table"};
  // URDF-Importer gives a mass of 1 kg to a link that has no inertial element.
  for (auto* link = scene->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    EXPECT_EQ(link->FirstChildElement("inertial") == nullptr,
              still.count(link->Attribute("name")) > 0 ||
                  std::string(link->Attribute("name")).starts_with("fixture_"))
        << link->Attribute("name");
  }
  std::vector<const tinyxml2::XMLElement*> materials;
  Collect(scene, "material", &materials);
  std::map<std::string, std::string> colors;
  for (const auto* material : materials) {
    ASSERT_NE(material->Attribute("name"), nullptr);
    ASSERT_NE(material->FirstChildElement("color"), nullptr);
    const std::string rgba = material->FirstChildElement("color")->Attribute("rgba");
    EXPECT_EQ(colors.emplace(material->Attribute("name"), rgba).first->second, rgba);
  }
}

TEST_P(ExportedScene, IsTheSameEachTime) {
  const fs::path again = folder.path() / "again";
  WriteScenePackage(MakeScenePackage(ScenarioOf(GetParam(), folder.path() / "source")), again,
                    false);
  EXPECT_EQ(Files(to), Files(again));
}

}  // namespace
}  // namespace predictor::scene_export
