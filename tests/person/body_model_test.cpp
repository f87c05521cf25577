// Compares kinematics and inverse dynamics with MuJoCo, which reads the body from its own XML.
#include "person/body_model.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "mjcf.h"
#include "people.h"

namespace predictor::person {
namespace {

constexpr int kStates = 200;

class AgainstMujoco : public testing::TestWithParam<Sex> {
 protected:
  AgainstMujoco()
      : model(GetParam() == Sex::kMale ? Man() : Woman()),
        mj(nullptr, &mj_deleteModel),
        data(nullptr, &mj_deleteData) {
    std::array<char, 1000> error = {};
    mjSpec* spec = mj_parseXMLString(MjcfOf(model).c_str(), nullptr, error.data(), error.size());
    if (spec == nullptr) throw std::runtime_error(error.data());
    mj.reset(mj_compile(spec, nullptr));
    if (mj == nullptr) throw std::runtime_error(mjs_getError(spec));
    mj_deleteSpec(spec);
    data.reset(mj_makeData(mj.get()));
    mj->opt.disableflags |= mjDSBL_LIMIT;
  }

  void SetState(const BodyVector& q, const BodyVector& v, const BodyVector& a) {
    std::copy_n(q.data(), kBodyJoints, data->qpos);
    std::copy_n(v.data(), kBodyJoints, data->qvel);
    std::copy_n(a.data(), kBodyJoints, data->qacc);
    mj_inverse(mj.get(), data.get());
  }

  int BodyNamed(const std::string& name) const {
    return mj_name2id(mj.get(), mjOBJ_BODY, name.c_str());
  }

  BodyModel model;
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> mj;
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data;
  RandomStream random{1, "body"};
};

INSTANTIATE_TEST_SUITE_P(People, AgainstMujoco, testing::Values(Sex::kMale, Sex::kFemale),
                         [](const auto& person) -> std::string {
                           return person.param == Sex::kMale ? "Man" : "Woman";
                         });

TEST_P(AgainstMujoco, SameJointsAndMass) {
  ASSERT_EQ(mj->nv, kBodyJoints);
  for (int i = 0; i < kBodyJoints; ++i)
    EXPECT_STREQ(mj_id2name(mj.get(), mjOBJ_JOINT, i), JointName(i));
  EXPECT_NEAR(mj_getTotalmass(mj.get()), model.anthropometry().mass, 1e-9);
}

TEST_P(AgainstMujoco, SamePlacesAndJacobians) {
  for (int s = 0; s < kStates; ++s) {
    const BodyVector q = RandomPosture(model, &random);
    SetState(q, BodyVector::Zero(), BodyVector::Zero());
    const Placement at = Place(model, q);
    for (const char* name : {"left_hand", "right_hand", "head", "torso"}) {
      const int body = BodyNamed(name);
      const int joint = body == BodyNamed("head") ? static_cast<int>(kNeckTwist)
                        : body == BodyNamed("torso")
                            ? static_cast<int>(kTorsoTwist)
                            : Of(body == BodyNamed("left_hand") ? 0 : 1, ArmJoint::kWristDeviation);
      const Pose X = at.FrameOf(joint);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(X.p[i], data->xpos[3 * body + i], 1e-12);
      const Quaternion other(data->xquat[4 * body], data->xquat[4 * body + 1],
                             data->xquat[4 * body + 2], data->xquat[4 * body + 3]);
      EXPECT_NEAR(RotationError(X.q, other).norm(), 0, 1e-12);
      const Vector3 p = X * Vector3(0.1, 0.2, -0.3);
      Eigen::Matrix<double, 3, kBodyJoints, Eigen::RowMajor> linear, angular;
      mj_jac(mj.get(), data.get(), linear.data(), angular.data(), p.data(), body);
      const BodyJacobian J = JacobianAt(model, at, joint, p);
      EXPECT_LT((J.topRows<3>() - linear).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_LT((J.bottomRows<3>() - angular).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

// Velocities, accelerations and the wrenches on both hands are random. Torques reach 1e4 N·m.
TEST_P(AgainstMujoco, SameTorques) {
  double largest = 0;
  for (int s = 0; s < kStates; ++s) {
    const BodyVector q = RandomPosture(model, &random), v = RandomVector(&random, 2),
                     a = RandomVector(&random, 10);
    SetState(q, v, a);
    BodyVector expected = Eigen::Map<const BodyVector>(data->qfrc_inverse);
    std::array<ExternalWrench, kHands> wrenches;
    for (int hand = 0; hand < kHands; ++hand) {
      ExternalWrench& wrench = wrenches[static_cast<std::size_t>(hand)];
      wrench.joint = Of(hand, ArmJoint::kWristDeviation);
      for (int i = 0; i < 6; ++i) wrench.F[i] = 50 * random.Normal();
      for (int i = 0; i < 3; ++i) wrench.p[i] = random.Normal();
      const Vector3 force = wrench.F.head<3>(), torque = wrench.F.tail<3>();
      BodyVector applied = BodyVector::Zero();
      mj_applyFT(mj.get(), data.get(), force.data(), torque.data(), wrench.p.data(),
                 BodyNamed(std::string(HandName(hand)) + "_hand"), applied.data());
      expected -= applied;
    }
    const JointLoads loads = InverseDynamics(model, q, v, a, wrenches);
    EXPECT_LT((loads.torque - expected).cwiseAbs().maxCoeff(), 1e-9) << s;
    largest = std::max(largest, expected.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(largest, 1000);
}

// The inverse kinematics must stay within the joint limits that MuJoCo reads.
TEST_P(AgainstMujoco, SameLimits) {
  for (int i = 0; i < kBodyJoints; ++i) {
    EXPECT_EQ(mj->jnt_range[2 * i], model.joint(i).lower);
    EXPECT_EQ(mj->jnt_range[2 * i + 1], model.joint(i).upper);
  }
}

}  // namespace
}  // namespace predictor::person
