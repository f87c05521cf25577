// The program must read files from others before it connects to an arm. A file that makes a reader
// fail, hang or crash then cannot affect an arm that follows the program. In these tests, there is
// no device. A program that tried to connect first would therefore report the missing device
// instead of the file.
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "machine/rig_process.h"

namespace predictor {
namespace {

// Returns a text so deeply nested that a recursive reader without a limit exhausts its stack.
std::string Nested(const std::string& open) {
  std::string text;
  for (int depth = 0; depth < 100'000; ++depth) text += open;
  return text;
}

// Returns a binary STL that announces as many triangles as possible and contains none.
std::string HollowMesh() { return std::string(80, ' ') + "\xff\xff\xff\xff"; }

constexpr const char* kObjectWithMesh = R"(<robot name="box"><link name="box">
  <inertial><mass value="9"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  <collision><geometry><mesh filename="hollow.stl"/></geometry></collision></link></robot>)";

// A file from an untrusted source.
struct Foreign {
  const char* name;
  // the setting that refers to the file; "" for the scenario or the machine file itself
  const char* key;
  const char* file;
  std::string text;
  const char* blamed;  // name of the file in the error
};

std::ostream& operator<<(std::ostream& out, const Foreign& foreign) { return out << foreign.name; }

class BeforeTheArms : public testing::Test {
 protected:
  BeforeTheArms() : folder_({"ur", "ur"}) {
    folder_.NotePushTests();
    setenv("PREDICTOR_PACKAGE_PATH", (folder_ / "").parent_path().c_str(), 1);
  }
  ~BeforeTheArms() override { unsetenv("PREDICTOR_PACKAGE_PATH"); }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::vector<std::string> Arguments(const std::string& scenario) const {
    return {"run",          scenario,     "--machine",
            folder_.file(), "--set",      "operator.type=person",
            "--no-viewer",  "--no-record"};
  }

  const MachineFolder folder_;
};

class ForeignFile : public BeforeTheArms, public testing::WithParamInterface<Foreign> {};

TEST_P(ForeignFile, IsReadBeforeAnArmIsConnected) {
  const Foreign& foreign = GetParam();
  const std::string file = folder_ / foreign.file, key = foreign.key;
  Write("hollow.stl", HollowMesh());
  Write(foreign.file, foreign.text);
  std::vector<std::string> arguments =
      Arguments(foreign.name == std::string("Scenario") ? file : FileOf("dual_ur5"));
  if (key == "arms.left.arm.model") {
    const std::string package = (folder_ / "").parent_path().filename();
    folder_.Change([&](Machine* machine) {
      machine->left->arm.model = "package://" + package + "/" + foreign.file;
    });
    folder_.NotePushTests();  // the earlier push tests belong to another model
  } else if (!key.empty()) {
    arguments.insert(arguments.end(), {"--set", key + "=" + file});
  }
  Terminal terminal(arguments);
  EXPECT_EQ(terminal.Wait(), 2) << terminal.Screen();
  EXPECT_NE(terminal.Screen().find(foreign.blamed), std::string::npos) << terminal.Screen();
  EXPECT_EQ(terminal.Screen().find("Connecting"), std::string::npos) << terminal.Screen();
}

INSTANTIATE_TEST_SUITE_P(
    Every, ForeignFile,
    testing::Values(
        Foreign{"Scenario", "", "foreign.yaml", "a: " + Nested("["), "foreign.yaml"},
        Foreign{"Machine", "", "lab.yaml", "arms: " + Nested("{a: "), "lab.yaml"},
        Foreign{"Object", "object.model", "object.urdf", Nested("<robot>"), "object.urdf"},
        Foreign{"Mesh", "object.model", "object.urdf", kObjectWithMesh, "hollow.stl"},
        Foreign{"Cobot", "cobot.model", "cobot.urdf", Nested("<robot>"), "cobot.urdf"},
        Foreign{"Arm", "arms.left.arm.model", "arm.urdf", Nested("<robot>"), "arm.urdf"}),
    [](const testing::TestParamInfo<Foreign>& which) { return which.param.name; });

// The tests above would notice a connection. If the files are sound, the program connects and
// reports that there is no device.
TEST_F(BeforeTheArms, SoundFilesLetTheProgramConnect) {
  Terminal terminal(Arguments(FileOf("dual_ur5")));
  EXPECT_EQ(terminal.Wait(), 3) << terminal.Screen();
  EXPECT_NE(terminal.Screen().find("Connecting"), std::string::npos) << terminal.Screen();
}

}  // namespace
}  // namespace predictor
