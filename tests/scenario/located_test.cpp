// Tests the locations of errors that are detected only after the models are loaded.
#include "scenario/located.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "fixture.h"
#include "scenario/yaml_tree.h"

namespace predictor {
namespace {

constexpr const char* kText = R"(a:
  b: {c: 1}
  list:
    - {d: 2}
    - {d: 3}
)";

TEST(Located, FindsKeysAndEntriesOfLists) {
  const YamlNode root = ParseYaml(kText, "x.yaml");
  EXPECT_EQ(PlaceOf("a.b.c", root).Text(), "x.yaml:2:10");
  EXPECT_EQ(PlaceOf("a.list.1.d", root).Text(), "x.yaml:5:11");
}

TEST(Located, TakesTheNearestGroupOfWhatIsNotThere) {
  const YamlNode root = ParseYaml(kText, "x.yaml");
  const std::string b = PlaceOf("a.b", root).Text();
  for (const char* path : {"a.b.z", "a.b.z.y", "a.b.c.5"})
    EXPECT_EQ(PlaceOf(path, root).line, 2) << path;
  EXPECT_EQ(PlaceOf("a.b.z", root).Text(), b);
  const std::string list = PlaceOf("a.list", root).Text();
  for (const char* path : {"a.list.2", "a.list.-1", "a.list.1x", "a.list.99999999999999999999"})
    EXPECT_EQ(PlaceOf(path, root).Text(), list) << path;
}

TEST(Located, NamesFileOrOverride) {
  const InputError error = InputError::At("cobot.end_effector", "cobot.end_effector is bad.");
  const std::string in_file = Located(error, Fixture()).what();
  EXPECT_EQ(in_file.rfind("box.yaml:", 0), 0u) << in_file;
  EXPECT_NE(in_file.find(": cobot.end_effector is bad."), std::string::npos) << in_file;
  EXPECT_STREQ(Located(error, Fixture({"cobot.end_effector=x"})).what(),
               "--set cobot.end_effector: cobot.end_effector is bad.");
}

TEST(Located, NamesAnExistingPlaceOnce) {
  const InputError error = InputError::At("seed", "seed is bad.");
  const InputError once = Located(error, Fixture());
  EXPECT_STREQ(Located(once, Fixture()).what(), once.what());
  EXPECT_STREQ(Located(error, Scenario{}).what(), "seed is bad.");
  EXPECT_STREQ(Located(InputError("It is bad."), Fixture()).what(), "It is bad.");
}

TEST(InputError, OfAPartIsReportedWithItsGroup) {
  const InputError of_list = InputError::At("posture", "posture has 2 values.");
  EXPECT_STREQ(of_list.Within("device.arms.left").what(), "device.arms.left.posture has 2 values.");
  EXPECT_EQ(of_list.Within("device.arms.left").key(), "device.arms.left.posture");
  const InputError of_file("arm.urdf:3", "It is bad.");
  EXPECT_STREQ(of_file.Within("cobot.model").what(), "cobot.model: arm.urdf:3: It is bad.");
  EXPECT_EQ(of_file.Within("cobot.model").key(), "cobot.model");
}

}  // namespace
}  // namespace predictor
