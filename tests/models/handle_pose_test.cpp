#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "models/object_model.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace predictor::test {
namespace {

namespace fs = std::filesystem;

// An object of three links. The second lies beside the first and is turned about z, and the third
// lies on the second's x axis and is turned about its y axis.
constexpr const char* kTool = R"(<robot name="tool">
  <link name="body"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
  <link name="arm"/>
  <link name="grip"/>
  <joint name="a" type="fixed"><parent link="body"/><child link="arm"/>
    <origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="b" type="fixed"><parent link="arm"/><child link="grip"/>
    <origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/></joint>
</robot>)";

class HandleOnALink : public testing::Test {
 protected:
  HandleOnALink() {
    std::ofstream(folder_ / "tool.urdf") << kTool;
    scenario_.file = folder_ / "scenario.yaml";
    scenario_.object.model = "tool.urdf";
    scenario_.right_handle = HandleSpec{{{0.01, 0.02, 0.05}, {0, 0, 0.3}}};
  }

  TemporaryFolder folder_;
  Scenario scenario_;
};

TEST_F(HandleOnALink, WithoutALinkIsInTheObjectsFrame) {
  const Pose X_OD = HandlePose(scenario_, 1);
  EXPECT_EQ(X_OD.p, Vector3(0.01, 0.02, 0.05));
  EXPECT_LT(RotationError(X_OD.q, PoseFromXyzRpy(Vector3::Zero(), {0, 0, 0.3}).q).norm(), 1e-15);
}

TEST_F(HandleOnALink, IsInTheFrameOfThisLink) {
  scenario_.right_handle->link = "arm";
  // The arm's x axis is the object's y axis, and its y axis is the object's −x axis.
  EXPECT_LT((HandlePose(scenario_, 1).p - Vector3(0.1 - 0.02, 0.01, 0.05)).norm(), 1e-15);
  scenario_.right_handle->link = "grip";
  // The grip's x, y and z axes are the object's −z, −x and y axes.
  const Pose X_OD = HandlePose(scenario_, 1);
  EXPECT_LT((X_OD.p - Vector3(0.1 - 0.02, 0.2 + 0.05, -0.01)).norm(), 1e-15);
  EXPECT_LT((X_OD.R() * Vector3::UnitZ() - Vector3::UnitY()).norm(), 1e-15);
  EXPECT_LT((X_OD.R() * Vector3::UnitX() - Vector3(-std::sin(0.3), 0, -std::cos(0.3))).norm(),
            1e-15);
}

TEST_F(HandleOnALink, TheRootLinkIsTheObjectsFrame) {
  const Pose expected = HandlePose(scenario_, 1);
  scenario_.right_handle->link = "body";
  EXPECT_EQ(HandlePose(scenario_, 1).p, expected.p);
  EXPECT_EQ(HandlePose(scenario_, 1).q.coeffs(), expected.q.coeffs());
}

TEST_F(HandleOnALink, AnUnknownLinkIsAnErrorAtTheKey) {
  scenario_.right_handle->link = "gripp";
  try {
    HandlePose(scenario_, 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(Contains(error.what(),
                         "handles.right.link is \"gripp\", but the object \"tool\" has no "
                         "such link. Did you mean grip?"))
        << error.what();
    EXPECT_EQ(error.key(), "handles.right.link");
  }
}

}  // namespace
}  // namespace predictor::test
