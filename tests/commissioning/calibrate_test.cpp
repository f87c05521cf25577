#include "commissioning/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "commissioning/rig_station.h"
#include "core/error.h"

namespace predictor {
namespace {

// An arm of the rig as a station of a session, in virtual time.
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

// A person who leads the arm to joints, step by step; true once it is there and at rest.
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
    if (last.find("Enter takes it") == std::string::npos) return 0;
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
  int presses = 0;  // of Enter; the handle is touched during the first
  int ends = 0;     // too early, then because something was given up
  ScriptedPerson person([&](const std::string& last) -> char {
    const double t = 1e-9 * static_cast<double>(bench.time.Now());
    bench.hand.touch[0] = presses == 1 ? 3 * std::sin(10 * t) : 0;
    if (last.find("Enter takes it") == std::string::npos) return 0;
    if (next == 2 && ends == 0) return ++ends, 'd';
    if (next == 4) return kGiveUp;
    if (presses == 1) presses = 2;
    if (!leader.Lead(postures[next])) return 0;
    next += presses++ == 0 ? 0 : 1;
    return kEnter;
  });
  Session session(&bench.time, &person, {&bench.station});
  EXPECT_THROW(MeasureHandle(&session, bench.station), InputError);  // given up
  EXPECT_NE(person.All().find("take your hands off"), std::string::npos) << person.All();
  EXPECT_NE(person.All().find("too few"), std::string::npos) << person.All();
}

TEST(Station, GoesOnReadingAnArmThatIsLedAndNotOneThatIsSilent) {
  Bench bench;
  ScriptedPerson person([](const std::string&) -> char { return 0; });
  Session session(&bench.time, &person, {&bench.station});
  bench.hand.trouble = "somebody leads it";
  for (int k = 0; k < 100; ++k) session.Step();
  EXPECT_THROW(session.Step(&bench.station, JointVector::Zero(7)), DeviceError);
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
  second.device.left->base.xyz = {1.1, 0.05, 0.02};  // opposite
  second.device.left->base.rpy = {0.01, -0.02, 3.0};
  RigHand hand_a(first, &time, ArmStart(1)[0]), hand_b(second, &time, ArmStart(1)[0]);
  // What is believed of the second's base is wrong.
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
  // The leader stops within 0.2 mrad: the tip within a millimetre.
  EXPECT_LT(PoseError(found.X_AB, truth).head<3>().norm(), 0.004) << person.All();
  EXPECT_LT(PoseError(found.X_AB, truth).tail<3>().norm(), 0.006);
  EXPECT_LT(found.residual, 0.001);
}

// A person who holds the key, as a terminal tells it: 30 letters a second after a first pause.
class Holder {
 public:
  explicit Holder(const VirtualTime* time) : time_(time) {}
  bool holds = false;
  char Key() {
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

ChirpOptions Short() {
  ChirpOptions options;
  options.time = 2.5;
  return options;
}

TEST(MeasureLoop, FindsTheLoopWhileTheKeyIsHeld) {
  Scenario scenario = ArmScenario(1);
  scenario.rig.loop = VelocityLoopSpec{11, 0.8, 0.0075};
  Bench bench(scenario, 500);
  Holder holder(&bench.time);
  holder.holds = true;
  ScriptedPerson person([&](const std::string&) { return holder.Key(); });
  Session session(&bench.time, &person, {&bench.station});
  const JointVector start = bench.q();
  const LoopFit fit = FitSwings(&session, SwingJoints(&session, &bench.station, 0.05, Short()));
  EXPECT_NEAR(fit.bandwidth.value, 11, 0.02 * 11) << person.All();
  EXPECT_NEAR(fit.damping_ratio.value, 0.8, 0.02 * 0.8);
  EXPECT_NEAR(fit.delay.value, 0.0075, 2e-4);
  EXPECT_LT((bench.q() - start).norm(), 1e-3);  // it comes back
  EXPECT_NE(LoopText(fit, scenario.device.left->loop).find("bandwidth"), std::string::npos);
}

TEST(MeasureLoop, MovesOnlyWhileTheKeyIsHeldAndNeverFast) {
  Bench bench;
  Holder holder(&bench.time);
  double since_change = 0, fastest = 0;
  int changes = 0;
  ScriptedPerson person([&](const std::string&) {
    const double speed = bench.hand.rig().true_handles()[0].V_W.head<3>().norm();
    fastest = std::max(fastest, speed);
    since_change += Session::kStep;
    // Released for a while: silence of the key, ramp and lag of the loop are over.
    if (!holder.holds && since_change > 0.5) {
      EXPECT_LT(speed, 1e-3);
    }
    if (since_change > (holder.holds ? 2.1 : 0.8)) {
      holder.holds = !holder.holds;
      since_change = 0;
      ++changes;
    }
    return changes > 6 ? kGiveUp : holder.Key();
  });
  Session session(&bench.time, &person, {&bench.station});
  const JointVector start = bench.q();
  EXPECT_THROW(SwingJoints(&session, &bench.station, 0.05, Short()), InputError);
  EXPECT_GT(fastest, 0.005);
  EXPECT_LT(fastest, 0.06);
  EXPECT_LT((bench.q() - start).cwiseAbs().maxCoeff(), 0.15);
  EXPECT_NE(person.All().find("THE LEFT ARM MOVES"), std::string::npos);
  EXPECT_NE(person.All().find("this joint begins again"), std::string::npos);
}

TEST(MeasureLoop, StopsWhenTheHandleIsTouched) {
  Bench bench;
  Holder holder(&bench.time);
  holder.holds = true;
  ScriptedPerson person([&](const std::string&) {
    if (bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03) bench.hand.touch[1] = 30;
    return holder.Key();
  });
  Session session(&bench.time, &person, {&bench.station});
  try {
    SwingJoints(&session, &bench.station, 0.05, Short());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("touches the handle"), std::string::npos);
  }
  EXPECT_LT(bench.hand.sample().v.cwiseAbs().maxCoeff(), 1e-3);
}

// However it ends, the arm is at rest then, has never been braked harder than is said, has left its
// motion, and the person has been told.
class MeasureLoopEnds : public testing::TestWithParam<const char*> {};

TEST_P(MeasureLoopEnds, AtRest) {
  const std::string way = GetParam();
  Bench bench;
  Scenario second = ArmScenario(1);
  second.device.left->base.xyz = {1.1, 0, 0};
  RigHand other(second, &bench.time, ArmStart(1)[0]);
  Station beside(1, MachineArmOf(second), std::make_unique<RigDriver>(&other), nullptr);
  Holder holder(&bench.time);
  holder.holds = true;
  bool moved = false;
  int waited = 0;
  ScriptedPerson person([&](const std::string&) -> char {
    moved = moved || bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03;
    if (!moved) return holder.Key();
    if (way == "given up" || waited > 500) return kGiveUp;
    if (way == "Ctrl-C") throw InputError("Ended on request.");
    if (way == "any other exception") throw std::runtime_error("out of something");
    if (way == "let go") holder.holds = false, ++waited;
    if (way == "touched") bench.hand.touch[1] = 30;
    if (way == "off its path") bench.hand.wobble = [](int joint, double) { return 0.05 * joint; };
    if (way == "the other arm falls silent") other.silent = true;
    return holder.Key();
  });
  Session session(&bench.time, &person, {&bench.station, &beside});
  EXPECT_ANY_THROW(SwingJoints(&session, &bench.station, 0.05, Short()));
  EXPECT_TRUE(moved);
  ASSERT_EQ(bench.hand.command().size(), 7);
  EXPECT_EQ(bench.hand.command().cwiseAbs().maxCoeff(), 0);
  EXPECT_FALSE(bench.hand.motion());
  EXPECT_LT(bench.hand.sample().v.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LE(bench.hand.hardest(), ChirpOptions().acceleration * (1 + 1e-9));
  EXPECT_NE(person.All().find("The left arm was brought to rest within"), std::string::npos)
      << person.All();
}

INSTANTIATE_TEST_SUITE_P(Because, MeasureLoopEnds,
                         testing::Values("given up", "Ctrl-C", "any other exception", "let go",
                                         "touched", "off its path", "the other arm falls silent"),
                         [](const testing::TestParamInfo<const char*>& way) {
                           std::string name = way.param;
                           std::erase_if(name, [](char c) { return !std::isalpha(c); });
                           return name;
                         });

// Nothing can be promised of an arm that does not answer, and the person is told what to look at.
TEST(MeasureLoop, SaysWhenItCannotBringTheArmToRest) {
  for (const bool silent : {true, false}) {
    Bench bench;
    Holder holder(&bench.time);
    holder.holds = true;
    ScriptedPerson person([&](const std::string&) {
      if (bench.hand.sample().v.cwiseAbs().maxCoeff() > 0.03) {
        bench.hand.silent = silent;
        if (!silent) bench.hand.trouble = "it is in protective stop";
      }
      return holder.Key();
    });
    Session session(&bench.time, &person, {&bench.station});
    EXPECT_THROW(SwingJoints(&session, &bench.station, 0.05, Short()), DeviceError);
    EXPECT_NE(person.All().find("takes no more commands"), std::string::npos) << person.All();
    EXPECT_NE(person.All().find("emergency stop"), std::string::npos);
  }
}

// A person pushes as told, and the machine file has the sensor turned by `turned`, about the axes
// of the world.
std::string RefusalOfPushes(const Vector3& turned) {
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
    return last.find("Hands off") != std::string::npos ? kEnter : static_cast<char>(0);
  });
  Session session(&bench.time, &person, {&station, &bench.station});
  try {
    TestPushes(&session, station, nullptr);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(TestPushes, PassesThroughTheEstimatorAndRefusesATurnedSensor) {
  EXPECT_EQ(RefusalOfPushes({0, 0, 0}), "");
  const std::string turned = RefusalOfPushes({0, 0, M_PI});
  EXPECT_NE(turned.find("turned by 180°"), std::string::npos) << turned;
  EXPECT_NE(RefusalOfPushes({M_PI / 2, 0, 0}).find("reads"), std::string::npos);
}

TEST(HeldKey, IsHeldFromTheSecondLetterUntilItIsSilent) {
  HeldKey key('s');
  EXPECT_FALSE(key.Update('s', 1.0));
  EXPECT_FALSE(key.Update(0, 1.3));
  EXPECT_TRUE(key.Update('s', 1.5));
  EXPECT_TRUE(key.Update(0, 1.59));
  EXPECT_TRUE(key.Update('s', 1.595));
  EXPECT_FALSE(key.Update(0, 1.70));
  EXPECT_FALSE(key.Update('s', 1.8));
  EXPECT_TRUE(key.Update('s', 1.9));
  EXPECT_FALSE(key.Update('x', 1.91));
  EXPECT_FALSE(key.Update('s', 1.92));
  EXPECT_FALSE(key.Update('s', 3.0));  // a second touch, not a repeat
}

}  // namespace
}  // namespace predictor
