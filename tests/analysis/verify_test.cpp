// Verifies recordings by computing them again.
#include "analysis/verify.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "fakes/bench.h"
#include "recording/provenance.h"
#include "recording/writer.h"
#include "scenario/own_parameters.h"
#include "scenario/scenario_io.h"
#include "simulation/world.h"
#include "support/plugins.h"
#include "support/soak.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

class VerifyTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "verify-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    scenario_ =
        LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml", {"duration=4"});
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Records the scenario with a saved state in every second. `look` may change a record, or drop it
  // by returning false.
  std::string Record(const std::function<bool(TickRecord*)>& look) {
    const std::string file = folder_ / "run.mcap";
    Emulator emulator(scenario_);
    RecordingHeader header = DescribeRun(scenario_, "1", {});
    AddControllerTape(emulator.setup().controller_tape, &header);
    RecordingWriter writer(file, header);
    std::vector<std::byte> state(kStateBytes);
    Simulate(&emulator, scenario_.duration, [&](const TickRecord& tick) {
      TickRecord record = tick;
      if (look(&record)) writer.Add(record);
      if (record.tick % 1000 == 0)
        writer.AddSnapshot(record.tick, std::span(state).first(emulator.SaveState(state)));
    });
    writer.Close();
    return file;
  }
  Verification VerifyFile(const std::string& file) {
    RecordingReader reader(file);
    fs::create_directories(folder_ / "restored");
    return Verify(&reader, RestoreScenario(reader.header(), folder_ / "restored"),
                  [](std::uint64_t) {});
  }

  fs::path folder_;
  Scenario scenario_;
};

TEST_F(VerifyTest, ARunIsTheSameAgain) {
  const Verification result = VerifyFile(Record([](TickRecord*) { return true; }));
  EXPECT_GT(result.ticks, 4000U);
  EXPECT_FALSE(result.departure);
  EXPECT_EQ(result.missing + result.skipped, 0U);
}

// Returns the height of the lowest corner of the box of 0.26 x 0.38 x 0.2 m [m].
double LowestCorner(const PoseRecord& pose) {
  const Pose X_WO = FromRecord(pose);
  double lowest = HUGE_VAL;
  for (const double x : {-0.13, 0.13})
    for (const double y : {-0.19, 0.19})
      for (const double z : {-0.1, 0.1}) lowest = std::min(lowest, (X_WO * Vector3(x, y, z)).z());
  return lowest;
}

// The box hangs above a table, and is lowered onto it and pushed along it.
TEST_F(VerifyTest, ARunWithContactIsTheSameAgain) {
  scenario_ = LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/slide_on_table.yaml",
                           {"duration=8"});
  double highest = -HUGE_VAL, lowest = HUGE_VAL;
  const Verification result = VerifyFile(Record([&](TickRecord* tick) {
    highest = std::max(highest, LowestCorner(tick->object.pose));
    lowest = std::min(lowest, LowestCorner(tick->object.pose));
    return true;
  }));
  EXPECT_GT(result.ticks, 8000U);
  EXPECT_FALSE(result.departure);
  EXPECT_EQ(result.missing + result.skipped, 0U);
  const FixtureSpec& table = scenario_.environment.fixtures[0];
  const double top = table.xyz.z() + table.size.z() / 2;  // [m]
  EXPECT_NEAR(lowest, top, 2e-4);
  EXPECT_GT(highest, top + 0.02);
}

// A cobot whose base has a deck. The hand slides along z, 0.1 m above the middle of the box that it
// carries.
constexpr const char* kCobotWithDeck = R"(<robot name="deck">
<link name="base"><collision><origin xyz="FLANGE_X FLANGE_Y DECK_Z"/><geometry>
<box size="1 1 0.1"/></geometry></collision></link>
<joint name="lift" type="prismatic"><parent link="base"/><child link="hand"/>
<origin xyz="FLANGE_X FLANGE_Y FLANGE_Z"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="5" effort="500"/></joint>
<link name="hand"><inertial><mass value="5"/>
<inertia ixx="0.05" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.05 0.05 0.05"/></geometry></collision></link></robot>)";

// The gripper opens, and the box falls onto the deck.
TEST_F(VerifyTest, ARunInWhichTheObjectTouchesTheCobotIsTheSameAgain) {
  const Vector3 middle = World(scenario_).state().object.X_W.p;  // where the arms reach it
  constexpr double kFall = 0.03;                                 // without the sag [m]
  const double top = middle.z() - 0.1 - kFall;
  std::string urdf = kCobotWithDeck;
  const auto set = [&urdf](const std::string& word, double value) {
    for (std::size_t at; (at = urdf.find(word)) != std::string::npos;)
      urdf.replace(at, word.size(), std::to_string(value));
  };
  set("FLANGE_X", middle.x()), set("FLANGE_Y", middle.y()), set("FLANGE_Z", middle.z() + 0.1);
  set("DECK_Z", top - 0.05);
  std::ofstream(folder_ / "deck.urdf") << urdf;
  std::ofstream(folder_ / "deck.yaml")
      << ReadWholeFile(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
  scenario_ =
      LoadScenario(folder_ / "deck.yaml",
                   {"duration=2", "cobot.model=deck.urdf", "cobot.remove_links=[]",
                    "cobot.end_effector=hand", "cobot.posture=[0 m]", "cobot.touches=[object]",
                    "cobot.controller={type: joint_impedance, joint_stiffness: 5000}",
                    "object.attachment={joint: fixed, on_end_effector: {xyz: [0, 0, -0.1]}}",
                    "operator.script=[]"});
  scenario_.object.model.clear();
  scenario_.object.primitive = PrimitiveSpec{.size = {0.26, 0.38, 0.2}, .mass = 9};
  scenario_.events.emplace_back();
  scenario_.events[0].event = "release_object";
  scenario_.events[0].trigger.after = 0.5;
  double highest = -HUGE_VAL, last = 0;
  const Verification result = VerifyFile(Record([&](TickRecord* tick) {
    last = LowestCorner(tick->object.pose);
    highest = std::max(highest, last);
    return true;
  }));
  EXPECT_GT(result.ticks, 2000U);
  EXPECT_FALSE(result.departure);
  EXPECT_EQ(result.missing + result.skipped, 0U);
  EXPECT_GT(highest, top + kFall / 3);
  EXPECT_NEAR(last, top, 1e-4);
}

// The arms' joints are recorded, and their handles are computed again in the shifted world.
TEST_F(VerifyTest, ARunInAShiftedWorldIsTheSameAgain) {
  scenario_ =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml",
                   {"duration=2", "environment.shift={xyz: [0.01, 0, 0.02], rpy: [0, 0, 3 deg]}"});
  const Verification result = VerifyFile(Record([](TickRecord*) { return true; }));
  EXPECT_GT(result.ticks, 2000U);
  EXPECT_FALSE(result.departure);
}

// Verification uses neither the controller's library nor its program. Verification takes the
// controller's answers from the recording.
TEST_F(VerifyTest, ARunWithAControllerOutsideTheProgramIsTheSameWithoutIt) {
  struct OutsideCase {
    ControllerSpec controller;
    StopCause cause = StopCause::kNone;
  };
  const std::string springs = "joint_stiffness=2000 damping_rate=60";
  OutsideCase cases[] = {{test::Plugin("joint_impedance", springs)},
                         {test::Plugin("following_spring", "stiffness=3000")},
                         {test::PythonExample("joint_stiffness=800 damping_rate=40")},
                         {test::Plugin("at_time", "fault=nan at=1.5"), StopCause::kPhysics}};
  for (OutsideCase& c : cases) {
    test::FindPlugins();
    scenario_.cobot.controller = c.controller;
    scenario_.cobot.control.rate = c.controller.type == "process" ? 500 : 1000;
    scenario_.cobot.control.delay = c.controller.type == "process" ? 0.001 : 0;
    StopCause cause = StopCause::kNone;
    const std::string file = Record([&](TickRecord* record) {
      if (record->state == RunState::kStopping) cause = record->cause;
      return record->tick < 2200 || record->tick > 2300;  // a gap
    });
    EXPECT_EQ(cause, c.cause) << c.controller.type << " " << Name(cause);
    unsetenv("PREDICTOR_PACKAGE_PATH");
    const Verification result = VerifyFile(file);
    EXPECT_FALSE(result.departure)
        << result.departure->field << " at " << result.departure->tick << ": "
        << result.departure->recorded << ", not " << result.departure->computed;
    EXPECT_GT(result.ticks, c.cause == StopCause::kNone ? 3000U : 2000U);
    fs::remove(file);
  }
}

// The run must last two seconds, even if a limit is exceeded.
const std::vector<std::string> kNoStops = {"duration=2",
                                           "safety.force=900",
                                           "safety.torque=99",
                                           "safety.tracking=9",
                                           "safety.tracking_rotation=3.1",
                                           "safety.coupling=9000",
                                           "safety.coupling_torque=9000",
                                           "safety.relative_slack=9",
                                           "safety.relative_slack_rotation=99",
                                           "safety.oscillation.enabled=false"};

// After a gap, the computation continues from a state that was saved while the hazard acted.
TEST_F(VerifyTest, ARunWithAnyHazardIsTheSameAgain) {
  for (const ParameterKind* kind : Hazards()) {
    const std::string name = kind->name;
    SCOPED_TRACE(name);
    const bool picks_up = name == "pick_up" || name == "let_go";
    const bool has_end = name != "object_breaks_loose" && name != "release_object" &&
                         name != "grasp_object" && !picks_up;
    std::string event = "{event: " + name + ", trigger: {after: 0.3, window: 0.2}";
    if (has_end) event += ", duration: 0.7";
    if (name == "object_slips") event += ", slip_force: 60";
    if (name == "obstacle_appears") event += ", fixture: wall";
    if (name == "grasp_object") event += "}, {event: release_object, trigger: {after: 0.1}";
    if (name == "pick_up") event += ", object: brick, grasp_gap: 1";
    if (name == "let_go")
      event += "}, {event: pick_up, object: brick, grasp_gap: 1, trigger: {after: 0.1}";
    std::vector<std::string> set = kNoStops;
    if (picks_up)
      set.emplace_back(
          "environment.objects=[{name: brick, primitive: {size: [0.1, 0.1, 0.1]}, "
          "xyz: [0.46, 0.5, 0.3]}]");
    if (name == "obstacle_appears")
      set.emplace_back(
          "environment.fixtures=[{name: wall, shape: box, size: [0.3, 0.05, 0.5], "
          "xyz: [0.46, 0.4, 0.3]}]");
    set.insert(set.end(),
               {"events=[" + event + "}]",
                "cobot.standby_controller={type: joint_impedance, joint_stiffness: [300]}"});
    if (name.starts_with("sensor_")) set.emplace_back("cobot.controller={type: admittance}");
    scenario_ = LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml", set);
    bool saved_within = false, ended = false;
    const std::string file = Record([&](TickRecord* record) {
      if (record->tick == 2000) saved_within = record->events != 0;
      ended = ended || (record->latest_event != 0 && record->events == 0);
      return record->tick < 1800 || record->tick > 1990;
    });
    const Verification result = VerifyFile(file);
    EXPECT_FALSE(result.departure);
    EXPECT_GT(result.ticks, 2000U);
    EXPECT_TRUE(saved_within);
    EXPECT_EQ(ended, has_end);
    fs::remove(file);
  }
}

TEST_F(VerifyTest, ARecordingWithoutTheAnswersOfItsControllerIsRefused) {
  scenario_.cobot.controller = test::Plugin("joint_impedance", "joint_stiffness=2000");
  RecordingHeader header = DescribeRun(scenario_, "1", {});
  fs::create_directories(folder_ / "restored");
  const Scenario restored = RestoreScenario(header, folder_ / "restored");
  try {
    const Emulator emulator(restored);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("its recorded answers are missing"), std::string::npos)
        << error.what();
  }
}

// The soak test runs each scenario to its end. If a scenario ends in a stop, both tests run it
// until this stop.
TEST_F(VerifyTest, EveryScenarioIsTheSameAgainSoak) {
  int scenarios = 0;
  for (const auto& entry :
       fs::directory_iterator(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios")) {
    if (entry.path().extension() != ".yaml") continue;
    scenario_ = LoadScenario(entry.path());
    const bool stops = entry.path().stem() == "push" || entry.path().stem() == "underdamped";
    const long most = stops ? 1000 : Count(3, 1000);
    if (scenario_.duration == 0) scenario_.duration = 20;  // otherwise, a visitor ends it
    scenario_.duration = std::min<double>(scenario_.duration, static_cast<double>(most));
    bool stopped = false;
    const Verification result = VerifyFile(Record([&](TickRecord* record) {
      stopped = stopped || record->cause != StopCause::kNone;
      return true;
    }));
    EXPECT_FALSE(result.departure) << entry.path();
    EXPECT_EQ(stopped, stops) << entry.path();
    EXPECT_GT(result.ticks, 2000U) << entry.path();
    fs::remove(folder_ / "run.mcap");
    ++scenarios;
  }
  EXPECT_GE(scenarios, 8);
}

TEST_F(VerifyTest, TheLastBitOfOneNumberIsFound) {
  const Verification result = VerifyFile(Record([](TickRecord* record) {
    if (record->tick == 3210) record->cobot_q[2] = std::nextafter(record->cobot_q[2], 1e9);
    return true;
  }));
  ASSERT_TRUE(result.departure);
  EXPECT_EQ(result.departure->tick, 3210U);
  EXPECT_EQ(result.departure->field, "cobot.q[2]");
  EXPECT_NE(result.departure->recorded, result.departure->computed);
}

// If a record contains an input that no one gave, the computed run differs from the recorded one.
TEST_F(VerifyTest, AnInputThatWasNotGivenIsFound) {
  const Verification result = VerifyFile(Record([](TickRecord* record) {
    if (record->tick == 2500) {
      record->input_count = 1;
      record->inputs[0].kind = InputKind::kParameter;
      record->inputs[0].parameter = Parameter::kDampingRatio;
      record->inputs[0].value = 0.8;
    }
    return true;
  }));
  ASSERT_TRUE(result.departure);
  EXPECT_GE(result.departure->tick, 2500U);
  EXPECT_LE(result.departure->tick, 2503U);
}

TEST_F(VerifyTest, AfterAGapItContinuesFromTheNextState) {
  const Verification result = VerifyFile(
      Record([](TickRecord* record) { return record->tick < 1500 || record->tick >= 1600; }));
  EXPECT_FALSE(result.departure);
  EXPECT_EQ(result.missing, 100U);
  EXPECT_EQ(result.skipped, 401U);  // up to tick 2000, which has a saved state
  EXPECT_GT(result.ticks, 3000U);
}

// ---- real arms: simulated by fakes on a network in virtual time --------------------------------

class VerifyRealArms : public VerifyTest {
 protected:
  struct Case {
    std::string scenario;
    std::array<std::string, kHands> arms, sensors;
  };

  // Records a run that a person starts. `fault` is applied after 1.5 s. If the run is in HELD 2 s
  // later, it is reset. `look` works as in Record.
  std::string RecordBench(const Case& what, const std::function<void(Bench&)>& fault,
                          const std::function<bool(TickRecord*)>& look) {
    BenchOptions options;
    options.scenario = std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + what.scenario + ".yaml";
    options.arms = what.arms;
    options.sensors = what.sensors;
    Bench bench(options);
    const std::string file = folder_ / "run.mcap";
    RecordingWriter writer(file, DescribeRun(bench.emulator().scenario(), "1", {}));
    std::vector<std::byte> state(kStateBytes);
    last_ = {};
    bench.Watch([&](const TickRecord& tick) {
      TickRecord record = tick;
      if (look(&record)) writer.Add(record);
      if (record.tick % 1000 == 0)
        writer.AddSnapshot(record.tick, std::span(state).first(bench.emulator().SaveState(state)));
      stopped_ = stopped_ || record.cause != StopCause::kNone;
      last_ = record;
    });
    EXPECT_TRUE(bench.Start());
    bench.Pass(1.5);
    fault(bench);
    bench.Pass(2);
    if (bench.emulator().state() == RunState::kHeld) bench.emulator().Request(RunEvent::kReset);
    bench.Pass(0.5);
    writer.Close();
    return file;
  }

  TickRecord last_;
  bool stopped_ = false;
};

const std::function<bool(TickRecord*)> kAll = [](TickRecord*) { return true; };

TEST_F(VerifyRealArms, TheRunIsTheSameAgainWithoutThem) {
  const std::vector<Case> cases = {{"dual_ur5", {"ur", "ur"}, {}},
                                   {"box_9kg", {"franka", "franka"}, {}},
                                   {"ur_and_panda", {"ur", "franka"}, {"net_ft", ""}}};
  for (const Case& what : cases) {
    const Verification result = VerifyFile(RecordBench(
        what, [](Bench&) {}, kAll));
    ASSERT_FALSE(result.departure)
        << what.scenario << ": tick " << result.departure->tick << ", " << result.departure->field;
    EXPECT_EQ(result.ticks, last_.tick) << what.scenario;
    EXPECT_EQ(result.missing + result.skipped, 0U);
    EXPECT_EQ(last_.state, RunState::kRun) << what.scenario;
    EXPECT_FALSE(stopped_) << what.scenario;
    fs::remove(folder_ / "run.mcap");
  }
}

// The recording also contains the reports of the arms, which are faults, stops without power, a
// released key, late samples, and NaN.
TEST_F(VerifyRealArms, SoAreItsStops) {
  const std::vector<std::pair<const char*, std::function<void(Bench&)>>> faults = {
      {"silent", [](Bench& b) { b.wire(0).silent = true; }},
      {"protective stop", [](Bench& b) { b.arm(1).Do("protective stop"); }},
      {"emergency stop", [](Bench& b) { b.arm(0).Do("emergency stop"); }},
      {"not a number", [](Bench& b) { b.arm(1).Do("not a number"); }},
      {"let go", [](Bench& b) { b.Hold(false); }},
      {"late", [](Bench& b) { b.Tick(3); }}};
  for (const auto& [name, fault] : faults) {
    stopped_ = false;
    const Verification result =
        VerifyFile(RecordBench({"dual_ur5", {"ur", "ur"}, {}}, fault, kAll));
    ASSERT_FALSE(result.departure)
        << name << ": tick " << result.departure->tick << ", " << result.departure->field << " is "
        << result.departure->recorded << " and " << result.departure->computed;
    EXPECT_EQ(result.ticks, last_.tick) << name;
    EXPECT_TRUE(stopped_) << name;
    fs::remove(folder_ / "run.mcap");
  }
}

TEST_F(VerifyRealArms, ChangesInTheRecordingAreFound) {
  const Case what = {"dual_ur5", {"ur", "ur"}, {}};
  const auto run = [&](const std::function<void(TickRecord*)>& change) {
    const Verification result = VerifyFile(RecordBench(
        what, [](Bench&) {},
        [&](TickRecord* record) {
          if (record->state == RunState::kRun && record->tick == 5000) change(record);
          return true;
        }));
    fs::remove(folder_ / "run.mcap");
    EXPECT_TRUE(result.departure);
    return result.departure.value_or(Departure{});
  };
  // Verification must find the departure if the last digit of a computed value, or of an arm's or
  // sensor's reading, has changed.
  const Departure command = run(
      [](TickRecord* r) { r->hands[1].command[3] = std::nextafter(r->hands[1].command[3], 9.0); });
  EXPECT_EQ(command.tick, 5000U);
  EXPECT_EQ(command.field, "hands.right.command[3]");
  const Departure joint =
      run([](TickRecord* r) { r->hands[0].q[1] = std::nextafter(r->hands[0].q[1], 9.0); });
  EXPECT_EQ(joint.tick, 5000U);
  EXPECT_TRUE(joint.field.starts_with("hands.left.")) << joint.field;
  const Departure force =
      run([](TickRecord* r) { r->hands[0].wrench_raw[2] = r->hands[0].wrench_raw[2] + 1e-6; });
  EXPECT_EQ(force.tick, 5000U);
  EXPECT_TRUE(force.field.starts_with("hands.left.wrench.")) << force.field;
  const Departure status =
      run([](TickRecord* r) { r->read = {StopCause::kDevice, 0, {}, 0, {}, 0, 0}; });
  EXPECT_EQ(status.tick, 5000U);
}

TEST_F(VerifyRealArms, AfterAGapItContinuesFromTheNextState) {
  const Verification result = VerifyFile(RecordBench(
      {"dual_ur5", {"ur", "ur"}, {}}, [](Bench&) {},
      [](TickRecord* record) { return record->tick < 4500 || record->tick >= 4600; }));
  EXPECT_FALSE(result.departure);
  EXPECT_EQ(result.missing, 100U);
  EXPECT_EQ(result.skipped, 401U);
}

// The saved state must include the cause that removed the power at the end of a stop, even if the
// stop itself is missing from the recording.
TEST_F(VerifyRealArms, AfterAGapWithPowerOffItContinues) {
  const auto fault = [](Bench& b) {
    b.Hold(false);
    b.Pass(0.15);
    b.wire(0).silent = true;
  };
  int lost = 0;
  const Verification result =
      VerifyFile(RecordBench({"dual_ur5", {"ur", "ur"}, {}}, fault, [&lost](TickRecord* record) {
        return record->cause == StopCause::kNone || ++lost > 300;
      }));
  ASSERT_FALSE(result.departure) << result.departure->field;
  EXPECT_EQ(result.missing, 300U);
  EXPECT_GT(result.ticks, 1000U);
  EXPECT_EQ(last_.state, RunState::kUnpowered);
  EXPECT_EQ(last_.cause, StopCause::kEnabling);
  EXPECT_EQ(last_.harder.cause, StopCause::kStale);
  EXPECT_EQ(last_.harder.power_off, 1);
}

}  // namespace
}  // namespace predictor
