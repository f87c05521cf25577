#include "scenario/task.h"

#include <gtest/gtest.h>

#include "scenario/scenario_io.h"

namespace predictor {
namespace {

Scenario Load(const std::string& name, const std::vector<std::string>& set = {}) {
  return LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name + ".yaml", set);
}
using Parts = std::vector<std::string>;

TEST(Task, IsTheSameOnAnotherSystem) {
  const Scenario circle = Load("bar_circle");
  EXPECT_EQ(TaskDifferences(circle, circle), Parts{});
  EXPECT_EQ(TaskDifferences(circle, Load("bar_circle", {"mode=direct", "seed=7", "rate=500",
                                                        "cobot.joint_friction.viscous=2.5",
                                                        "rendering.kp=1", "safety.force=20"})),
            Parts{});
}

TEST(Task, DiffersByLoadAndScript) {
  const Scenario circle = Load("bar_circle");
  EXPECT_EQ(TaskDifferences(circle, Load("bar_circle", {"guidance.radius=0.2"})),
            Parts{"the guidance"});
  EXPECT_EQ(TaskDifferences(circle, Load("bar_circle", {"environment.gravity=1.6"})),
            Parts{"the surroundings"});
  const Parts parts = TaskDifferences(circle, Load("box_9kg"));
  EXPECT_EQ(parts.front(), "the object");
  EXPECT_EQ(parts.back(), "the script");
  EXPECT_EQ(TaskDifferences(Load("box_9kg"), Load("single_arm")).front(), "the object");
}

}  // namespace
}  // namespace predictor
