#include "scenario/formulation.h"

#include <gtest/gtest.h>

#include "fixture.h"
#include "scenario/scenario.h"

namespace predictor {
namespace {

TEST(Formulation, IsRepairedUnlessStated) {
  EXPECT_TRUE(RepairsOf(Fixture().rendering).HasAll());
  const Scenario paper = Fixture({"rendering.formulation=paper"});
  for (const RepairEntry& entry : RepairTable())
    EXPECT_FALSE(RepairsOf(paper.rendering).Has(entry.repair)) << entry.name;
  EXPECT_EQ(paper.rendering.lead, 0);
  EXPECT_EQ(paper.coupling.stiffness, 0);
}

// Each name must add exactly its repair to the paper's formulation. It must remove exactly this
// repair from our formulation.
TEST(Formulation, ExceptChangesOneRepair) {
  for (const RepairEntry& entry : RepairTable()) {
    const std::string except = std::string("rendering.formulation_except=[") + entry.name + "]";
    const RepairSet added = RepairsOf(Fixture({"rendering.formulation=paper", except}).rendering);
    const RepairSet removed = RepairsOf(Fixture({except}).rendering);
    for (const RepairEntry& other : RepairTable()) {
      EXPECT_EQ(added.Has(other.repair), other.repair == entry.repair) << entry.name;
      EXPECT_EQ(removed.Has(other.repair), other.repair != entry.repair) << entry.name;
    }
  }
}

TEST(Formulation, RefusesUnknownNamesAndValuesWithoutEffect) {
  const auto error = [](const std::vector<std::string>& set) {
    return ErrorOf(FixtureText(), set);
  };
  EXPECT_NE(error({"rendering.formulation=papers"}).find("rendering.formulation"),
            std::string::npos);
  EXPECT_NE(error({"rendering.formulation_except=[leads]"}).find("lead"), std::string::npos);
  const std::string paper = "rendering.formulation=paper";
  EXPECT_NE(error({paper, "rendering.lead=0.01"}).find("rendering.lead has no effect"),
            std::string::npos);
  EXPECT_NE(error({paper, "coupling.damping=3"}).find("coupling.damping has no effect"),
            std::string::npos);
  EXPECT_EQ(error({paper, "rendering.lead=0", "coupling.damping=0"}), "");
}

// A recording contains the scenario with a lead and a coupling of zero. The program must be able to
// load this scenario again.
TEST(Formulation, SurvivesSavingAndLoading) {
  const Scenario paper = Fixture({"rendering.formulation=paper"});
  const Scenario again = ParseScenario(SaveScenario(paper), "saved.yaml", kData);
  EXPECT_EQ(SaveScenario(again), SaveScenario(paper));
  EXPECT_EQ(again.rendering.formulation, "paper");
}

}  // namespace
}  // namespace predictor
