// Tests controllers outside the program: shared libraries and processes.
#include <gtest/gtest.h>
#include <predictor/controller.h>
#include <sched.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/archive.h"
#include "core/error.h"
#include "core/real_time.h"
#include "scenario/trial_note.h"
#include "support/plugins.h"
#include "support/temporary_folder.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

using test::Plugin;
using test::PythonExample;

// Returns a Panda with a ball of 1 kg in its flange.
Scenario BallScene(const ControllerSpec& controller) {
  Scenario s = BoxScene(1);
  s.object.attachment.joint = JointType::kFixed;
  s.cobot.controller = controller;
  return s;
}

ControllerSpec BuiltIn(const std::string& type, const std::vector<std::string>& parameters) {
  ControllerSpec spec{type, {}};
  for (const std::string& p : parameters) spec.Set(p);
  return spec;
}

// Returns a controller process that has the fault `fault` from the time `at` [s] on.
ControllerSpec Faulty(const std::string& fault, double at = 0.05) {
  return test::ProcessOf("[python3, " + std::string(PREDICTOR_SOURCE_DIR) +
                         "/tests/plugins/process.py, \"" + fault + "\", \"" + std::to_string(at) +
                         "\"]");
}

// Compares the states of two worlds after every step of a push.
void ExpectSameMotion(const Scenario& a, const Scenario& b, double duration) {
  World first(a), second(b);
  for (int k = 0; k < std::lround(duration / kTick); ++k) {
    const Vector3 force(0, k < 200 ? 6 : 0, -2);
    ASSERT_TRUE(first.Step(Push(a, force), kTick).ok());
    ASSERT_TRUE(second.Step(Push(b, force), kTick).ok());
    ASSERT_EQ(first.state().torque, second.state().torque) << k;
    ASSERT_EQ(first.state().q, second.state().q) << k;
    ASSERT_EQ(first.state().v, second.state().v) << k;
  }
}

TEST(Plugin, IsBitIdenticalToTheBuiltInController) {
  const auto built_in =
      BuiltIn("joint_impedance", {"joint_stiffness=300", "joint_damping_ratio=0"});
  Scenario a = BallScene(built_in);
  Scenario b = BallScene(Plugin("joint_impedance", "joint_stiffness=300 damping_rate=0"));
  ExpectSameMotion(a, b, 0.5);
  for (Scenario* s : {&a, &b}) {
    s->cobot.control.rate = 500;
    s->cobot.control.delay = 0.002;
    s->cobot.joint_friction.viscous = {5};
  }
  ExpectSameMotion(a, b, 0.5);
}

TEST(Plugin, AProcessInPythonIsBitIdenticalToTheOneInC) {
  const std::string parameters = "joint_stiffness=300 damping_rate=40";
  ExpectSameMotion(BallScene(Plugin("joint_impedance", parameters)),
                   BallScene(PythonExample(parameters)), 0.3);
}

Quaternion ObjectInE(const World& world) {
  return world.state().end_effector.X_W.q.conjugate() * world.state().object.X_W.q;
}

// The controllers in this test answer with the pose that they receive. This pose must be the pose
// before the step, even if the object rotates in a spherical attachment.
TEST(Plugin, SeesThePoseOfTheObject) {
  for (const ControllerSpec& controller :
       {Plugin("at_time", "fault=object at=0.05"), Faulty("object")}) {
    Scenario s = BallScene(controller);
    s.object.attachment.joint = JointType::kSpherical;
    World world(s);
    const Quaternion at_start = ObjectInE(world);
    Simulate(&world, Push(s, {0, 3, 0}), 0.051);
    const Pose X_WO = world.state().object.X_W;
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    const JointVector& seen = world.state().torque;
    EXPECT_EQ(Vector3(seen.head<3>()), X_WO.p) << controller.type;
    const Quaternion q(seen[3], seen[4], seen[5], seen[6]);
    EXPECT_EQ(q.coeffs(), X_WO.q.coeffs()) << controller.type;
    EXPECT_GT(RotationError(ObjectInE(world), at_start).norm(), 1e-3);
  }
}

// This controller answers with the first seven numbers of h, J or M.
TEST(Plugin, GetsWhatItReadsAndZerosOtherwise) {
  const auto seen = [](const char* member, unsigned reads) {
    const std::string answer = std::string("fault=") + member + " at=0.05 reads=";
    const Scenario s = BallScene(Plugin("at_time", answer + std::to_string(reads)));
    World world(s);
    Simulate(&world, Push(s, {0, 3, 0}), 0.051);
    EXPECT_TRUE(world.Step(HandsOff(s), kTick).ok());
    return JointVector(world.state().torque);
  };
  for (const auto& [member, bit] :
       {std::pair("h", PREDICTOR_READS_H), std::pair("J", PREDICTOR_READS_J),
        std::pair("M", PREDICTOR_READS_M)}) {
    const JointVector all = seen(member, PREDICTOR_READS_ALL);
    EXPECT_GT(all.norm(), 0.01) << member;
    EXPECT_EQ(seen(member, bit), all) << member;
    EXPECT_EQ(seen(member, PREDICTOR_READS_ALL - bit), JointVector::Zero(7)) << member;
  }
}

TEST(Plugin, HasTheEnergyOfTheBuiltInController) {
  const auto built_in =
      BuiltIn("joint_impedance", {"joint_stiffness=300", "joint_damping_ratio=0"});
  World a(BallScene(built_in)),
      b(BallScene(Plugin("joint_impedance", "joint_stiffness=300 damping_rate=0")));
  EXPECT_NEAR(a.state().energy, b.state().energy, 1e-12);
  EXPECT_TRUE(a.ControllerTape().empty());
  EXPECT_FALSE(b.ControllerTape().empty());
}

// ---- memory
// --------------------------------------------------------------------------------------

TEST(Plugin, YieldsToTheHandByItsMemory) {
  const Scenario s = BallScene(Plugin("following_spring", "stiffness=400 yielding=0.02"));
  World world(s);
  const Vector3 start = world.state().end_effector.X_W.p;
  Simulate(&world, HandsOff(s), 0.5);
  EXPECT_LT((world.state().end_effector.X_W.p - start).norm(), 1e-6);
  Simulate(&world, Push(s, {0, 4, 0}), 1);
  const double moved = world.state().end_effector.X_W.p.y() - start.y();
  EXPECT_GT(moved, 0.02);
  World again(s);
  Simulate(&again, Push(s, {0, 4, 0}), 0.7);
  again.Reset();
  Simulate(&again, HandsOff(s), 0.5);
  Simulate(&again, Push(s, {0, 4, 0}), 1);
  EXPECT_EQ(again.state().q, world.state().q);
}

TEST(Plugin, KeepsItsMemoryInTheSavedState) {
  const Scenario s = BallScene(Plugin("following_spring"));
  World a(s), b(s);
  Simulate(&a, Push(s, {0, 4, 0}), 0.333);
  std::vector<std::byte> bytes(1 << 16);
  StateArchive save = StateArchive::ToSave(bytes);
  a.Archive(save);
  ASSERT_TRUE(save.ok());
  StateArchive load = StateArchive::ToLoad(std::span(bytes).first(save.used()));
  b.Archive(load);
  ASSERT_TRUE(load.ok());
  Simulate(&a, Push(s, {3, 0, 0}), 0.3);
  Simulate(&b, Push(s, {3, 0, 0}), 0.3);
  EXPECT_EQ(a.state().torque, b.state().torque);
  // A controller with a different memory must not accept the state.
  World other(BallScene(Plugin("joint_impedance")));
  StateArchive wrong = StateArchive::ToLoad(std::span(bytes).first(save.used()));
  other.Archive(wrong);
  EXPECT_FALSE(wrong.ok() && wrong.used() == save.used());
}

// ---- errors at loading
// ---------------------------------------------------------------------------

std::string ErrorOf(const Scenario& s) {
  try {
    const World world(s);
  } catch (const InputError& error) {
    return error.key() + "|" + error.what();
  }
  return "";
}

void ExpectError(const ControllerSpec& controller, const std::string& key,
                 const std::string& part) {
  const std::string error = ErrorOf(BallScene(controller));
  EXPECT_EQ(error.rfind(key + "|", 0), 0u) << error;
  EXPECT_NE(error.find(part), std::string::npos) << error;
}

TEST(Plugin, WhatDoesNotFitIsRefusedWithPlaceAndRemedy) {
  const std::string key = "cobot.controller.library";
  ExpectError(Plugin("joint_impedence"), key, "Did you mean joint_impedance.so?");
  ExpectError(Plugin("no_symbol"), key, "does not export predictor_controller. Define");
  ExpectError(Plugin("no_table"), key, "returns NULL from predictor_controller");
  ExpectError(Plugin("no_compute"), key, "lacks create, destroy or compute");
  ExpectError(Plugin("version"), key, "has version 4 of the controller interface");
  ExpectError(Plugin("long_memory"), key,
              "has a memory of 129 numbers; it must have from 0 to 128");
  ExpectError(Plugin("joint_impedance", "5"), "cobot.controller.parameters",
              "Write each parameter as key=value");
  const test::TemporaryFolder folder;
  std::ofstream(folder / "text.so") << "no library";
  Scenario s = BallScene({"plugin", {}});
  s.file = folder / "scenario.yaml";
  s.cobot.controller.Set("library=text.so");
  EXPECT_NE(ErrorOf(s).find("could not be loaded"), std::string::npos) << ErrorOf(s);
}

TEST(Plugin, WithTheWrongNumberOfJointsIsRefused) {
  Scenario s = BallScene(Plugin("at_time"));
  s.cobot.model = "package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf";
  s.cobot.remove_links = {};
  s.cobot.end_effector = "tool0";
  s.cobot.posture = {0, -1.5, 1.5, 0, 0, 0};
  EXPECT_NE(ErrorOf(s).find("refuses this scenario. It is for 7 joints, not 6."), std::string::npos)
      << ErrorOf(s);
}

TEST(Plugin, AProcessThatDoesNotFitIsRefusedWithPlaceAndRemedy) {
  const std::string key = "cobot.controller.command";
  ExpectError(test::ProcessOf("[no_such_program]"), key, "could not be started");
  ExpectError(Faulty("ends"), key, "ended before it answered (exit code 7)");
  ExpectError(Faulty("refuses"), key, "refuses this scenario. Not for today");
  ExpectError(Faulty("nan", 0), "cobot.controller", "its program does not answer, or its torques");
}

// The examples state which parameter or value is wrong, where, and what to write instead.
TEST(Plugin, ABadParameterOfAnExampleIsRefusedWithPlaceAndRemedy) {
  const std::string library = "cobot.controller.library", command = "cobot.controller.command",
                    place = "refuses this scenario. In cobot.controller.parameters, ";
  const std::string unknown =
      place + "\"rigidity\" is not one of its parameters. Use joint_stiffness or damping_rate.";
  ExpectError(Plugin("joint_impedance", "rigidity=5"), library, unknown);
  ExpectError(PythonExample("rigidity=5"), command, unknown);
  for (const char* value : {"abc", "5x", "-1", "inf", "nan"}) {
    const std::string wrong = place + "joint_stiffness is \"" + value +
                              "\". Give a finite number from 0, such as joint_stiffness=100.";
    ExpectError(Plugin("joint_impedance", std::string("joint_stiffness=") + value), library, wrong);
    ExpectError(PythonExample(std::string("joint_stiffness=") + value), command, wrong);
    ExpectError(Plugin("following_spring", std::string("yielding=") + value), library,
                place + "yielding is \"" + value + "\". Give a finite number from 0.");
  }
  ExpectError(Plugin("following_spring", "rigidity=5"), library,
              place + "\"rigidity\" is not one of its parameters. Use stiffness or yielding.");
}

// The result of a trial applies only to a library with exactly these bytes, and to the same
// parameters.
TEST(Plugin, IsRefusedWithRealArmsUnlessItHasPassedItsTrial) {
  test::FindPlugins();
  const test::TemporaryFolder folder;
  const std::filesystem::path mine = folder / "mine.so";
  std::filesystem::copy_file(
      std::filesystem::path(std::getenv("PREDICTOR_PACKAGE_PATH")) / "joint_impedance.so", mine);
  Scenario s = BallScene({"plugin", {}});
  s.file = folder / "scenario.yaml";
  s.cobot.controller.Set("library=mine.so");
  EXPECT_EQ(ErrorOf(s), "");
  s.device.type = "real";
  const std::string refusal = "mine.so would run as part of the control loop";
  EXPECT_NE(ErrorOf(s).find(refusal), std::string::npos) << ErrorOf(s);
  NoteTrial(mine, "", true);
  EXPECT_EQ(ErrorOf(s), "");
  s.cobot.controller.Set("parameters=damping_rate=30");
  EXPECT_NE(ErrorOf(s).find(refusal), std::string::npos) << ErrorOf(s);
  NoteTrial(mine, "damping_rate=30", true);
  EXPECT_EQ(ErrorOf(s), "");
  s.cobot.controller.Set("parameters=damping_rate=31");
  EXPECT_NE(ErrorOf(s).find(refusal), std::string::npos) << ErrorOf(s);
  s.cobot.controller.Set("parameters=damping_rate=30");
  std::ofstream(mine, std::ios::app) << "\n";
  EXPECT_NE(ErrorOf(s).find(refusal), std::string::npos) << ErrorOf(s);
  s.cobot.controller = PythonExample();
  EXPECT_EQ(ErrorOf(s), "");
}

// ---- faults during a run
// -------------------------------------------------------------------------

// Returns the status of the step that fails.
Status FirstFailure(const Scenario& s, World* world) {
  for (int k = 0; k < 200; ++k) {
    const Status status = world->Step(HandsOff(s), kTick);
    if (status.ok()) continue;
    EXPECT_NEAR(world->state().time, 0.05, 2 * kTick);
    return status;
  }
  return Status::Ok();
}

TEST(Plugin, TorquesThatAreNotFiniteAreRefused) {
  for (const ControllerSpec& controller : {Plugin("at_time", "fault=nan at=0.05"), Faulty("nan")}) {
    const Scenario s = BallScene(controller);
    World world(s);
    const Status status = FirstFailure(s, &world);
    EXPECT_EQ(status.cause, StopCause::kPhysics);
    EXPECT_EQ(status.quantity, Quantity::kCount);
    EXPECT_EQ(status.value, controller.type == "plugin" ? 2 : 1);
    EXPECT_EQ(world.state().controller, ControllerOutcome::kFailed);
    EXPECT_TRUE(world.state().q.allFinite());
    world.Reset();
    EXPECT_EQ(world.state().controller, ControllerOutcome::kComputed);
    EXPECT_TRUE(world.Step(HandsOff(s), kTick).ok());
  }
}

TEST(Plugin, AStepInWhichALibraryAllocatesIsRefused) {
  const Scenario s = BallScene(Plugin("at_time", "fault=allocate at=0.05"));
  World world(s);
  const Status status = FirstFailure(s, &world);
  EXPECT_EQ(status.cause, StopCause::kPhysics);
  EXPECT_EQ(status.quantity, Quantity::kAllocations);
  EXPECT_EQ(status.value, 2);  // one malloc and one free
  EXPECT_EQ(world.state().controller, ControllerOutcome::kFailed);
  world.Reset();
  EXPECT_TRUE(world.Step(HandsOff(s), kTick).ok());
}

// The first call of a function often prepares something.
TEST(Plugin, ALibraryMayAllocateWhileTheSceneIsSetUp) {
  const Scenario s = BallScene(Plugin("at_time", "fault=allocate_once"));
  World world(s);
  for (int k = 0; k < 60; ++k) ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
}

// If the process could shorten the shared memory, the control loop would end with a bus error.
TEST(Plugin, AProcessCannotShortenTheSharedMemory) {
  World world(BallScene(Faulty("shorten")));
  const double limit = world.effort_limit()[0];
  for (int k = 0; k < 60; ++k)
    ASSERT_TRUE(world.Step(HandsOff(BallScene(Faulty("nan"))), kTick).ok());
  EXPECT_EQ(world.state().torque[0], limit);
}

TEST(Plugin, AProcessThatCrashesIsNoticed) {
  const Scenario s = BallScene(Faulty("crash"));
  World world(s);
  const Status status = FirstFailure(s, &world);
  EXPECT_EQ(status.cause, StopCause::kPhysics);
  EXPECT_EQ(status.quantity, Quantity::kTime);
  EXPECT_EQ(world.state().controller, ControllerOutcome::kFailed);
}

// In real time, the controller's process has a deadline for its answer. Gravity compensation and
// damping must act until the process answers again. After 0.1 s without an answer, the world must
// refuse the step.
TEST(Plugin, AProcessThatMissesItsDeadlineIsReplacedAndThenStopped) {
  for (const bool hangs : {false, true}) {
    Scenario s = BallScene(Faulty(hangs ? "hang" : "late"));
    s.cobot.controller.Set("deadline=9e-4");  // the computer may be busy
    World world(s);
    world.SetRealTime(true);
    int fell_back = 0;
    Status status;
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < 400 && status.ok(); ++k) {
      std::this_thread::sleep_until(start + k * std::chrono::milliseconds(1));
      status = world.Step(HandsOff(s), kTick);
      if (status.ok() && world.state().controller == ControllerOutcome::kFellBack) ++fell_back;
    }
    EXPECT_GE(fell_back, 15);
    EXPECT_EQ(status.ok(), !hangs);
    if (hangs) {
      EXPECT_EQ(status.quantity, Quantity::kTime);
      EXPECT_GE(status.value, 0.1);
      EXPECT_EQ(status.limit, 0.1);
    }
  }
}

// ---- priority
// --------------------------------------------------------------------------------------------

// Returns whether the system permits this process to use this real-time priority.
bool MayUse(int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameter) != 0) return false;
  parameter.sched_priority = 0;
  return sched_setscheduler(0, SCHED_OTHER, &parameter) == 0;
}

// The process answers with its scheduling policy and its priority. If the system does not permit a
// real-time priority, the process must keep the ordinary one.
TEST(Plugin, AProcessGetsAPriorityBelowTheLoopsIfItAsksForIt) {
  for (const bool asks : {false, true}) {
    Scenario s = BallScene(Faulty("priority", 0.01));
    s.cobot.controller.Set(asks ? "real_time_priority=true" : "real_time_priority=false");
    World world(s);
    const auto seen = [&] {
      Simulate(&world, HandsOff(s), 0.02);
      return std::pair(world.state().torque[0], world.state().torque[1]);
    };
    const std::string got = world.PrioritiseProcess(true);
    const bool granted = asks && MayUse(kControllerPriority);
    EXPECT_EQ(got, granted ? "controller's process: granted (SCHED_FIFO 70)"
                   : asks  ? "controller's process: refused (Operation not permitted), so its "
                             "answers may be late"
                           : "");
    EXPECT_EQ(seen(), granted ? std::pair(double{SCHED_FIFO}, double{kControllerPriority})
                              : std::pair(double{SCHED_OTHER}, 0.0));
    world.PrioritiseProcess(false);
    EXPECT_EQ(seen(), std::pair(double{SCHED_OTHER}, 0.0));
  }
}

}  // namespace
}  // namespace predictor
