// Measures the velocity loop of an arm of the rig, which moves while a person holds a key.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commissioning/rig_bench.h"
#include "core/error.h"

namespace predictor::commissioning {
namespace {

TEST(MeasureLoop, FindsTheLoopWhileTheKeyIsHeld) {
  Scenario scenario = ArmScenario(1);
  scenario.rig.loop = VelocityLoopSpec{11, 0.8, 0.0075};
  scenario.device.left->sample_rate = 500;
  Bench bench(scenario, 500);
  Holder holder(&bench.time);
  holder.holds = true;
  ScriptedPerson person([&](const std::string& last) { return holder.Key(last); });
  Session session(&bench.time, &person, {&bench.station});
  const JointVector start = bench.q();
  const LoopFit fit = FitSwings(&session, SwingAll(&session, &bench.station, Short()).records);
  EXPECT_NEAR(fit.bandwidth.value, 11, 0.02 * 11) << person.All();
  EXPECT_NEAR(fit.damping_ratio.value, 0.8, 0.02 * 0.8);
  EXPECT_NEAR(fit.delay.value, 0.0075, 2e-4);
  EXPECT_LT((bench.q() - start).norm(), 1e-3);  // returns to its start
  EXPECT_NE(LoopText(fit, scenario.device.left->loop).find("bandwidth"), std::string::npos);
}

TEST(MeasureLoop, MovesOnlyWhileTheKeyIsHeldAndNeverFast) {
  Bench bench;
  Holder holder(&bench.time);
  double since_change = 0, fastest = 0;
  int changes = 0;
  ScriptedPerson person([&](const std::string& last) {
    const double speed = bench.hand.rig().true_handles()[0].V_W.head<3>().norm();
    fastest = std::max(fastest, speed);
    since_change += Session::kStep;
    // The key has been released long enough for its time-out, the ramp, and the loop's lag to end.
    if (!holder.holds && since_change > 0.5) {
      EXPECT_LT(speed, 1e-3);
    }
    if (since_change > (holder.holds ? 2.1 : 0.8)) {
      holder.holds = !holder.holds;
      since_change = 0;
      ++changes;
    }
    return changes > 6 ? kGiveUp : holder.Key(last);
  });
  Session session(&bench.time, &person, {&bench.station});
  const JointVector start = bench.q();
  EXPECT_THROW(SwingAll(&session, &bench.station, Short()), InputError);
  EXPECT_GT(fastest, 0.005);
  EXPECT_LT(fastest, 0.06);
  EXPECT_LT((bench.q() - start).cwiseAbs().maxCoeff(), 0.15);
  EXPECT_NE(person.All().find("THE LEFT ARM WILL MOVE"), std::string::npos);
  EXPECT_NE(person.All().find("pressed another key. This joint will be measured again"),
            std::string::npos);
}

// The program must not measure joints again that it measured before an interruption.
TEST(MeasureLoop, ContinuesWithTheRemainingJoints) {
  Bench bench;
  Swings swings;
  std::vector<std::vector<std::string>> reported;
  for (const char* last_joint : {"Joint 3 of 7", "never shown"}) {
    Holder holder(&bench.time);
    holder.holds = true;
    ScriptedPerson person([&](const std::string& last) {
      return last.find(last_joint) != std::string::npos ? kGiveUp : holder.Key(last);
    });
    Session session(&bench.time, &person, {&bench.station});
    try {
      SwingJoints(&session, &bench.station, Short(), &swings);
    } catch (const InputError&) {
      EXPECT_EQ(swings.measured(), 2) << person.All();
      EXPECT_FALSE(swings.complete());
      EXPECT_NE(person.All().find("Joint 2 of 7 starts immediately"), std::string::npos);
      EXPECT_EQ(person.All().find("Joint 2 of 7: hold"), std::string::npos);
      continue;
    }
    EXPECT_EQ(person.All().find("Joint 2 of 7"), std::string::npos) << person.All();
    EXPECT_NE(person.All().find("Joint 3 of 7: hold s."), std::string::npos) << person.All();
  }
  ASSERT_TRUE(swings.complete());
  for (int joint = 0; joint < 7; ++joint)
    EXPECT_EQ(swings.records[static_cast<std::size_t>(joint)].joint, joint);
  EXPECT_NO_THROW(FitLoop(swings.records));
}

TEST(MeasureLoop, ReportsThatATouchIsNotEnough) {
  Bench bench;
  double since = -1;
  bool touched = false;
  ScriptedPerson person([&](const std::string& last) -> char {
    if (last.find("then press Enter") != std::string::npos) return kEnter;
    if (last.find("Joint 1 of") != std::string::npos && since < 0) since = 0;
    if (since >= 0) since += Session::kStep;
    if (since > 4) return kGiveUp;
    return since > 1 && !std::exchange(touched, true) ? kSwingKey : char{0};
  });
  Session session(&bench.time, &person, {&bench.station});
  EXPECT_THROW(SwingAll(&session, &bench.station, Short()), InputError);
  const std::string all = person.All(), answer = "Not accepted yet: hold s.";
  ASSERT_NE(all.find(answer), std::string::npos) << all;
  EXPECT_EQ(all.find(answer, all.find(answer) + 1), std::string::npos) << all;
  EXPECT_EQ(all.find("device"), std::string::npos) << all;  // this rig has no device
}

// Returns the message with which the program refuses to begin under this condition. The arm must
// not have moved.
std::string RefusalToBegin(Bench* bench, const std::function<void()>& once_tared) {
  Holder holder(&bench->time);
  holder.holds = true;
  ScriptedPerson person([&](const std::string& last) {
    if (last.find("Joint 1 of") != std::string::npos) once_tared();
    return holder.Key(last);
  });
  Session session(&bench->time, &person, {&bench->station});
  std::string why;
  try {
    SwingAll(&session, &bench->station, Short());
  } catch (const std::exception& error) {
    why = error.what();
  }
  EXPECT_EQ(bench->hand.hardest(), 0) << why;
  return why;
}

TEST(MeasureLoop, DoesNotBeginWithAHandOnTheHandle) {
  Bench bench;
  const std::string why = RefusalToBegin(&bench, [&] { bench.hand.touch[0] = 8; });
  EXPECT_NE(why.find("Something presses on the left handle (8."), std::string::npos) << why;
}

TEST(MeasureLoop, DoesNotMoveAnArmThatIsSetToAnotherPayload) {
  Bench bench;
  auto driver = std::make_unique<RigDriver>(&bench.hand);
  driver->mutable_facts().payload = ReportedPayload{3.0, Vector3::Zero()};
  bench.station = Station(0, MachineArmOf(bench.scenario), std::move(driver), nullptr);
  const std::string why = RefusalToBegin(&bench, [] {});
  EXPECT_NE(why.find("is set to 3.00 kg"), std::string::npos) << why;
}

// The program must send the watchdog a notification every millisecond that states whether the arm
// moves.
TEST(MeasureLoop, ReportsAtEachStepWhetherTheArmMoves) {
  Bench bench;
  Holder holder(&bench.time);
  holder.holds = true;
  int steps = 0;
  bool reported = false;
  double longest = 0, last_step = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    if (bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03) {
      EXPECT_TRUE(reported);
      if (++steps > 300) return kGiveUp;
    }
    return holder.Key(last);
  });
  Session session(&bench.time, &person, {&bench.station});
  session.OnStep([&](bool moves) -> std::string {
    const double now = session.Now();
    if (last_step > 0) longest = std::max(longest, now - last_step);
    last_step = now;
    reported = moves;
    if (moves || bench.hand.command().size() == 0) return "";
    EXPECT_EQ(bench.hand.command().norm(), 0);
    return "";
  });
  EXPECT_THROW(SwingAll(&session, &bench.station, Short()), InputError);
  EXPECT_FALSE(reported);  // at rest at the end
  EXPECT_LT(longest, 0.0011);
}

}  // namespace
}  // namespace predictor::commissioning
