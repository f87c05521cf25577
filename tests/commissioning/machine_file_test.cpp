#include "commissioning/machine_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "rig/arms.h"
#include "scenario/scenario_io.h"

namespace predictor::commissioning {
namespace {

namespace fs = std::filesystem;

std::string Read(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class MachineFile : public testing::Test {
 protected:
  MachineFile()
      : folder_(fs::temp_directory_path() / ("machine-" + std::to_string(getpid()))),
        file_(folder_ / "rig.yaml") {
    fs::create_directories(folder_);
    std::ofstream(file_) << kText;
  }
  ~MachineFile() override { fs::remove_all(folder_); }

  int Files() const { return static_cast<int>(std::distance(fs::directory_iterator(folder_), {})); }

  static constexpr const char* kText = R"(predictor_machine: 1  # of the lab downstairs
name: two of them
arms:
  left:
    connection: {make: ur, host: 192.0.2.10}
    arm:
      model: package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf
      end_effector: tool0
)";
  fs::path folder_, file_;
};

TEST_F(MachineFile, IsChangedAndItsCopyKept) {
  const fs::path copy = ChangeMachine(
      file_, "2026-11-22", [](Machine* machine) { machine->left->arm.payload.mass = 0.61; });
  EXPECT_EQ(copy.string(), file_.string() + ".before-2026-11-22");
  EXPECT_EQ(Read(copy), kText);
  const Machine after = LoadMachine(file_);
  EXPECT_EQ(after.left->arm.payload.mass, 0.61);
  EXPECT_EQ(after.left->connection.host, "192.0.2.10");
  EXPECT_EQ(after.left->arm.end_effector, "tool0");
  EXPECT_EQ(after.name, "two of them");
  EXPECT_FALSE(after.right);
  const std::string first = Read(file_);
  const fs::path second = ChangeMachine(file_, "2026-11-22", [](Machine*) {});
  EXPECT_EQ(second.string(), file_.string() + ".before-2026-11-22-2");
  EXPECT_EQ(Read(second), first);
  EXPECT_EQ(Read(file_), first);  // the written file is read back unchanged
  EXPECT_EQ(Files(), 3);
}

TEST_F(MachineFile, IsChangedThroughALink) {
  const fs::path link = folder_ / "link.yaml";
  fs::create_symlink("rig.yaml", link);
  ChangeMachine(link, "now", [](Machine* machine) { machine->name = "other"; });
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(LoadMachine(file_).name, "other");
}

TEST_F(MachineFile, IsUnchangedByAnEmptyChange) {
  EXPECT_THROW(
      ChangeMachine(file_, "now", [](Machine* machine) { machine->left->arm.payload.mass = -1; }),
      InputError);
  EXPECT_THROW(ChangeMachine(file_, "now", [](Machine*) { throw InputError("no"); }), InputError);
  EXPECT_THROW(ChangeMachine(folder_ / "none.yaml", "now", [](Machine*) {}), InputError);
  EXPECT_EQ(Read(file_), kText);
  EXPECT_EQ(Files(), 1);
}

TEST_F(MachineFile, StampHoldsUntilTheArmIsChanged) {
  const auto tested = [this] { return IsPushTested(*LoadMachine(file_).left); };
  Scenario scenario = ArmScenario(1);
  EXPECT_FALSE(tested());
  EXPECT_THROW(RequirePushTests(LoadMachine(file_), scenario), InputError);
  const auto stamp = [](Machine* machine) {
    machine->left->commissioned = Commissioned{"2026-11-22", HashOf(*machine->left), "", ""};
  };
  ChangeMachine(file_, "a", stamp);
  EXPECT_TRUE(tested());
  EXPECT_NO_THROW(RequirePushTests(LoadMachine(file_), scenario));
  ChangeMachine(file_, "b", [](Machine* machine) { machine->name = "other"; });
  EXPECT_TRUE(tested());
  using Change = void (*)(MachineArm*);
  for (const Change change : {Change([](MachineArm* a) { a->arm.sensor.pose.rpy[2] += 1e-3; }),
                              Change([](MachineArm* a) { a->connection.host = "192.0.2.11"; }),
                              Change([](MachineArm* a) { a->arm.payload.mass += 1e-3; }),
                              Change([](MachineArm* a) { a->arm.loop.delay += 1e-4; })}) {
    ChangeMachine(file_, "c", [&](Machine* machine) { change(&*machine->left); });
    EXPECT_FALSE(tested());
    try {
      RequirePushTests(LoadMachine(file_), scenario);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("arms.left was changed after"), std::string::npos)
          << error.what();
    }
    ChangeMachine(file_, "d", stamp);
    EXPECT_TRUE(tested());
  }
}

TEST_F(MachineFile, HashDependsOnTheContentNotOnTheFormat) {
  const std::string hash = HashOf(*LoadMachine(file_).left);
  EXPECT_EQ(hash.size(), 16u);
  std::ofstream(file_) << R"(predictor_machine: 1
arms:
  left:
    arm:
      end_effector: "tool0"
      model: package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf
      loop: {bandwidth: 15.0}  # as it is anyway
    connection: {host: 192.0.2.10, make: ur}
)";
  EXPECT_EQ(HashOf(*LoadMachine(file_).left), hash);
}

// The instructions in docs/tutorials/fake-rig.md use a copy of this file.
TEST(MachineFileOfTheDocuments, IsOneAndFitsItsScenario) {
  const Machine machine = LoadMachine(PREDICTOR_SOURCE_DIR "/docs/rig-without-arms.yaml");
  const Scenario scenario = LoadScenario(PREDICTOR_SOURCE_DIR "/scenarios/dual_ur5.yaml");
  for (int hand = 0; hand < kHands; ++hand) {
    ASSERT_TRUE(machine.arm(hand));
    const ArmSpec &here = machine.arm(hand)->arm, &there = scenario.arm(hand);
    EXPECT_EQ(here.model, there.model);
    EXPECT_EQ(here.base.xyz, there.base.xyz);
    EXPECT_EQ(here.handle.xyz, there.handle.xyz);
    EXPECT_EQ(here.posture, there.posture);
  }
  EXPECT_TRUE(machine.enabling);
}

}  // namespace
}  // namespace predictor::commissioning
