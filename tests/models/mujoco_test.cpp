// Compares dynamics and kinematics with MuJoCo, which reads the URDF with a different parser.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Cholesky>

#include "models/mujoco_urdf.h"
#include "models/object_model.h"
#include "models/robots.h"

namespace predictor::test {
namespace {

constexpr int kComparedStates = 100;
constexpr double kGravity = 9.81;  // [m/s²], MuJoCo's default

using SpecPtr = std::unique_ptr<mjSpec, decltype(&mj_deleteSpec)>;
using ModelPtr = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using DataPtr = std::unique_ptr<mjData, decltype(&mj_deleteData)>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

SpecPtr ParseSpec(const std::string& text) {
  std::array<char, 1000> error = {};
  SpecPtr spec(mj_parseXMLString(text.c_str(), nullptr, error.data(), error.size()),
               &mj_deleteSpec);
  if (spec == nullptr) throw std::runtime_error(error.data());
  return spec;
}

ModelPtr Compile(mjSpec* spec) {
  ModelPtr model(mj_compile(spec, nullptr), &mj_deleteModel);
  if (model == nullptr) throw std::runtime_error(mjs_getError(spec));
  return model;
}

class AgainstMujoco : public RobotTest {
 protected:
  AgainstMujoco() : mj(nullptr, &mj_deleteModel), state(nullptr, &mj_deleteData) {
    const SpecPtr spec = ParseSpec(MujocoUrdf(urdf));
    mjsBody* root = mjs_asBody(mjs_firstChild(mjs_findBody(spec.get(), "world"), mjOBJ_BODY, 0));
    const Pose X_WB = SlantedBase();
    std::copy_n(X_WB.p.data(), 3, root->pos);
    const double quaternion[4] = {X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()};
    std::copy_n(quaternion, 4, root->quat);
    mj = Compile(spec.get());
    mj->opt.disableflags |= mjDSBL_LIMIT;
    state = DataPtr(mj_makeData(mj.get()), &mj_deleteData);
  }

  // Evaluates both models at (q, v) with joint torques tau.
  void Evaluate(const JointVector& tau) {
    std::copy_n(q.data(), n, state->qpos);
    std::copy_n(v.data(), n, state->qvel);
    std::copy_n(tau.data(), n, state->qfrc_applied);
    mj_forward(mj.get(), state.get());
    data.UpdateDynamics(*model, q, v, kGravity);
  }

  ModelPtr mj;
  DataPtr state;
};

INSTANTIATE_TEST_SUITE_P(Robots, AgainstMujoco, testing::ValuesIn(RobotCases()), NameOf);

TEST_P(AgainstMujoco, SameJointsInTheSameOrder) {
  ASSERT_EQ(static_cast<int>(mj->nv), n);
  for (int j = 0; j < n; ++j) {
    EXPECT_EQ(model->joint_name(j), mj_id2name(mj.get(), mjOBJ_JOINT, j));
    if (std::isinf(model->position_lower()(j))) {
      EXPECT_FALSE(mj->jnt_limited[j]);
    } else {
      EXPECT_EQ(model->position_lower()(j), mj->jnt_range[2 * j]);
      EXPECT_EQ(model->position_upper()(j), mj->jnt_range[2 * j + 1]);
    }
  }
  EXPECT_EQ(mj->neq, 0);
  EXPECT_NEAR(model->mass(), mj->body_subtreemass[0], 1e-12);
  EXPECT_EQ(static_cast<std::size_t>(mj->nbody), urdf.links.size() + 1);
}

TEST_P(AgainstMujoco, MassMatrixBiasAndForwardDynamics) {
  for (int i = 0; i < kComparedStates; ++i, Shake()) {
    const JointVector tau = RandomVector(20);
    Evaluate(tau);
    RowMatrix M(n, n);
    mj_fullM(mj.get(), state.get(), M.data());
    EXPECT_LT((data.M() - M).norm(), 1e-10 * M.norm());
    const Eigen::Map<const Eigen::VectorXd> bias(state->qfrc_bias, n);
    EXPECT_LT((data.bias() - bias).norm(), 1e-10 * (1 + bias.norm()));
    const Eigen::VectorXd acceleration = data.M().ldlt().solve(tau - data.bias());
    const Eigen::Map<const Eigen::VectorXd> expected(state->qacc, n);
    EXPECT_LT((acceleration - expected).norm(), 1e-8 * (1 + expected.norm()));
  }
}

TEST_P(AgainstMujoco, GravityIsTheBiasAtRestAndScales) {
  for (int i = 0; i < kComparedStates; ++i, Shake()) {
    v.setZero();
    Evaluate(JointVector::Zero(n));
    const Eigen::Map<const Eigen::VectorXd> bias(state->qfrc_bias, n);
    EXPECT_LT((data.gravity() - bias).norm(), 1e-10 * (1 + bias.norm()));
    data.UpdateDynamics(*model, q, v, 0);
    EXPECT_LT(data.gravity().norm(), 1e-12);
    EXPECT_LT(data.bias().norm(), 1e-12);
  }
}

TEST_P(AgainstMujoco, PosesAndJacobiansOfAllLinks) {
  for (int i = 0; i < kComparedStates; ++i, Shake()) {
    Evaluate(JointVector::Zero(n));
    for (const std::string& link : model->link_names()) {
      const std::string name = link == "world" ? "world_link" : link;
      const int body = mj_name2id(mj.get(), mjOBJ_BODY, name.c_str());
      ASSERT_GT(body, 0) << link;
      const double* x = state->xpos + 3 * body;
      const double* r = state->xquat + 4 * body;
      const Pose expected{Vector3(x[0], x[1], x[2]), Quaternion(r[0], r[1], r[2], r[3])};
      const FrameId origin = model->Frame(link);
      EXPECT_LT(PoseError(expected, data.FramePose(*model, origin)).norm(), 1e-12) << link;
      RowMatrix translation(3, n), rotation(3, n);
      mj_jacBody(mj.get(), state.get(), translation.data(), rotation.data(), body);
      Jacobian J;
      data.FrameJacobian(*model, origin, &J);
      EXPECT_LT((J.topRows<3>() - translation).norm(), 1e-12) << link;
      EXPECT_LT((J.bottomRows<3>() - rotation).norm(), 1e-12) << link;
    }
  }
}

// No frame of this object lies in the object's centre or is parallel to another frame.
constexpr const char* kLopsidedUrdf = R"(<robot name="lopsided">
  <link name="a"><inertial><origin xyz="0.1 -0.2 0.05" rpy="0.3 0.2 0.1"/><mass value="2"/>
    <inertia ixx="0.05" iyy="0.04" izz="0.03" ixy="0.004" ixz="-0.002" iyz="0.001"/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="b"><inertial><origin xyz="0 0 0.3"/><mass value="1"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.015" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="weld" type="fixed"><parent link="a"/><child link="b"/>
    <origin xyz="0.2 0.1 0" rpy="1 -0.5 0.3"/></joint></robot>)";

// MuJoCo combines the inertias of all links of an object about their common centre of mass.
class ObjectsAgainstMujoco : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Assets, ObjectsAgainstMujoco,
                         testing::Values("box_9kg", "box_18kg", "bar", "lopsided"),
                         [](const auto& name) { return name.param; });

TEST_P(ObjectsAgainstMujoco, MassCentreAndInertia) {
  const UrdfModel urdf =
      GetParam() == "lopsided"
          ? ParseUrdf(kLopsidedUrdf, "lopsided.urdf", ".")
          : ReadUrdf(std::string(PREDICTOR_SOURCE_DIR) + "/assets/" + GetParam() + ".urdf");
  const ObjectModel object = MakeObject(urdf);
  const SpecPtr spec = ParseSpec(MujocoUrdf(urdf, MujocoShapes::kCollisions));
  mjs_addFreeJoint(mjs_asBody(mjs_firstChild(mjs_findBody(spec.get(), "world"), mjOBJ_BODY, 0)));
  const ModelPtr mj = Compile(spec.get());
  EXPECT_EQ(static_cast<std::size_t>(mj->ngeom), object.collisions.size());
  const DataPtr state(mj_makeData(mj.get()), &mj_deleteData);
  mj_forward(mj.get(), state.get());
  EXPECT_NEAR(object.mass, mj->body_subtreemass[1], 1e-12);
  EXPECT_LT((object.com - Vector3(state->subtree_com + 3)).norm(), 1e-12);
  RowMatrix M(6, 6);  // of the free joint at the root: its lower right block is about O
  mj_fullM(mj.get(), state.get(), M.data());
  const Matrix3 about_O = M.bottomRightCorner<3, 3>();
  const Vector3& c = object.com;
  const Matrix3 shift = object.mass * (c.squaredNorm() * Matrix3::Identity() - c * c.transpose());
  EXPECT_LT((object.inertia + shift - about_O).norm(), 1e-12);
}

// MuJoCo does not tolerate rounding errors in the inertias of three bodies: a rod without inertia
// about its axis, a plate whose inertia is rounded up, and a point mass.
TEST(MujocoUrdf, LoadsRoundedInertia) {
  const UrdfModel urdf = ParseUrdf(R"(<robot name="r"><link name="base"/>
    <link name="plate"><inertial><mass value="1"/>
      <inertia ixx="0.333333" iyy="0.333333" izz="0.6666663"/></inertial></link>
    <link name="rod"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0" izz="0.1"/></inertial></link>
    <link name="point"><inertial><mass value="1"/><inertia ixx="0" iyy="0" izz="0"/></inertial></link>
    <joint name="j" type="continuous"><parent link="base"/><child link="plate"/></joint>
    <joint name="k" type="continuous"><parent link="plate"/><child link="rod"/></joint>
    <joint name="l" type="fixed"><parent link="rod"/><child link="point"/></joint></robot>)",
                                   "rounded.urdf", ".");
  const SpecPtr spec = ParseSpec(MujocoUrdf(urdf));
  EXPECT_NEAR(Compile(spec.get())->body_subtreemass[0], 3, 1e-12);
}

TEST(Primitives, InertiaIsThatOfUniformDensity) {
  for (const Shape shape : {Shape::kBox, Shape::kCylinder, Shape::kSphere}) {
    PrimitiveSpec primitive;
    primitive.shape = shape;
    primitive.mass = 3;
    primitive.size = {0.3, 0.5, 0.2};
    const ObjectModel object = MakeObject(primitive);
    const SpecPtr spec(mj_makeSpec(), &mj_deleteSpec);
    mjsBody* body = mjs_addBody(mjs_findBody(spec.get(), "world"), nullptr);
    mjsGeom* geom = mjs_addGeom(body, nullptr);
    geom->mass = primitive.mass;
    const bool is_box = shape == Shape::kBox, is_cylinder = shape == Shape::kCylinder;
    geom->type = is_box ? mjGEOM_BOX : is_cylinder ? mjGEOM_CYLINDER : mjGEOM_SPHERE;
    geom->size[0] = is_box ? 0.15 : 0.3;
    geom->size[1] = 0.25;
    geom->size[2] = 0.1;
    const ModelPtr mj = Compile(spec.get());
    const Quaternion q(mj->body_iquat[4], mj->body_iquat[5], mj->body_iquat[6], mj->body_iquat[7]);
    const Matrix3 expected = q.toRotationMatrix() * Vector3(mj->body_inertia + 3).asDiagonal() *
                             q.toRotationMatrix().transpose();
    EXPECT_LT((object.inertia - expected).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace predictor::test
