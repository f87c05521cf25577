// `check` must accept consistent scenarios and explain the problems of all others.
#include "analysis/check/check.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include "analysis/scenarios.h"
#include "core/error.h"
#include "core/format.h"
#include "scenario/scenario_io.h"
#include "scenario/yaml_tree.h"
#include "simulation/world.h"

namespace predictor {
namespace {

bool Mentions(const std::vector<std::string>& sentences, const std::string& words) {
  for (const std::string& sentence : sentences)
    if (sentence.find(words) != std::string::npos) return true;
  return false;
}

CheckOptions NoSearch() {
  CheckOptions options;
  options.search = false;
  return options;
}

Pose StartOfObject(const Scenario& s) { return World(s).state().object.X_W; }

TEST(IntendedPath, AddsUpTheScript) {
  const Scenario s = Load("box_9kg.yaml");
  const auto path = IntendedPath(s, {}, AfterRelease::kStays, 0.02);
  ASSERT_EQ(path.size(), 1501u);
  const Pose& end = path.back().X_WO;
  EXPECT_LT((end.p - Vector3(0, 0, 0.10 - 0.05)).norm(), 1e-9);
  EXPECT_LT(RotationError(end.q, RotationFromVector({0, 0, 0.349})).norm(), 1e-9);
  EXPECT_LT((path[650].X_WO.p - Vector3(0.2, 0, 0.1)).norm(), 1e-9);  // at 13 s
}

TEST(IntendedPath, OfAReleasedObjectMayReturnToItsStart) {
  const Scenario s = Load("box_9kg.yaml");
  EXPECT_TRUE(GripsAgain(s));
  const auto path = IntendedPath(s, {}, AfterRelease::kReturns, 0.02);
  EXPECT_LT((path[900].X_WO.p - Vector3(0, 0, 0.1)).norm(), 1e-9);  // released at 18 s
  EXPECT_LT(path[975].X_WO.p.norm(), 1e-3);                         // gripped again at 19.5 s
}

TEST(IntendedPath, HasTheVelocityOfItsPoses) {
  for (const char* name : {"box_9kg.yaml", "bar_circle.yaml"}) {
    const Scenario s = Load(name);
    for (const AfterRelease after : {AfterRelease::kStays, AfterRelease::kReturns}) {
      const auto path = IntendedPath(s, {}, after, 0.001);
      for (std::size_t k = 1; k + 1 < path.size(); ++k) {
        if (path[k - 1].held != path[k + 1].held) continue;
        const double span = path[k + 1].time - path[k - 1].time;
        const Vector3 v = (path[k + 1].X_WO.p - path[k - 1].X_WO.p) / span;
        const Vector3 w = RotationError(path[k + 1].X_WO.q, path[k - 1].X_WO.q) / span;
        ASSERT_LT((v - path[k].V_WO.head<3>()).norm(), 2e-3) << name << " at " << path[k].time;
        ASSERT_LT((w - path[k].V_WO.tail<3>()).norm(), 2e-3) << name << " at " << path[k].time;
      }
    }
  }
}

TEST(Reach, WithShiftedBasesIsThatOfAScenarioWithThoseBases) {
  const Scenario s = Load("box_9kg.yaml");
  const Vector3 left = s.arm(0).base.xyz + Vector3(0.05, 0.04, -0.03);
  const Vector3 right = s.arm(1).base.xyz + Vector3(-0.02, -0.05, 0.02);
  const auto list = [](const Vector3& p) {
    return "=[" + std::to_string(p.x()) + "," + std::to_string(p.y()) + "," +
           std::to_string(p.z()) + "]";
  };
  const Scenario moved = Load("box_9kg.yaml", {"device.arms.left.base.xyz" + list(left),
                                               "device.arms.right.base.xyz" + list(right)});
  const auto paths = TaskPaths(s, StartOfObject(s), 0.1);
  const Reach a = DeviceReach(s).Over(paths, {left - s.arm(0).base.xyz, right - s.arm(1).base.xyz});
  const Reach b = DeviceReach(moved).Over(paths);
  for (std::size_t h = 0; h < kHands; ++h) {
    EXPECT_FALSE(a.arms[h]->lost);
    EXPECT_NEAR(a.arms[h]->singular_value.value, b.arms[h]->singular_value.value, 1e-4);
    EXPECT_NEAR(a.arms[h]->joint_margin.value, b.arms[h]->joint_margin.value, 1e-3);
    EXPECT_NEAR(a.arms[h]->joint_speed.value, b.arms[h]->joint_speed.value, 1e-3);
  }
  ASSERT_EQ(a.pairs.size(), 1u);
  EXPECT_NEAR(a.pairs[0].distance.value, b.pairs[0].distance.value, 1e-3);
}

// If a handle follows a circle, its reported speed must be the speed along the circle, regardless
// of the arms' limits.
TEST(Reach, HandleOnACircleHasItsSpeed) {
  const Scenario s = Load("bar_circle.yaml");
  const Reach reach = DeviceReach(s).Over(TaskPaths(s, StartOfObject(s), 0.1));
  EXPECT_NEAR(reach.handles[0].speed.value, 2 * 3.14159265 * 0.15 / 8, 1e-3);
}

TEST(Check, NamesTheArmThatLeavesItsReach) {
  const Scenario s = Load("box_9kg.yaml", {"device.arms.right.base.xyz=[-0.25, 0.25, -0.25]"});
  const CheckReport report = Check(s, NoSearch());
  EXPECT_FALSE(report.fit());
  EXPECT_TRUE(Mentions(report.problems, "The right arm cannot follow"));
  EXPECT_FALSE(Mentions(report.problems, "The left arm"));
  EXPECT_TRUE(report.reach->arms[1]->lost);
  EXPECT_FALSE(report.reach->arms[0]->lost);
  // The report must not derive speeds from the last postures before the handle moves out of the
  // arm's reach.
  const std::string text = CheckText(report);
  const std::size_t line = text.find("right            CANNOT REACH ITS HANDLE from");
  ASSERT_NE(line, std::string::npos) << text;
  EXPECT_EQ(text.substr(line, text.find('\n', line) - line).find("rad"), std::string::npos);
}

TEST(Check, SaysThatAJointMayNotMoveAnyFurther) {
  CheckReport report = Check(Load("single_arm.yaml"), NoSearch());
  EXPECT_EQ(CheckText(report).find("blocked"), std::string::npos);
  report.reach->arms[0]->joint_speed = {std::numeric_limits<double>::infinity(), 1.5, 2};
  EXPECT_NE(CheckText(report).find("blocked at  1.50 s"), std::string::npos);
}

TEST(Check, AStartOutOfReachIsUnfitAndNoError) {
  const Scenario s = Load("single_arm.yaml", {"device.arms.left.base.xyz=[-2, 0, 0]"});
  const CheckReport report = Check(s, NoSearch());
  EXPECT_FALSE(report.fit());
  EXPECT_EQ(*report.reach->arms[0]->lost, 0);
}

TEST(Check, ScenariosAreInReachWithRoom) {
  for (const char* name :
       {"bar_circle.yaml", "box_18kg.yaml", "box_9kg.yaml", "dual_ur5.yaml", "linear_axis.yaml",
        "mobile_base.yaml", "push.yaml", "put_down_and_pick_up.yaml", "single_arm.yaml",
        "slide_on_table.yaml", "underdamped.yaml"}) {
    const Scenario s = Load(name);
    const Reach reach = DeviceReach(s).Over(TaskPaths(s, StartOfObject(s), kPathStep));
    for (const auto& arm : reach.arms) {
      if (!arm) continue;
      EXPECT_FALSE(arm->lost) << name;
      EXPECT_GT(arm->singular_value.value, 1.5 * kMinSingularValue) << name;
      EXPECT_GT(arm->joint_margin.value, 0.2) << name;
      EXPECT_LT(arm->joint_speed.value, 0.6) << name;
    }
    for (const PairReach& pair : reach.pairs) EXPECT_GT(pair.distance.value, 0.35) << name;
  }
}

TEST(Check, SagIsTheWeightOverTheStiffness) {
  const CheckReport report = Check(Load("single_arm.yaml"), NoSearch());
  EXPECT_NEAR(report.models.sag.z(), -report.models.object_mass * 9.81 / 500, 1e-3);
  EXPECT_NEAR(report.models.sag.head<2>().norm(), 0, 1e-3);
}

TEST(Check, TorqueNearItsLimitWarnsAndBeyondIsRefused) {
  const char* words = "N·m at the cobot's joint panda_joint2";
  EXPECT_FALSE(
      Mentions(Check(Load("box_18kg.yaml"), NoSearch()).warnings, words));  // 107 of 200 N·m
  EXPECT_TRUE(Mentions(
      Check(Load("box_18kg.yaml", {"cobot.effort_limit=[125]"}), NoSearch()).warnings, words));
  EXPECT_THROW(Check(Load("box_18kg.yaml", {"cobot.effort_limit=[87]"}), NoSearch()), InputError);
}

TEST(Check, AFastScriptWarns) {
  const Scenario s = Load("single_arm.yaml", {"operator.script.2.duration=0.9"});
  const CheckReport report = Check(s, NoSearch());
  EXPECT_TRUE(Mentions(report.warnings, "safety.handle_speed"));
}

TEST(Check, StatesThatItDescribesTheObjectOnTheCobot) {
  for (const char* event : {"object_slips", "object_breaks_loose", "release_object"}) {
    const CheckReport report =
        Check(Load("single_arm.yaml",
                   {"events=[{event: brakes_close}, {event: " + std::string(event) + "}]"}),
              NoSearch());
    EXPECT_TRUE(Mentions(report.warnings, std::string("events.1 (") + event + ")"));
    EXPECT_FALSE(Mentions(report.warnings, "events.0"));
  }
}

TEST(Check, AnEventThatCannotBeginWarns) {
  const auto warnings = [](const std::string& trigger) {
    return Check(Load("box_9kg.yaml", {"events=[{event: power_loss, trigger: " + trigger + "}]"}),
                 NoSearch())
        .warnings;
  };
  EXPECT_TRUE(warnings("{after: 29.9}").empty());
  EXPECT_TRUE(Mentions(warnings("{after: 30}"),
                       "events.0 (power_loss) never begins: its trigger.after is 30 s, but the run "
                       "ends at 30 s."));
  // The script moves the object by (0, 0.3, 0.1) m until 9 s, and later back to y = 0.
  EXPECT_TRUE(warnings("{place: {center: [0, 0.3, 0.1], radius: 0.01}}").empty());
  const char* never = "events.0 (power_loss) may never begin";
  EXPECT_TRUE(
      Mentions(warnings("{after: 13, place: {center: [0, 0.3, 0.1], radius: 0.01}}"), never));
  EXPECT_TRUE(Mentions(warnings("{place: {center: [0, 0.3, 5.1], radius: 0.01}}"),
                       "no nearer than 5 m to trigger.place.center"));
  // A person may move the object anywhere.
  EXPECT_FALSE(
      Mentions(Check(Load("box_9kg.yaml",
                          {"operator.type=browser",
                           "events=[{event: power_loss, trigger: {place: {center: [5, 0, 0]}}}]"}),
                     NoSearch())
                   .warnings,
               "events.0"));
}

TEST(Check, AScriptWithoutEffectOrCutShortWarns) {
  EXPECT_TRUE(Check(Load("box_9kg.yaml"), NoSearch()).warnings.empty());
  EXPECT_TRUE(Mentions(Check(Load("box_9kg.yaml", {"operator.script=[]"}), NoSearch()).warnings,
                       "No one grips"));
  EXPECT_TRUE(Mentions(Check(Load("box_9kg.yaml", {"duration=27"}), NoSearch()).warnings,
                       "the operator's script ends at 28.0 s"));
}

TEST(Check, DirectModeHasNoDeviceToJudge) {
  const CheckReport report = Check(Load("box_9kg.yaml", {"mode=direct"}), {});
  EXPECT_TRUE(report.fit());
  EXPECT_FALSE(report.reach || report.stability || report.proposal);
  EXPECT_NE(CheckText(report).find("do not apply"), std::string::npos);
}

TEST(Check, ReportsTheDurationOfAStopIncludingTheArmsLag) {
  const Scenario s = Load("box_9kg.yaml");
  const CheckReport report = Check(s, NoSearch());
  const StopBudget budget = WorstStop(s.safety.handle_speed, 5, 250);
  ASSERT_TRUE(report.stop);
  EXPECT_GT(report.stop->time, budget.time);
  EXPECT_GT(report.stop->way, budget.way);
  EXPECT_GT(report.longest_stop->time, report.stop->time);
  for (const StopBudget& stop : {*report.stop, *report.longest_stop}) {
    const std::string reported =
        Formatted("within %4.0f ms, after at most %.1f mm", 1e3 * stop.time, 1e3 * stop.way);
    EXPECT_NE(CheckText(report).find(reported), std::string::npos) << CheckText(report);
  }
  // A joint with a low deceleration limit lengthens the stop further.
  const CheckReport gentle =
      Check(Load("box_9kg.yaml", {"device.arms.left.acceleration_limit=[1]"}), NoSearch());
  EXPECT_GT(gentle.longest_stop->time, 5 * report.longest_stop->time);
  EXPECT_FALSE(Check(Load("box_9kg.yaml", {"mode=direct"}), {}).stop);
}

// Returns a machine file for the arms of `dual_ur5`, which have not been commissioned.
std::string MachineText() {
  std::string text = "predictor_machine: 1\narms:\n";
  for (const bool left : {true, false})
    text += std::string("  ") + (left ? "left" : "right") + R"(:
    connection: {make: ur, host: 192.0.2.)" +
            (left ? "10" : "11") + R"(}
    arm:
      model: package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf
      base: {xyz: [0.1, )" +
            (left ? "-0.3" : "0.3") + R"(, 0]}
      end_effector: tool0
      handle: {xyz: [0, 0, 0.1], rpy: [3.14159265, 0, 0]}
      posture: [0, -1.2, 1.8, -2.2, -1.57, 0]
      elbow: forearm_link
      sample_rate: 500
)";
  return text;
}

TEST(Check, OnAMachineReportsWhatWasNotCommissioned) {
  Machine machine = ParseMachine(MachineText(), "lab.yaml");
  const auto check = [&] {
    Scenario s = Load("dual_ur5.yaml", {"device.type=real", "operator.type=person"});
    ApplyMachine(machine, &s);
    CheckOptions options = NoSearch();
    options.machine = &machine;
    return Check(s, options);
  };
  const CheckReport guessed = check();
  for (const char* arm : {"left", "right"}) {
    EXPECT_TRUE(
        Mentions(guessed.warnings, std::string("calibrate loop --machine lab.yaml --arm ") + arm));
    EXPECT_TRUE(
        Mentions(guessed.warnings, std::string("calibrate push --machine lab.yaml --arm ") + arm));
  }
  const std::string text = CheckText(guessed);
  EXPECT_NE(text.find("lead 0.0 ms (none, because an arm's loop was not measured)"),
            std::string::npos);
  EXPECT_EQ(text.find("set in the scenario"), std::string::npos) << text;
  EXPECT_TRUE(Mentions(guessed.problems, "First measure the arms' velocity loops")) << text;
  for (std::optional<MachineArm>* arm : {&machine.left, &machine.right}) {
    (*arm)->commissioned.emplace();
    (*arm)->commissioned->of = HashOf(**arm);
    (*arm)->commissioned->loop_of = HashOfLoop(**arm);
  }
  const CheckReport measured = check();
  EXPECT_TRUE(measured.warnings.empty()) << measured.warnings[0];
  EXPECT_NE(CheckText(measured).find("(chosen)"), std::string::npos) << CheckText(measured);
  machine.right->arm.elbow = "nope";
  try {
    check();
    FAIL();
  } catch (const InputError& error) {
    const std::string place = PlaceOf("arms.right.arm.elbow", *machine.tree).Text();
    EXPECT_EQ(place.rfind("lab.yaml:", 0), 0u);
    EXPECT_EQ(std::string(error.what()).rfind(place + ": arms.right.arm.elbow: \"nope\" is", 0), 0u)
        << error.what();
  }
}

TEST(BaseSearch, FindsBetterBasesAndTheSameAgain) {
  const Scenario s = Load("box_9kg.yaml", {"device.arms.left.base.xyz=[0.0, -0.22, -0.3]",
                                           "device.arms.right.base.xyz=[0.0, 0.22, -0.3]"});
  const DeviceReach device(s);
  const auto paths = TaskPaths(s, StartOfObject(s), kPathStep);
  const double now = Comfort(device.Over(paths), s.rendering);
  EXPECT_LT(now, 0);  // outside the workspace
  const BaseProposal proposal = SearchBases(s, device, paths, [](double) {});
  EXPECT_GT(proposal.comfort, 0.9);
  for (const auto& arm : proposal.reach.arms) EXPECT_FALSE(arm->lost);
  const BaseProposal again = SearchBases(s, device, paths, [](double) {});
  EXPECT_EQ(proposal.xyz[0], again.xyz[0]);
  EXPECT_EQ(proposal.xyz[1], again.xyz[1]);
}

// The scene is rotated and lies 0.5 m away from arms that cannot move.
TEST(ShiftSearch, BringsTheSceneToFixedArms) {
  const Scenario s =
      Load("box_9kg.yaml", {"environment.shift={xyz: [0.3, -0.4, 0.1], rpy: [0, 0, 50 deg]}"});
  const CheckReport report = Check(s, {});
  EXPECT_FALSE(report.fit());
  EXPECT_TRUE(Mentions(report.problems, "Change environment.shift, or shorten"));
  EXPECT_FALSE(report.proposal);
  ASSERT_TRUE(report.shift_proposal);
  const ShiftProposal& proposal = *report.shift_proposal;
  EXPECT_GT(proposal.comfort, 0.9);
  EXPECT_EQ(proposal.shift.rpy.head<2>(), Eigen::Vector2d::Zero());
  const std::string text = CheckText(report);
  const std::size_t at = text.find("  environment.shift: {");
  ASSERT_NE(at, std::string::npos) << text;
  // A scenario with the printed `environment.shift` must have the predicted comfort.
  const std::string copied = text.substr(at + 21, text.find('}', at) - at - 20);
  const Scenario moved = Load("box_9kg.yaml", {"environment.shift=" + copied});
  const DeviceReach device(moved);
  EXPECT_NEAR(
      Comfort(device.Over(TaskPaths(moved, StartOfObject(moved), kPathStep)), moved.rendering),
      proposal.comfort, 1e-6);
}

TEST(ShiftSearch, OfTheSameScenarioFindsTheSame) {
  const Scenario s = Load("single_arm.yaml", {"environment.shift={xyz: [0, 0.5, 0]}"});
  const auto paths = TaskPaths(s, StartOfObject(s), 0.1);
  const ShiftProposal a = SearchShift(s, paths, [](double) {});
  const ShiftProposal b = SearchShift(s, paths, [](double) {});
  EXPECT_GT(a.comfort, 0.9);
  EXPECT_EQ(a.shift.xyz, b.shift.xyz);
  EXPECT_EQ(a.shift.rpy, b.shift.rpy);
}

// Returns the exit code and the output of `check --quiet`, which prints only problems.
std::pair<int, std::string> RunCheck(const std::string& arguments) {
  const std::string command =
      std::string(PREDICTOR_BINARY) + " check --no-search --quiet " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string said;
  for (char text[256]; std::fgets(text, sizeof text, pipe);) said += text;
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, said};
}
int ExitCode(const std::string& arguments) { return RunCheck(arguments).first; }

TEST(CheckCommand, ExitCodeMatchesTheFindings) {
  const std::string file = (kScenarios / "single_arm.yaml").string();
  EXPECT_EQ(RunCheck(file), std::pair(0, std::string()));
  const auto [code, said] = RunCheck(file + " --set 'device.arms.left.base.xyz=[-0.6, 0, 0]'");
  EXPECT_EQ(code, 1);
  EXPECT_EQ(said.rfind("Unfit: ", 0), 0u) << said;
  EXPECT_EQ(ExitCode(file + " --set object.primitive.mass=-1"), 2);
  EXPECT_EQ(ExitCode((kScenarios / "no_such.yaml").string()), 2);
}

TEST(CheckCommand, OnAMachineTakesNothingOfTheScenariosDevice) {
  const std::filesystem::path machine =
      std::filesystem::temp_directory_path() / ("check_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(machine) << MachineText();
  const std::string of = (kScenarios / "dual_ur5.yaml").string() + " --machine " + machine.string();
  const auto [code, said] =
      RunCheck(of + " --set operator.type=person --set device.arms.left.elbow=x");
  EXPECT_EQ(code, 2);
  EXPECT_EQ(said.rfind("predictor: error: --set device.arms.left.elbow: with --machine, the arms "
                       "are described by " +
                           machine.string(),
                       0),
            0u)
      << said;
  const auto [virtual_code, virtual_said] = RunCheck(of);
  EXPECT_EQ(virtual_code, 2);
  EXPECT_NE(virtual_said.find("add --set operator.type=person."), std::string::npos)
      << virtual_said;
  std::filesystem::remove(machine);
}

}  // namespace
}  // namespace predictor
