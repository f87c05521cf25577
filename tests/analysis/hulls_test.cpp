// Tests the warnings about meshes whose convex hull fills a recess.
#include "analysis/check/hulls.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "scenario/scenario_io.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace predictor {
namespace {

// A prism along z with the cross-section of a V: the triangle (−1, 0), (1, 0), (0, 1), without the
// triangle (−1, 0), (1, 0), (0, `depth`). Its hull is 1/(1 − depth) times as large.
std::string VShape(double depth) {
  std::string text;
  for (const char* z : {"0", "1"})
    text += std::string("v -1 0 ") + z + "\nv 0 " + std::to_string(depth) + " " + z + "\nv 1 0 " +
            z + "\nv 0 1 " + z + "\n";
  // Bottom, top, and the four sides.
  return text +
         "f 1 4 2\nf 2 4 3\nf 5 6 8\nf 6 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\n"
         "f 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";
}

TEST(HullWarnings, NameTheMeshesThatCollideAndTheirExcess) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "deep.obj") << VShape(0.5);
  std::ofstream(folder / "flat.obj") << VShape(0.2);
  std::ofstream(folder / "part.urdf")
      << R"(<robot name="part"><link name="part"><inertial><mass value="2"/>)"
      << R"(<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>)"
      << "\n<collision><geometry><mesh filename=\"deep.obj\" scale=\"0.1 0.1 0.1\"/></geometry>"
      << "</collision>\n<collision><geometry><mesh filename=\"flat.obj\" scale=\"0.1 0.1 0.1\"/>"
      << "</geometry></collision></link></robot>";
  Scenario s =
      LoadScenario(std::filesystem::path(PREDICTOR_SOURCE_DIR) / "scenarios/slide_on_table.yaml");
  s.file = folder / "test.yaml";
  s.object.primitive.reset();
  s.object.model = "part.urdf";
  const std::vector<std::string> warnings = HullWarnings(s, {});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(Contains(warnings[0], "object.model: ")) << warnings[0];
  EXPECT_TRUE(Contains(
      warnings[0], "part.urdf:2: The convex hull of the mesh " + (folder / "deep.obj").string() +
                       " collides instead of the mesh, and is 2.0 times as large."))
      << warnings[0];
  s.environment.fixtures.clear();
  EXPECT_TRUE(HullWarnings(s, {}).empty());
  s.cobot.touches = {"object"};
  EXPECT_EQ(HullWarnings(s, {}).size(), 1u);
}

// A link of the cobot is judged only if it can touch something.
TEST(HullWarnings, ConcernLinksThatCanTouch) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "deep.obj") << VShape(0.5);
  std::ofstream(folder / "arm.urdf")
      << "<robot name=\"arm\"><link name=\"base\"><collision><geometry><mesh "
         "filename=\"deep.obj\"/>"
         "</geometry></collision></link></robot>\n";
  Scenario s = LoadScenario(std::filesystem::path(PREDICTOR_SOURCE_DIR) / "scenarios/box_9kg.yaml");
  s.file = folder / "test.yaml";
  s.cobot.model = "arm.urdf";
  s.cobot.remove_links.clear();
  s.cobot.touches = {"cobot"};
  const std::vector<std::string> warnings = HullWarnings(s, {{"base", "hand"}});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(Contains(warnings[0], "cobot.model: ")) << warnings[0];
  EXPECT_TRUE(HullWarnings(s, {{"base", "hand", PairState::kOverlaps}}).empty());
}

TEST(HullWarnings, AreAbsentForPrimitivesAndForAPanda) {
  for (const char* name : {"peg_in_hole", "doorway", "push_boxes"})
    EXPECT_TRUE(HullWarnings(LoadScenario(std::filesystem::path(PREDICTOR_SOURCE_DIR) /
                                          "scenarios" / (std::string(name) + ".yaml")),
                             {})
                    .empty())
        << name;
}

}  // namespace
}  // namespace predictor
