// When people work normally with the real drivers, the program must neither warn nor stop. The
// detector of handles that run away monitors real sensors only, so a simulated rig cannot test
// this.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/format.h"
#include "devices/fault_bring.h"
#include "scenario/scenario_io.h"
#include "support/soak.h"

namespace predictor {
namespace {

// One hand or both hands push suddenly while they carry the box slowly. The pushes are so rare that
// they do not count as an oscillation.
void PushWhileCarrying(Scenario* s) {
  RandomStream random(s->seed, "pushes");
  std::vector<ActionSpec> script = {MakeActionSpec("grip", 0, {"duration=0.5"})};
  double at = 1;
  for (const char* hand : {"both", "left", "right"}) {
    script.push_back(
        MakeActionSpec("move", at, {"duration=4", at < 5 ? "by=[0, 0.2, 0]" : "by=[0, -0.1, 0]"}));
    const double start = at + 1 + 2 * random.Uniform();
    Vector3 force(random.Normal(), random.Normal(), random.Normal());
    force *= (10 + 6 * random.Uniform()) / force.norm();
    script.push_back(
        MakeActionSpec("push", start,
                       {"duration=0.3", std::string("hand=") + hand,
                        Formatted("force=[%.17g, %.17g, %.17g]", force.x(), force.y(), force.z()),
                        Formatted("rise_time=%.17g", 0.05 + 0.10 * random.Uniform())}));
    at += 5;
  }
  s->operator_.script = script;
  s->duration = at + 0.5;
}

// The bar is longer than the box, so the UR's bases are farther apart.
void CircleOnUr(Scenario* s) {
  const Scenario bar = LoadScenario(PREDICTOR_SOURCE_DIR "/scenarios/bar_circle.yaml", {});
  s->object = bar.object;
  s->left_handle = bar.left_handle;
  s->right_handle = bar.right_handle;
  s->operator_.script = bar.operator_.script;
  s->duration = bar.duration;
  s->device.left->base.xyz = {0.1, -0.4, 0.05};
  s->device.right->base.xyz = {0.1, 0.4, 0.05};
}

// A UR of the CB series runs at 125 Hz and has no built-in sensor.
void BeCb3(Machine* machine) {
  for (std::optional<MachineArm>* side : {&machine->left, &machine->right}) {
    ArmSpec& arm = (*side)->arm;
    arm.loop.delay += 1.0 / 125 - 1 / arm.sample_rate;
    arm.sample_rate = 125;
  }
}
void BeOnRobot(Machine* machine) {
  for (std::optional<MachineArm>* side : {&machine->left, &machine->right}) {
    SensorConnection& sensor = (*side)->sensor;
    if (sensor.make == SensorMake::kOwn) continue;
    sensor.make = SensorMake::kOnRobot;
    sensor.counts_per_force = 1e4;
    sensor.counts_per_torque = 1e5;
  }
}

struct Work {
  const char* name;
  const char* kind;  // of both arms
  const char* scenario;
  void (*change)(Scenario*);
  double busy;  // if the largest force is lower [N], the person does not work
  // By default, an arm is a UR of the e-Series or a Research 3. The left hand uses the arm's own
  // sensor, and the right hand uses a Net F/T.
  FakeOptions arm = {};
  std::array<const char*, kHands> sensors = {"", "net_ft"};
  FakeOptions sensor = {};
  void (*machine)(Machine*) = nullptr;
  const char* device = "";  // part of the device's description
};

class NormalWork : public testing::TestWithParam<Work> {};

// Returns the largest measured force on a hand in the whole run. `reported` receives the messages
// if there is a problem.
double GreatestForce(const Work& work, std::uint64_t seed, std::string* reported) {
  BenchOptions options;
  options.scenario = PREDICTOR_SOURCE_DIR "/scenarios/" + std::string(work.scenario) + ".yaml";
  for (std::size_t i = 0; i < kHands; ++i) {
    options.arms[i] = work.kind;
    options.arm_options[i] = work.arm;
    options.sensors[i] = work.sensors[i];
    options.sensor_options[i] = work.sensor;
  }
  options.machine = work.machine;
  options.seed = seed;
  options.change = work.change;
  Bench bench(options);
  EXPECT_NE(bench.device().Describe().find(work.device), std::string::npos)
      << bench.device().Describe();
  if (!bench.Start()) return *reported = "no run: " + Messages(bench), 0;
  double force = 0;
  std::uint8_t warnings = 0;
  bench.Watch([&](const TickRecord& record) {
    for (const HandRecord& hand : record.hands) {
      force = std::max(force, Eigen::Map<const Vector3>(hand.wrench.data()).norm());
      warnings = static_cast<std::uint8_t>(warnings | hand.warnings);
      if (warnings != 0 && reported->empty()) *reported = Messages(bench);
    }
  });
  const double duration = bench.scenario().duration;
  while (bench.record().run_time < duration && bench.emulator().state() == RunState::kRun)
    bench.Tick();
  if (bench.emulator().state() != RunState::kRun)
    *reported = std::to_string(bench.record().run_time) + " s: " + Messages(bench);
  return force;
}

TEST_P(NormalWork, RaisesNoAlarmOnRealArmsSoak) {
  const Work& work = GetParam();
  for (long seed = 1; seed <= Count(1, 20); ++seed) {
    std::string reported;
    const double force = GreatestForce(work, static_cast<std::uint64_t>(seed), &reported);
    EXPECT_EQ(reported, "") << work.name << ", seed " << seed << ", up to " << force << " N";
    EXPECT_GT(force, work.busy) << work.name << ", seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Arms, NormalWork,
    testing::Values(Work{"BoxOnUr", "ur", "dual_ur5", nullptr, 5},
                    Work{"CircleOnUr", "ur", "dual_ur5", CircleOnUr, 2},
                    Work{"PushesOnUr", "ur", "dual_ur5", PushWhileCarrying, 9},
                    Work{"BoxOnFranka", "franka", "box_9kg", nullptr, 5},
                    Work{"CircleOnFranka", "franka", "bar_circle", nullptr, 2},
                    Work{"PushesOnFranka", "franka", "box_9kg", PushWhileCarrying, 9},
                    Work{"BoxOnCb3",
                         "ur",
                         "dual_ur5",
                         nullptr,
                         5,
                         {{"cb3", ""}},
                         {"net_ft", "net_ft"},
                         {},
                         BeCb3,
                         "Universal Robots CB3"},
                    Work{"BoxOnPanda",
                         "franka",
                         "box_9kg",
                         nullptr,
                         5,
                         {{"panda", ""}},
                         {"", "net_ft"},
                         {},
                         nullptr,
                         "Franka Panda"},
                    Work{"BoxByOnRobot",
                         "ur",
                         "dual_ur5",
                         nullptr,
                         5,
                         {},
                         {"net_ft", "net_ft"},
                         {{"onrobot", ""}},
                         BeOnRobot,
                         "OnRobot F/T"}),
    [](const testing::TestParamInfo<Work>& work) { return std::string(work.param.name); });

}  // namespace
}  // namespace predictor
