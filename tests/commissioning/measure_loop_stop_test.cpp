// Tests how the measurement of the velocity loop ends. Whatever happens, the arm must come to rest,
// and the program must give the person the reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "commissioning/rig_bench.h"
#include "core/error.h"
#include "core/words.h"

namespace predictor::commissioning {
namespace {

// A way in which a measurement can end, and the expected message. Afterwards, the arm must be at
// rest, must never have decelerated faster than the limit, and must have left its motion mode. The
// person must have been informed of the reason.
struct End {
  const char* way;
  std::string why;  // expected message
};

class MeasureLoopEnds : public testing::TestWithParam<End> {
 protected:
  // Ends the measurement in the way that `way` names.
  void Act(const std::string& way, Bench* bench, RigHand* other) {
    if (way == "touched") bench->hand.touch[1] = 32;
    if (way == "twisted") bench->hand.touch[5] = 4;
    if (way == "jumped") bench->hand.wobble = [](int joint, double) { return 0.05 * joint; };
    if (way == "drifting off" && !bench->hand.wobble) {
      bench->hand.wobble = [wandered = 0.0](int joint, double) mutable {
        return joint == 6 ? wandered = std::min(0.025, wandered + 2e-4) : 0;
      };
    }
    if (way == "the other arm falls silent") other->silent = true;
    if (way == "silent") bench->hand.silent = true;
    if (way == "saturated") Spoil(bench, [](ArmSample* arm) { arm->sensor_saturated = true; });
    if (way == "no number") Spoil(bench, [](ArmSample* arm) { arm->F_S_raw[2] = NAN; });
    if (way == "no angle") Spoil(bench, [](ArmSample* arm) { arm->q[2] = NAN; });
    if (way == "frozen") {
      const Wrench held = bench->hand.sample().F_S_raw;
      if (!bench->hand.spoil) Spoil(bench, [held](ArmSample* arm) { arm->F_S_raw = held; });
    }
  }
  static void Spoil(Bench* bench, std::function<void(ArmSample*)> spoil) {
    bench->hand.spoil = std::move(spoil);
  }
};

TEST_P(MeasureLoopEnds, AtRest) {
  const std::string way = GetParam().way;
  Bench bench;
  Scenario second = ArmScenario(1);
  second.device.left->base.xyz = {1.1, 0, 0};
  RigHand other(second, &bench.time, ArmStart(1)[0]);
  Station beside(1, MachineArmOf(second), std::make_unique<RigDriver>(&other), nullptr);
  Holder holder(&bench.time);
  holder.holds = true;
  bool moved = false;
  int waited = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    moved = moved || bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03;
    if (!moved) return holder.Key(last);
    if (way == "given up" || waited > 500) return kGiveUp;
    if (way == "Ctrl-C") throw InputError("Ended on request.");
    if (way == "any other exception") throw std::runtime_error("out of something");
    if (way == "let go") holder.holds = false, ++waited;
    Act(way, &bench, &other);
    return holder.Key(last);
  });
  Session session(&bench.time, &person, {&bench.station, &beside});
  std::string why;
  try {
    SwingAll(&session, &bench.station, Short());
  } catch (const std::exception& error) {
    why = error.what();
  }
  EXPECT_NE(why.find(GetParam().why), std::string::npos) << why;
  EXPECT_TRUE(moved);
  ASSERT_EQ(bench.hand.command().size(), 7);
  EXPECT_EQ(bench.hand.command().cwiseAbs().maxCoeff(), 0);
  EXPECT_LE(bench.hand.hardest(), ChirpOptions().acceleration * (1 + 1e-9));
  if (way == "silent" || way == "no angle") return;  // the state of this arm is unknown
  EXPECT_FALSE(bench.hand.motion());
  EXPECT_LT(bench.hand.rig().true_handles()[0].V_W.norm(), 1e-3);
  EXPECT_NE(person.All().find("The left arm was brought to rest within"), std::string::npos)
      << person.All();
}

INSTANTIATE_TEST_SUITE_P(
    Because, MeasureLoopEnds,
    testing::Values(
        End{"given up", "Cancelled"}, End{"Ctrl-C", "Ended on request"},
        End{"any other exception", "out of something"}, End{"let go", "Cancelled"},
        End{"touched", StopCauseText(StopCause::kForce) + " (3"},
        End{"twisted", StopCauseText(StopCause::kTorque)},
        End{"jumped", StopCauseText(StopCause::kDevice, Quantity::kAngle) + " (17.2°, "},
        End{"drifting off", "Joint 7 left its planned path"},
        End{"the other arm falls silent", "stopped sending its state"},
        End{"saturated", StopCauseText(StopCause::kSensor)}, End{"no number", "invalid numbers"},
        End{"no angle", "invalid numbers"},
        End{"frozen", StopCauseText(StopCause::kStale, Quantity::kCount) + " (50, limit 49)"},
        End{"silent", "stopped sending its state"}),
    [](const testing::TestParamInfo<End>& end) {
      std::string name = end.param.way;
      std::erase_if(name, [](char c) { return !std::isalpha(c); });
      return name;
    });

// A late reading or a late tick must stop the arm. The program measures the joint again, but only
// after the person has released the key.
TEST(MeasureLoop, BeginsAJointAgainThatWasHeldUp) {
  for (const bool tick : {true, false}) {
    Bench bench;
    Holder holder(&bench.time);
    holder.holds = true;
    enum { kGoes, kHeldUp, kLetGo, kAgain } phase = kGoes;
    double since = 0, silent = 0;
    bench.time.OnStep([&](double dt) {
      silent = bench.hand.silent ? silent + dt : 0;
      if (silent > 0.008) bench.hand.silent = false;
    });
    ScriptedPerson person([&](const std::string& last) -> char {
      const bool moves = bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03;
      since += Session::kStep;
      if (phase == kGoes && moves) {
        phase = kHeldUp;
        since = 0;
        bench.hand.silent = !tick;
        if (tick) bench.time.Wait(0.005);
      }
      EXPECT_FALSE(phase == kHeldUp && since > 0.3 && moves);
      if (phase == kHeldUp && since > 2) {
        holder.holds = false;
        phase = kLetGo;
      }
      if (phase == kLetGo && since > 2.5) {
        holder.holds = true;
        phase = kAgain;
      }
      if (phase == kAgain && moves) return kGiveUp;
      return holder.Key(last);
    });
    Session session(&bench.time, &person, {&bench.station});
    EXPECT_THROW(SwingAll(&session, &bench.station, Short()), InputError);
    EXPECT_EQ(phase, kAgain);
    EXPECT_LE(bench.hand.hardest(), ChirpOptions().acceleration * (1 + 1e-9));
    const std::string why = (tick ? StopCauseText(StopCause::kDeadline)
                                  : StopCauseText(StopCause::kStale, Quantity::kArmAge))
                                .substr(1);
    EXPECT_NE(person.All().find(why), std::string::npos) << person.All();
    EXPECT_NE(person.All().find("This joint will be measured again."), std::string::npos);
  }
}

// The watchdog, which would notice a hang of this program, no longer runs.
TEST(MeasureLoop, StopsWithoutItsWatchdog) {
  Bench bench;
  Holder holder(&bench.time);
  holder.holds = true;
  bool silent = false;
  ScriptedPerson person([&](const std::string& last) {
    silent = silent || bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03;
    return holder.Key(last);
  });
  Session session(&bench.time, &person, {&bench.station});
  session.OnStep([&](bool) -> std::string { return silent ? "No watchdog." : ""; });
  EXPECT_THROW(SwingAll(&session, &bench.station, Short()), DeviceError);
  EXPECT_TRUE(silent);
  EXPECT_LT(bench.hand.sample().v.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LE(bench.hand.hardest(), ChirpOptions().acceleration * (1 + 1e-9));
}

TEST(MeasureLoop, StopsWhenTheHandleIsTouched) {
  Bench bench;
  Holder holder(&bench.time);
  holder.holds = true;
  ScriptedPerson person([&](const std::string& last) {
    if (bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03) bench.hand.touch[1] = 30;
    return holder.Key(last);
  });
  Session session(&bench.time, &person, {&bench.station});
  try {
    SwingAll(&session, &bench.station, Short());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("touches the handle"), std::string::npos);
  }
  EXPECT_LT(bench.hand.sample().v.cwiseAbs().maxCoeff(), 1e-3);
}

// If the machine's force limits are lower than the threshold for a touch, the machine's limits
// apply.
TEST(MeasureLoop, StopsAtTheMachinesForce) {
  Bench bench;
  Holder holder(&bench.time);
  holder.holds = true;
  ScriptedPerson person([&](const std::string& last) {
    if (bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03) bench.hand.touch[1] = 9;
    return holder.Key(last);
  });
  Session session(&bench.time, &person, {&bench.station});
  SwingOptions options = Short();
  options.limits.force = 6;
  try {
    SwingAll(&session, &bench.station, options);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("limit 6 N"), std::string::npos) << error.what();
  }
  EXPECT_LT(bench.hand.rig().true_handles()[0].V_W.norm(), 1e-3);
}

// Every command must be limited again immediately before it is sent.
TEST(MotionWatch, LetsNothingPastTheGuard) {
  Bench bench;
  bench.station.Watch();
  MotionWatch watch(bench.station, {});
  const double most = 0.001 * OneOrEach(bench.scenario.arm(0).acceleration_limit, 0);
  const JointVector sent = watch.Bounded(JointVector::Constant(7, 5.0));
  EXPECT_NEAR(sent.maxCoeff(), most, 1e-12);
  EXPECT_NEAR(sent.minCoeff(), most, 1e-12);
  EXPECT_EQ(watch.Bounded(JointVector::Constant(7, NAN)).norm(), 0);
}

// The program cannot guarantee anything about an arm that does not respond, so it must warn the
// person.
TEST(MeasureLoop, ReportsAnArmThatCannotBeBroughtToRest) {
  for (const bool silent : {true, false}) {
    Bench bench;
    Holder holder(&bench.time);
    holder.holds = true;
    ScriptedPerson person([&](const std::string& last) {
      if (bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03) {
        bench.hand.silent = silent;
        if (!silent) bench.hand.trouble = "it is in protective stop";
      }
      return holder.Key(last);
    });
    Session session(&bench.time, &person, {&bench.station});
    EXPECT_THROW(SwingAll(&session, &bench.station, Short()), DeviceError);
    EXPECT_NE(person.All().find("no longer accepts commands"), std::string::npos) << person.All();
    EXPECT_NE(person.All().find("emergency stop"), std::string::npos);
  }
}

}  // namespace
}  // namespace predictor::commissioning
