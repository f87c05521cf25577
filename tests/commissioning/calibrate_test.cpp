#include "commissioning/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "commissioning/rig_station.h"
#include "core/error.h"
#include "core/words.h"

namespace predictor::commissioning {
namespace {

// An arm of the rig as the station of a session, in virtual time.
struct Bench {
  explicit Bench(const Scenario& s = ArmScenario(1), double rate = 1000)
      : scenario(s),
        hand(scenario, &time, ArmStart(1)[0], rate),
        station(0, MachineArmOf(scenario), std::make_unique<RigDriver>(&hand), nullptr) {}

  const JointVector& q() const { return hand.sample().q; }

  VirtualTime time;
  Scenario scenario;
  RigHand hand;
  Station station;
};

// A person who leads the arm to given joint angles. Lead returns true once the arm rests there.
class Leader {
 public:
  explicit Leader(RigHand* hand) : hand_(hand) {}
  bool Lead(const JointVector& goal) {
    const JointVector way = goal - hand_->sample().q;
    if (way.norm() > 2e-4) {
      steps_ = 0;
      hand_->Lead((4 * way).cwiseMax(-1.5).cwiseMin(1.5));
      return false;
    }
    hand_->Lead(JointVector::Zero(way.size()));
    return ++steps_ > 300;
  }

 private:
  RigHand* hand_;
  int steps_ = 0;
};

std::vector<JointVector> Postures(const JointVector& start, int count) {
  std::vector<JointVector> all;
  const double tilts[][3] = {{0, 0, 0},    {1.0, 0, 0},   {-1.0, 0, 0},   {0, 1.0, 0},
                             {0, -1.0, 0}, {0.8, 0.9, 0}, {-0.7, 0.8, 1}, {0.5, -0.9, -1}};
  for (int i = 0; i < count; ++i) {
    JointVector q = start;
    for (int j = 0; j < 3; ++j) q[4 + j] += tilts[i % 8][j];
    all.push_back(q);
  }
  return all;
}

TEST(MeasureHandle, OfALedArmFindsTheHandleOfTheRig) {
  Bench bench;
  Leader leader(&bench.hand);
  const auto postures = Postures(bench.q(), 8);
  std::size_t next = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    if (last.find("Enter takes the pose") == std::string::npos) return 0;
    if (next == postures.size()) return 'd';
    if (!leader.Lead(postures[next])) return 0;
    ++next;
    return kEnter;
  });
  Session session(&bench.time, &person, {&bench.station});
  const HandleCalibration found = MeasureHandle(&session, bench.station);
  const HandlePayloadSpec& truth = bench.scenario.device.left->payload;
  EXPECT_EQ(found.poses, 8);
  EXPECT_NEAR(found.mass.value, truth.mass, 0.01 * truth.mass) << person.All();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.center_of_mass[i].value, truth.center_of_mass[static_cast<Eigen::Index>(i)],
                0.001);
    EXPECT_NEAR(found.bias[i].value, bench.scenario.rig.sensor_bias[i], 0.05);
  }
  const std::string text = HandleText(found, truth);
  EXPECT_NE(text.find("mass"), std::string::npos);
}

TEST(MeasureHandle, TellsWhatIsWrongAndGoesOn) {
  Bench bench;
  Leader leader(&bench.hand);
  const auto postures = Postures(bench.q(), 8);
  std::size_t next = 0;
  int presses = 0;  // presses of Enter; the handle is touched during the first
  int ends = 0;     // the first `d` comes too early
  ScriptedPerson person([&](const std::string& last) -> char {
    const double t = 1e-9 * static_cast<double>(bench.time.Now());
    bench.hand.touch[0] = presses == 1 ? 3 * std::sin(10 * t) : 0;
    if (last.find("Enter takes the pose") == std::string::npos) return 0;
    if (next == 2 && ends == 0) return ++ends, 'd';
    if (next == 4) return kGiveUp;
    if (presses == 1) presses = 2;
    if (!leader.Lead(postures[next])) return 0;
    next += presses++ == 0 ? 0 : 1;
    return kEnter;
  });
  Session session(&bench.time, &person, {&bench.station});
  EXPECT_THROW(MeasureHandle(&session, bench.station), InputError);  // the person gave up
  EXPECT_NE(person.All().find("Take your hands off the handle"), std::string::npos) << person.All();
  EXPECT_NE(person.All().find("too few"), std::string::npos) << person.All();
}

TEST(Station, GoesOnReadingAnArmThatIsLedAndNotOneThatIsSilent) {
  Bench bench;
  ScriptedPerson person([](const std::string&) -> char { return 0; });
  Session session(&bench.time, &person, {&bench.station});
  bench.hand.trouble = "somebody leads it";
  for (int k = 0; k < 100; ++k) session.Step();
  EXPECT_THROW(session.Step(&bench.station, [] { return JointVector::Zero(7); }), DeviceError);
  bench.hand.silent = true;
  EXPECT_THROW(
      {
        for (int k = 0; k < 1000; ++k) session.Step();
      },
      DeviceError);
}

TEST(Station, RefusesAModelOfAnotherArm) {
  Bench bench;
  MachineArm other = MachineArmOf(bench.scenario);
  other.arm.model = "package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf";
  other.arm.remove_links.clear();
  other.arm.end_effector = "tool0";
  EXPECT_THROW(Station(0, other, std::make_unique<RigDriver>(&bench.hand), nullptr), InputError);
  EXPECT_THROW(Station(0, MachineArmOf(bench.scenario),
                       std::make_unique<RigDriver>(&bench.hand, false), nullptr),
               DeviceError);
}

TEST(MeasureBases, OfTwoLedArmsFindsWhereOneStands) {
  VirtualTime time;
  const Scenario first = ArmScenario(1);
  Scenario second = ArmScenario(1);
  second.device.left->base.xyz = {1.1, 0.05, 0.02};  // facing the first arm
  second.device.left->base.rpy = {0.01, -0.02, 3.0};
  RigHand hand_a(first, &time, ArmStart(1)[0]), hand_b(second, &time, ArmStart(1)[0]);
  // The machine file has a wrong base pose for the second arm.
  MachineArm believed = MachineArmOf(second);
  believed.arm.base = {{1.0, 0, 0}, {0, 0, M_PI}};
  Station a(0, MachineArmOf(first), std::make_unique<RigDriver>(&hand_a), nullptr);
  Station b(1, believed, std::make_unique<RigDriver>(&hand_b), nullptr);
  const Vector3 tip(0.01, 0.02, 0.15);
  const auto joints = [&](const Scenario& scenario, const Vector3& point) {
    const ArmSpec& spec = *scenario.device.left;
    const auto model = RobotModel::Load({spec.model, {}, spec.remove_links, spec.base.ToPose()});
    const Quaternion down = RotationFromVector({M_PI, 0, 0});
    JointVector q = ArmStart(1)[0];
    EXPECT_TRUE(SolveInverseKinematics(*model, model->Frame(spec.end_effector, {tip, {1, 0, 0, 0}}),
                                       {point, down}, q, 20, &q));
    return q;
  };
  const std::vector<Vector3> points = {
      {0.45, 0.15, 0.2}, {0.6, 0.35, 0.2}, {0.5, 0.3, 0.45}, {0.65, 0.1, 0.35}};
  std::size_t done = 0;
  Leader lead_a(&hand_a), lead_b(&hand_b);
  ScriptedPerson person([&](const std::string& last) -> char {
    if (last.find("Touch point") == std::string::npos) return 0;
    const bool by_b = last.find("right") != std::string::npos;
    const std::size_t index = by_b ? done - points.size() : done;
    if (index == points.size() || (!by_b && done == points.size())) {
      return done == points.size() ? 'd' : static_cast<char>(0);
    }
    static JointVector goal;
    static std::size_t planned = 99;
    if (planned != done) {
      goal = joints(by_b ? second : first, points[index]);
      planned = done;
    }
    if (!(by_b ? lead_b : lead_a).Lead(goal)) return 0;
    ++done;
    return kEnter;
  });
  Session session(&time, &person, {&a, &b});
  const BaseCalibration found = MeasureBases(&session, a, b, tip);
  const Pose truth = first.device.left->base.ToPose().Inverse() * second.device.left->base.ToPose();
  // The leader stops within 0.2 mrad of the goal, which moves the tip by less than a millimetre.
  EXPECT_LT(PoseError(found.X_AB, truth).head<3>().norm(), 0.004) << person.All();
  EXPECT_LT(PoseError(found.X_AB, truth).tail<3>().norm(), 0.006);
  EXPECT_LT(found.residual, 0.001);
}

// Without --tip, the program asks which part touches instead of guessing.
TEST(MeasureBases, WithoutATipAsksWhetherTheEndEffectorTouches) {
  Bench bench;
  const Station other(1, MachineArmOf(bench.scenario), std::make_unique<RigDriver>(&bench.hand),
                      nullptr);
  for (const char answer : {'n', 'y'}) {
    ScriptedPerson person([&](const std::string& last) -> char {
      if (last.find("No --tip was given") != std::string::npos) return answer;
      return last.find("Touch point 1") != std::string::npos ? kGiveUp : static_cast<char>(0);
    });
    Session session(&bench.time, &person, {&bench.station});
    std::string why;
    try {
      MeasureBases(&session, bench.station, other, std::nullopt);
    } catch (const InputError& error) {
      why = error.what();
    }
    EXPECT_NE(why.find(answer == 'n' ? "Start again with --tip X Y Z" : "Cancelled"),
              std::string::npos)
        << why;
    EXPECT_NE(person.All().find("of the left arm: " + bench.scenario.arm(0).end_effector),
              std::string::npos)
        << person.All();
  }
}

// A person who holds the key, as a terminal reports it: after a first pause, 30 letters a second.
class Holder {
 public:
  explicit Holder(const VirtualTime* time) : time_(time) {}
  bool holds = false;
  // `last` is the latest message, as ScriptedPerson passes it.
  char Key(const std::string& last) {
    if (last.find("then press Enter") != std::string::npos) return kEnter;
    const double now = 1e-9 * static_cast<double>(time_->Now());
    if (!holds) {
      begin_ = -1;
      return 0;
    }
    if (begin_ < 0) {
      begin_ = now;
      next_ = now + 0.5;
      return kSwingKey;
    }
    if (now < next_) return 0;
    next_ += 0.033;
    return kSwingKey;
  }

 private:
  const VirtualTime* time_;
  double begin_ = -1, next_ = 0;
};

SwingOptions Short() {
  SwingOptions options;
  options.chirp.time = 2.5;
  return options;
}

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

// Joints that were measured before an interruption are not measured again.
TEST(MeasureLoop, GoesOnWithTheJointsThatAreLeft) {
  Bench bench;
  Swings swings;
  std::vector<std::vector<std::string>> told;
  for (const char* last_joint : {"Joint 3 of 7", "never told"}) {
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

TEST(MeasureLoop, SaysThatATouchIsNotEnough) {
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

// The watchdog, which would notice that this program hangs, is gone.
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

// However a measurement ends: the arm must be at rest, must never have decelerated faster than the
// limit, and must have left its motion mode, and the person must have been informed of the reason.
struct End {
  const char* way;
  std::string why;  // expected message
};

class MeasureLoopEnds : public testing::TestWithParam<End> {
 protected:
  // Causes this end.
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

// A late reading or a late tick stops the arm. The joint is measured again, but only after the
// person has released the key.
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

// The message to a person who starts under this condition. The arm must not have moved.
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

TEST(MeasureLoop, DoesNotMoveAnArmThatWasToldOfAnotherPayload) {
  Bench bench;
  auto driver = std::make_unique<RigDriver>(&bench.hand);
  driver->mutable_facts().payload = ToldPayload{3.0, Vector3::Zero()};
  bench.station = Station(0, MachineArmOf(bench.scenario), std::move(driver), nullptr);
  const std::string why = RefusalToBegin(&bench, [] {});
  EXPECT_NE(why.find("is set to 3.00 kg"), std::string::npos) << why;
}

// If the machine's limits are lower than the threshold for a touch, the machine's limits apply.
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

// Every command is limited again immediately before it is sent.
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

// The external watchdog is notified every millisecond, including whether the arm moves.
TEST(MeasureLoop, TellsEachStepWhetherTheArmMoves) {
  Bench bench;
  Holder holder(&bench.time);
  holder.holds = true;
  int steps = 0;
  bool told = false;
  double longest = 0, last_step = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    if (bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03) {
      EXPECT_TRUE(told);
      if (++steps > 300) return kGiveUp;
    }
    return holder.Key(last);
  });
  Session session(&bench.time, &person, {&bench.station});
  session.OnStep([&](bool moves) -> std::string {
    const double now = session.Now();
    if (last_step > 0) longest = std::max(longest, now - last_step);
    last_step = now;
    told = moves;
    if (moves || bench.hand.command().size() == 0) return "";
    EXPECT_EQ(bench.hand.command().norm(), 0);
    return "";
  });
  EXPECT_THROW(SwingAll(&session, &bench.station, Short()), InputError);
  EXPECT_FALSE(told);  // at rest at the end
  EXPECT_LT(longest, 0.0011);
}

// ---- an enabling device -------------------------------------------------------------------------

class MeasureLoopWithADevice : public testing::Test {
 protected:
  static constexpr int kInput = 3;
  MeasureLoopWithADevice() { options_.enabling = {&bench_.station, kInput}; }
  void Press(bool pressed) { bench_.hand.inputs = pressed ? 1U << kInput : 0; }
  bool Moves() const { return bench_.hand.sample().v.cwiseAbs().maxCoeff() > 0.03; }
  // Calls `act` in each step with the time since the prompt for the first joint [s]; `act` returns
  // a key.
  std::string Swing(const std::function<char(double)>& act) {
    double since = -1;
    person_ = std::make_unique<ScriptedPerson>([this, since, act](const std::string& last) mutable {
      if (last.find("then press Enter") != std::string::npos) return kEnter;
      if (last.find("Joint 1 of") != std::string::npos && since < 0) since = 0;
      if (since < 0) return char{0};
      since += Session::kStep;
      return act(since);
    });
    Session session(&bench_.time, person_.get(), {&bench_.station});
    try {
      SwingAll(&session, &bench_.station, options_);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  Bench bench_;
  SwingOptions options_ = Short();
  std::unique_ptr<ScriptedPerson> person_;
};

TEST_F(MeasureLoopWithADevice, MovesWhileItIsHeldOnceTheKeyWasTouched) {
  bool moved = false;
  Swing([&](double t) -> char {
    Press(t > 0.2 && t < 2.5);
    if (std::abs(t - 0.3) < 0.5 * Session::kStep) return kSwingKey;
    if (t > 0.9 && t < 2.5) moved = moved || Moves();
    EXPECT_FALSE(t > 2.5 + 0.2 && Moves()) << t;
    if (t > 4) return kGiveUp;
    return 0;
  });
  EXPECT_TRUE(moved);
  EXPECT_NE(person_->All().find(HowToHold('s', true)), std::string::npos);
  EXPECT_NE(person_->All().find("pressed another key. This joint will be measured again"),
            std::string::npos);
}

TEST_F(MeasureLoopWithADevice, AHeldKeyIsNotEnough) {
  Swing([&](double t) -> char {
    EXPECT_FALSE(Moves());
    if (t > 3) return kGiveUp;
    return std::fmod(t, 0.03) < Session::kStep ? kSwingKey : char{0};
  });
  EXPECT_NE(person_->All().find("Not accepted yet: " + HowToHold('s', true) + "."),
            std::string::npos)
      << person_->All();
}

TEST_F(MeasureLoopWithADevice, NorIsTheDeviceAlone) {
  Swing([&](double t) -> char {
    Press(t > 0.2);
    EXPECT_FALSE(Moves());
    return t > 3 ? kGiveUp : char{0};
  });
}

TEST_F(MeasureLoopWithADevice, OneThatIsTapedDownCountsForNothing) {
  Press(true);
  Swing([&](double t) -> char {
    EXPECT_FALSE(Moves());
    if (t > 3) return kGiveUp;
    return std::fmod(t, 0.9) < Session::kStep ? kSwingKey : char{0};
  });
  EXPECT_NE(person_->All().find("release the enabling device, hold it again and tap s."),
            std::string::npos)
      << person_->All();
}

TEST_F(MeasureLoopWithADevice, AnyOtherKeyStopsUntilItWasLetGo) {
  bool moved = false;
  Swing([&](double t) -> char {
    Press(t > 0.2);
    if (t > 0.3 && t < 2) moved = moved || Moves();
    EXPECT_FALSE(t > 2.2 && Moves()) << t;
    if (t > 4) return kGiveUp;
    if (t > 2 && t < 2 + 1.5 * Session::kStep) return 'x';
    return std::fmod(t, 0.9) < Session::kStep ? kSwingKey : char{0};
  });
  EXPECT_TRUE(moved);
}

// Letters that were typed while a connection was stalled do not count as a touch of the key;
// neither does a jammed key.
TEST_F(MeasureLoopWithADevice, LettersThatStoodInLineAreNoTouch) {
  Swing([&](double t) -> char {
    Press(t > 0.2);
    EXPECT_FALSE(Moves()) << t;
    if (t > 3) return kGiveUp;
    return t > 1.5 && t < 1.505 ? kSwingKey : char{0};
  });
}

TEST_F(MeasureLoopWithADevice, AKeyThatIsJammedIsNoTouch) {
  Swing([&](double t) -> char {
    Press(t > 0.5);
    EXPECT_FALSE(Moves()) << t;
    if (t > 3) return kGiveUp;
    return std::fmod(t, 0.03) < Session::kStep ? kSwingKey : char{0};
  });
  EXPECT_NE(person_->All().find("release s for a second, then tap it"), std::string::npos)
      << person_->All();
}

// The program cannot guarantee anything for an arm that does not respond, so it warns the person.
TEST(MeasureLoop, SaysWhenItCannotBringTheArmToRest) {
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

// A person pushes as instructed. In the machine file, the sensor is rotated by `turned` [rad] about
// the axes of the world.
std::string RefusalOfPushes(const Vector3& turned, std::string* told = nullptr) {
  const Scenario scenario = ArmScenario(1);
  Bench bench(scenario);
  bench.station.Watch();
  const Quaternion q_WE = bench.station.EndEffectorPose().q;
  MachineArm believed = MachineArmOf(scenario);
  PoseSpec& pose = believed.arm.sensor.pose;
  pose.rpy = RpyOf(q_WE.conjugate() * RotationFromVector(turned) * q_WE * pose.ToPose().q);
  Station station(0, believed, std::make_unique<RigDriver>(&bench.hand), nullptr);
  int axis = -1;
  double since = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    const Pose X_WS = bench.station.EndEffectorPose() * scenario.device.left->sensor.pose.ToPose();
    since += Session::kStep;
    if (const auto at = last.find("along +"); at != std::string::npos && axis != last[at + 7]) {
      axis = last[at + 7];
      since = 0;
    }
    const bool pushes = axis >= 0 && since > 0.3 && since < 1;
    const Vector3 F_W = pushes ? Vector3(12 * Vector3::Unit(axis - 'x')) : Vector3::Zero();
    bench.hand.touch.head<3>() = X_WS.q.conjugate() * F_W;
    if (since > 20) return kGiveUp;
    return last.find("Take your hands off") != std::string::npos ? kEnter : static_cast<char>(0);
  });
  Session session(&bench.time, &person, {&station, &bench.station});
  try {
    TestPushes(&session, station, nullptr);
    if (told) *told = person.All();
    return "";
  } catch (const InputError& error) {
    if (told) *told = person.All();
    return error.what();
  }
}

TEST(TestPushes, PassesThroughTheEstimatorAndRefusesATurnedSensor) {
  EXPECT_EQ(RefusalOfPushes({0, 0, 0}), "");
  const std::string turned = RefusalOfPushes({0, 0, M_PI});
  EXPECT_NE(turned.find("rotated by 180°"), std::string::npos) << turned;
  EXPECT_NE(RefusalOfPushes({M_PI / 2, 0, 0}).find("reads"), std::string::npos);
}

TEST(TestPushes, TellsAWrongPushBeforeTheNextOne) {
  std::string told;
  EXPECT_EQ(RefusalOfPushes({0, 0, 0}, &told), "");
  EXPECT_EQ(told.find("DIFFERS FROM THE PUSH"), std::string::npos) << told;
  EXPECT_NE(RefusalOfPushes({0, 0, M_PI}, &told), "");
  const auto x = told.find("DIFFERS FROM THE PUSH. The push along +x reads -x: mirrored.");
  const auto y = told.find("DIFFERS FROM THE PUSH. The push along +y reads -y: mirrored.");
  ASSERT_NE(x, std::string::npos) << told;
  ASSERT_NE(y, std::string::npos) << told;
  EXPECT_LT(x, told.find("handle along +y"));
  EXPECT_LT(y, told.find("handle along +z"));
  EXPECT_EQ(told.find("The push along +z"), std::string::npos) << told;  // the sensor read this
                                                                         // push correctly
}

}  // namespace
}  // namespace predictor::commissioning
