#include "assessment/safety/safety.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <variant>

#include "assessment/person_chain.h"
#include "assessment/safety/output.h"
#include "assessment/samples.h"
#include "core/error.h"
#include "scenario/own_parameters.h"

namespace predictor::assessment {
namespace {

using ergonomics::ContactLimit;

SafetyCollector CollectSafety(const Scenario& scenario, std::uint64_t ticks,
                              const std::function<TickRecord(std::uint64_t)>& record) {
  SafetyCollector run(scenario);
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) run.Add(record(tick));
  return run;
}

double Value(const std::vector<Result>& results, const std::string& path) {
  for (const Result& result : results)
    if (result.path == path) return std::get<double>(result.value);
  throw std::out_of_range(path);
}

PersonSetup MadeUpSetup(const Scenario& scenario) { return SetupOf(scenario, RecordOf(1, 1, 0)); }

// ---- what the hands felt
// -------------------------------------------------------------------------

TEST(HandExposure, OfAConstantForceIsThatForce) {
  const Scenario scenario = PersonScenario();
  const auto results =
      CollectSafety(scenario, 2000, [](std::uint64_t t) { return RecordOf(t, 1, 10); })
          .exposure()
          .results();
  for (const char* key : {"peak_force_n", "smooth_peak_force_n", "force_p95_n", "force_rms_n"})
    EXPECT_NEAR(Value(results, std::string("hands.left.") + key), 10, 1e-9) << key;
  EXPECT_NEAR(Value(results, "hands.left.impulse_ns"), 20, 1e-9);
  EXPECT_NEAR(Value(results, "hands.left.force_rate_n_per_s"), 0, 1e-9);
  EXPECT_EQ(Value(results, "hands.left.high_force_s"), 0);
  EXPECT_EQ(Value(results, "hands.left.growing_cycles"), 0);
}

// The first-order low-pass answers a step of F within one tick by F (1 - exp(-2π f dt)).
TEST(HandExposure, RateOfAStepFollowsFromTheStatedFilter) {
  const Scenario scenario = PersonScenario();  // 1 kHz, threshold 30 N
  const auto results =
      CollectSafety(scenario, 2000,
                    [](std::uint64_t t) { return RecordOf(t, 1, t > 1000 ? 20 : 0); })
          .exposure()
          .results();
  const double gain = 1 - std::exp(-2 * std::numbers::pi * 20 * 1e-3);
  EXPECT_NEAR(Value(results, "hands.left.force_rate_n_per_s"), 20 * gain / 1e-3, 1e-6);
  EXPECT_NEAR(Value(results, "hands.left.high_force_s"), 1, 1e-9);  // 20 N are more than 15 N
  EXPECT_NEAR(Value(results, "hands.left.force_rms_n"), std::sqrt(200.0), 1e-9);
}

// The hand moves at 0.1 m/s. A force of 10 N acts in the direction of motion for 1 s, and then
// against it for 1.5 s.
TEST(HandExposure, EnergyIsCountedPerPort) {
  const Scenario scenario = PersonScenario();
  const auto results = CollectSafety(scenario, 2500,
                                     [](std::uint64_t t) {
                                       TickRecord record = RecordOf(t, 1, 10);
                                       record.hands[0].real.twist[2] = t <= 1000 ? 0.1 : -0.1;
                                       record.hands[0].virtual_.twist[2] = 0.2;
                                       record.hands[0].coupling[2] = -4;
                                       return record;
                                     })
                           .exposure()
                           .results();
  EXPECT_NEAR(Value(results, "hands.left.supplied_j"), -0.5, 1e-9);
  EXPECT_NEAR(Value(results, "hands.left.returned_j"), 1.5, 1e-9);
  EXPECT_NEAR(Value(results, "hands.left.peak_return_w"), 1, 1e-9);
  EXPECT_NEAR(Value(results, "hands.left.lowest_j"), -0.5, 1e-9);
  EXPECT_EQ(Value(results, "hands.left.active_episodes"), 1);
  EXPECT_NEAR(Value(results, "hands.left.scene_supplied_j"), (10 - 4) * 0.2 * 2.5, 1e-9);
  EXPECT_NEAR(Value(results, "hands.right.supplied_j"), 0, 1e-12);
}

// The amplitude of a sine of 2 Hz doubles in each second.
TEST(HandExposure, GrowingCyclesAreFound) {
  const Scenario scenario = PersonScenario();
  const auto results =
      CollectSafety(scenario, 4000,
                    [](std::uint64_t t) {
                      const double time = 1e-3 * static_cast<double>(t);
                      return RecordOf(t, 1,
                                      std::exp2(time) * std::sin(4 * std::numbers::pi * time));
                    })
          .exposure()
          .results();
  EXPECT_GE(Value(results, "hands.left.growing_cycles"), 1);
  // The amplitude of a cycle is √2 times its rms value. The last whole cycle lasts from peak to
  // peak, from 3.125 to 3.625 s.
  const double squares = (std::exp2(2 * 3.625) - std::exp2(2 * 3.125)) / (2 * std::numbers::ln2);
  EXPECT_NEAR(Value(results, "hands.left.growing_amplitude_n"), std::sqrt(squares / 0.5), 0.5);
}

// ---- stops
// ---------------------------------------------------------------------------------------

constexpr std::uint64_t kDecision = 1001;

// Returns a tick in which a hand at rest presses upward with the force `before` [N] or, from the
// decision to stop on, with the force `after` [N].
TickRecord StopRecord(std::uint64_t tick, double before, double after) {
  TickRecord record = RecordOf(tick, 1, tick < kDecision ? before : after);
  if (tick < kDecision) return record;
  record.cause = StopCause::kForce;
  record.cause_hand = 0;
  record.ran = tick == kDecision;
  record.state = tick < kDecision + 100 ? RunState::kStopping : RunState::kHeld;
  record.run_time = 1e-3 * static_cast<double>(kDecision);
  for (HandRecord& hand : record.hands) hand.gripping = tick == kDecision;  // lets go
  return record;
}

std::vector<StopWindow> WindowsOf(const Scenario& scenario, double before, double after) {
  return CollectSafety(scenario, 1500,
                       [&](std::uint64_t t) { return StopRecord(t, before, after); })
      .stops()
      .windows();
}

TEST(StopWindow, HoldsTheTimeAroundTheStopAndItsHands) {
  const auto windows = WindowsOf(PersonScenario(), 10, 25);
  ASSERT_EQ(windows.size(), 1U);
  const StopWindow& window = windows[0];
  EXPECT_EQ(window.stop.cause, StopCause::kForce);
  // The window begins 0.2 s before the decision. After the decision, it contains 0.1 s of stopping
  // and 0.1 s of rest.
  EXPECT_EQ(window.decided, 20U);
  EXPECT_EQ(window.samples.size(), 40U);
  for (std::size_t i = 0; i < window.samples.size(); ++i) {
    ASSERT_TRUE(window.samples[i].body.hands[0].present) << i;
    EXPECT_NEAR(window.samples[i].body.hands[0].F_D_W[2], i < window.decided ? 10 : 25, 1e-9) << i;
  }
}

// In equilibrium, torque = weight + Jᵀ F. If the force changes, the torque therefore changes in
// proportion. The change must equal that between two runs without a stop in the same posture.
TEST(StopLoads, ChangeByTheForceThatTheStopAdds) {
  const Scenario scenario = PersonScenario();
  const PersonSetup setup = MadeUpSetup(scenario);
  const auto torque_at = [&](double force) {
    const SampleCollector run =
        Collect(scenario, 1, [&](std::uint64_t t) { return RecordOf(t, 1, force); });
    return RunNominal(setup, run.samples(), {}, [](double) {}).frames.back().loads.torque;
  };
  const person::BodyVector expected = torque_at(25) - torque_at(10);
  const StopJudgement judged = JudgeStop(setup, WindowsOf(scenario, 10, 25)[0], true);
  ASSERT_EQ(judged.loads.size(), 2U * person::kArmJoints);
  for (int hand = 0; hand < kHands; ++hand)
    for (int k = 0; k < person::kArmJoints; ++k) {
      const StopLoad& load = judged.loads[static_cast<std::size_t>(hand * person::kArmJoints + k)];
      EXPECT_NEAR(load.change, expected[person::Of(hand, static_cast<person::ArmJoint>(k))], 1e-4)
          << load.joint;
      ASSERT_TRUE(load.change_90) << load.joint;
      EXPECT_LE(load.change_90->low, load.change) << load.joint;
      EXPECT_GE(load.change_90->high, load.change) << load.joint;
    }
  EXPECT_EQ(judged.loads[0].joint, "left shoulder flexion");
  EXPECT_TRUE(judged.loads[0].use);
  EXPECT_FALSE(judged.loads[1].use);  // the program has no strength for abduction
}

// The force of a hand that lets go decays with 40 ms, so its change differs between samples.
TEST(StopLoads, IntervalContainsTheValueOfADecayingForce) {
  const Scenario scenario = PersonScenario();
  for (const double before : {25.0, -40.0}) {
    const auto run = CollectSafety(scenario, 1500, [&](std::uint64_t t) {
      const double since = 1e-3 * (static_cast<double>(t) - static_cast<double>(kDecision));
      const double rising = before * std::min(1.0, static_cast<double>(t) / kDecision);
      return StopRecord(t, rising, before * std::exp(-std::max(0.0, since) / 0.04));
    });
    const StopJudgement judged = JudgeStop(MadeUpSetup(scenario), run.stops().windows()[0], true);
    ASSERT_EQ(judged.loads.size(), 2U * person::kArmJoints);
    for (const StopLoad& load : judged.loads) {
      ASSERT_TRUE(load.change_90) << load.joint;
      EXPECT_LE(load.change_90->low, load.change) << load.joint;
      EXPECT_GE(load.change_90->high, load.change) << load.joint;
    }
  }
}

TEST(StopLoads, OfARaisedShoulderHaveNoValue) {
  const Scenario scenario = PersonScenario();
  const auto run = CollectSafety(scenario, 1500, [](std::uint64_t t) {
    TickRecord record = StopRecord(t, 10, 25);
    for (HandRecord& hand : record.hands) hand.real.pose.p[2] = kGround + 1.85;
    return record;
  });
  const SafetyAssessment safety = JudgeSafety(scenario, MadeUpSetup(scenario), run, {});
  ASSERT_EQ(safety.stops[0].loads.size(), 2U * person::kArmJoints);
  for (const StopLoad& load : safety.stops[0].loads) {
    const bool shoulder = load.joint.find("shoulder") != std::string::npos;
    EXPECT_EQ(std::isfinite(load.change), !shoulder) << load.joint;
    EXPECT_EQ(load.change_90.has_value(), !shoulder) << load.joint;
    EXPECT_EQ(load.use.has_value(), load.joint.find("elbow") != std::string::npos) << load.joint;
  }
  EXPECT_TRUE(SafetyJson(safety)["stops"][0]["joints"][0]["change_nm"].is_null());
  EXPECT_NE(SafetyText(safety).find("raised above 90°"), std::string::npos);
}

TEST(StopLoads, OfHandsThatHoldNothingAreNotJudged) {
  const Scenario scenario = PersonScenario();
  const auto run = CollectSafety(scenario, 1500, [](std::uint64_t t) {
    TickRecord record = StopRecord(t, 0, 0);
    for (HandRecord& hand : record.hands) hand.gripping = 0;
    return record;
  });
  const StopJudgement judged = JudgeStop(MadeUpSetup(scenario), run.stops().windows()[0], false);
  EXPECT_TRUE(judged.loads.empty());
}

// ---- letting go
// ----------------------------------------------------------------------------------

TickRecord SceneRecord(std::uint64_t tick, const Vector3& object, double speed) {
  TickRecord record = RecordOf(tick, 1, 12);
  record.object.pose = ToRecord(Pose{object, {1, 0, 0, 0}});
  record.end_effector.pose = ToRecord(Pose{{-1, 0, 0.5}, {1, 0, 0, 0}});
  record.object.twist[0] = speed;
  return record;
}

TEST(LettingGo, AFallingObjectConvertsItsHeight) {
  const Scenario scenario = PersonScenario();  // feet at x = 0.95 m, facing -x, ground at -0.85 m
  const auto run = CollectSafety(scenario, 100, [](std::uint64_t t) {
    return SceneRecord(t, {0.3, 0, t == 50 ? 0.35 : 0.15}, 0.1);
  });
  const Drop drop =
      DropOf(run.scene(), {.cobot = 18, .object = 9}, MadeUpSetup(scenario), scenario);
  EXPECT_NEAR(drop.time, 0.05, 1e-9);
  EXPECT_NEAR(drop.height, 1.2, 1e-9);
  EXPECT_NEAR(drop.energy, 9 * kStandardGravity * 1.2, 1e-9);
  EXPECT_NEAR(drop.speed * drop.speed / 2, kStandardGravity * 1.2, 1e-9);
  EXPECT_NEAR(drop.weight_of_hand, 9 * kStandardGravity / 2, 1e-9);
  EXPECT_NEAR(drop.jump, 9 * kStandardGravity / 2 - 12, 1e-9);
  // De Leva's foot is 258.1 mm long at a body height of 1741 mm. Three quarters of the foot's
  // length are in front of the ankle.
  EXPECT_NEAR(drop.beside_feet, 0.65 - 0.75 * 0.2581 / 1.741 * 1.75, 1e-9);
}

// S = 1.6 (0.1 + 0.05) + 0.25 · 0.1 + 0.25 · 0.05 / 2 was calculated by hand.
TEST(LettingGo, SeparationFollowsTheFormula) {
  EXPECT_NEAR(NeededSeparation(0.25), 0.27125, 1e-12);
  EXPECT_NEAR(NeededSeparation(0), 0.16, 1e-12);
}

TEST(LettingGo, SeparationIsTheWorstOfTheReleases) {
  const Scenario scenario = PersonScenario();
  const auto run = CollectSafety(scenario, 1000, [](std::uint64_t t) {
    TickRecord record = SceneRecord(t, {0.3, 0, 0.15}, t == 600 ? 0.24 : t == 100 ? 0.5 : 0.1);
    record.hands[0].gripping = t < 500 || t > 700;  // the hand lets go from 0.5 to 0.7 s
    return record;
  });
  ASSERT_EQ(run.scene().releases().size(), 1U);
  const Separation s = SeparationOf(run.scene(), MadeUpSetup(scenario));
  EXPECT_NEAR(s.time, 0.6, 1e-9);
  EXPECT_NEAR(s.speed, 0.24, 1e-9);
  EXPECT_NEAR(s.distance, 0.65, 1e-9);
  EXPECT_EQ(run.scene().fastest().time, 0.1);
}

// A box rotates about its origin, which is at rest. Its fastest points are its corners. The box is
// turned by 90° about z, so its long side points along y.
TEST(LettingGo, TheFastestPointOfARotatingObjectCounts) {
  PrimitiveSpec box{.shape = Shape::kBox, .size = {0.8, 0.2, 0.4}, .mass = 9};
  const auto rotating = [&](const Vector3& axis) {
    SafetyCollector run(PersonScenario(), OutlineOf(MakeObject(box)));
    TickRecord record = SceneRecord(1, {0.3, 0, 0.15}, 0);
    record.object.pose = ToRecord(PoseFromXyzRpy({0.3, 0, 0.15}, {0, 0, std::numbers::pi / 2}));
    for (std::size_t i = 0; i < 3; ++i)
      record.object.twist[3 + i] = 0.93 * axis[static_cast<int>(i)];
    run.Add(record);
    return run.scene().fastest().speed();
  };
  EXPECT_NEAR(rotating({0, 0, 1}), 0.93 * std::hypot(0.4, 0.1), 1e-12);
  EXPECT_NEAR(rotating({0, 1, 0}), 0.93 * std::hypot(0.1, 0.2), 1e-12);
  EXPECT_NEAR(rotating({1, 0, 0}), 0.93 * std::hypot(0.4, 0.2), 1e-12);
  // A sphere and a cylinder of the same radius, whose axis is z.
  box = {.shape = Shape::kSphere, .size = {0.3, 0, 0}, .mass = 9};
  EXPECT_NEAR(rotating({0, 0, 1}), 0.93 * 0.3, 1e-12);
  box = {.shape = Shape::kCylinder, .size = {0.3, 0.5, 0}, .mass = 9};
  EXPECT_NEAR(rotating({0, 0, 1}), 0.93 * 0.3, 1e-12);
}

// Without the object's shape, the handles are the known points that are not at its origin.
TEST(LettingGo, AHandleCanBeTheFastestPoint) {
  const Scenario scenario = PersonScenario();
  const auto run = CollectSafety(scenario, 10, [](std::uint64_t t) {
    TickRecord record = SceneRecord(t, {0.3, 0, 0.15}, 0.13);
    record.hands[1].virtual_.twist[2] = t == 5 ? 0.258 : 0;
    return record;
  });
  EXPECT_NEAR(run.scene().fastest().speed(), 0.258, 1e-12);
  EXPECT_NEAR(run.scene().fastest().time, 0.005, 1e-12);
  EXPECT_NEAR(SeparationOf(run.scene(), MadeUpSetup(scenario)).speed, 0.258, 1e-12);
}

// In the reference's example, a cobot of 17.8 kg that carries 9 kg may hit a hand at 1.34 m/s.
TEST(LettingGo, ContactLimitsTheSpeedByForceAndMasses) {
  const ContactLimit hand = {.region = "hand/finger",
                             .force = 140,
                             .pressure = 2e6,
                             .transient_factor = 2,
                             .stiffness = 75e3,
                             .mass = 0.6};
  ContactLimit face = hand;
  face.region = "face";
  face.transient_factor = 0;
  Scenario scenario = PersonScenario();
  scenario.cobot.safety.force_cap = 70;
  const auto run = CollectSafety(scenario, 10, [](std::uint64_t t) {
    return SceneRecord(t, {0.3, 0, 0.15}, 0.67);
  });
  const UnintendedContact contact =
      ContactOf(run.scene(), {.cobot = 17.8, .object = 9},
                {.edition = "test", .points = {hand, hand, face}}, scenario);
  ASSERT_EQ(contact.regions.size(), 2U);  // each region once
  EXPECT_NEAR(contact.robot_mass, 17.9, 1e-9);
  EXPECT_NEAR(contact.regions[0].max_speed, 1.34, 0.01);
  EXPECT_NEAR(contact.regions[0].share, 0.5, 0.005);
  EXPECT_TRUE(std::isinf(contact.regions[1].share));
  ASSERT_TRUE(contact.clamping_force);
  EXPECT_NEAR(contact.clamped[0].share, 70.0 / 140, 1e-12);
}

// Returns the notes below the table of unintended contact.
std::string NotesOn(const UnintendedContact& contact) {
  SafetyAssessment safety;
  safety.contact = contact;
  std::string notes;
  for (const SafetyTable& table : SafetyTables(safety))
    if (table.title == "Unintended contact")
      for (const std::string& note : table.notes) notes += note + "\n";
  return notes;
}

// The bodies that can clamp are named even if the force of the clamping is unknown.
TEST(Contact, NamesWhatCanClampWithAndWithoutABoundOnTheForce) {
  UnintendedContact contact;
  contact.fixtures = {"the table", "press"};
  const std::string bodies =
      "The object or the cobot can clamp a body part against: the table, press.";
  EXPECT_NE(NotesOn(contact).find(bodies), std::string::npos);
  EXPECT_NE(NotesOn(contact).find("so clamping is not judged"), std::string::npos);
  contact.clamping_force = 70;
  EXPECT_NE(NotesOn(contact).find(bodies), std::string::npos);
  EXPECT_NE(NotesOn(contact).find("clamped with 70 N"), std::string::npos);
  contact.fixtures.clear();
  EXPECT_NE(NotesOn(contact).find("contains no floor, table or fixture"), std::string::npos);
}

// Only what touches the object or the cobot can clamp.
TEST(LettingGo, ClampingNamesTheFixtures) {
  Scenario scenario = PersonScenario();
  scenario.environment.floor = false;
  scenario.environment.table.reset();
  EXPECT_TRUE(ClampingFixtures(scenario).empty());
  scenario.environment.table.emplace();
  FixtureSpec wall{.touches = {"object"}, .name = "wall"};
  FixtureSpec unnamed{.shape = FixtureShape::kSphere, .touches = {"cobot"}};
  FixtureSpec drawn{.touches = {}, .name = "drawn"};
  FixtureSpec volume{.name = "volume", .keep_out = true};
  scenario.environment.fixtures = {wall, unnamed, drawn, volume};
  EXPECT_EQ(ClampingFixtures(scenario),
            (std::vector<std::string>{"the table", "wall", "a sphere"}));
}

// ---- the whole assessment ----------------------------------------------------------------------

TEST(Safety, StatesWhatTheRigCannotRender) {
  const Scenario scenario = PersonScenario();
  const auto run = CollectSafety(scenario, 100, [](std::uint64_t t) {
    TickRecord record = SceneRecord(t, {0.3, 0, 0.15}, 0.1);
    record.hands[1].wrench[2] = t == 70 ? 31 : 12;
    return record;
  });
  const SafetyAssessment safety = JudgeSafety(scenario, MadeUpSetup(scenario), run, {});
  ASSERT_GE(safety.rig.size(), 2U);
  EXPECT_TRUE(safety.rig[0].censored());
  EXPECT_NEAR(safety.rig[0].reached, 31, 1e-9);
  EXPECT_FALSE(safety.rig[1].censored());
  EXPECT_NE(SafetyText(safety).find("at least 31.00"), std::string::npos);
  // Without masses, neither a fall nor a contact can be judged, and the output must state this.
  EXPECT_FALSE(safety.drop);
  const auto gap = [&](const std::string& what) {
    return std::ranges::any_of(safety.not_evaluable,
                               [&](const NotEvaluable& n) { return n.what == what; });
  };
  EXPECT_TRUE(gap("fall of the object"));
  EXPECT_TRUE(gap("unintended contact"));
  EXPECT_TRUE(gap("force of a hand above 30.00 N"));
  EXPECT_TRUE(std::ranges::none_of(safety.not_evaluable, [](const NotEvaluable& n) {
    return n.what.starts_with("torque of a hand above");
  }));
  EXPECT_NE(SafetyText(safety).find("no event of the scenario had begun"), std::string::npos);
}

// The event that had begun last at the largest value explains why the limit was reached. A record
// numbers an event by its hazard in the catalogue. Here each entry of the scenario has another
// number than its hazard.
TEST(Safety, ALimitOfTheRigNamesTheEvent) {
  const ParameterKind loss = {"power_loss", "the cobot loses its power", nullptr};
  const ParameterKind slips = {"object_slips", "the object slips", nullptr};
  const ParameterKind jolt = {"jolt", "the cobot jolts", nullptr};
  const ParameterKind* kinds[] = {&loss, &slips, &jolt};
  const ParameterKinds declared = Hazards();
  DeclareHazards(kinds);
  Scenario scenario = PersonScenario();
  for (const char* event : {"jolt", "power_loss"}) scenario.events.push_back({.event = event});
  const auto run = CollectSafety(scenario, 100, [](std::uint64_t t) {
    TickRecord record = SceneRecord(t, {0.3, 0, 0.15}, 0.1);
    record.latest_event = t >= 90 ? 1 : t >= 60 ? 3 : 0;  // the jolt, and then the loss of power
    record.hands[1].wrench[2] = t == 70 ? 31 : t == 95 ? 30.5 : 12;
    record.hands[1].wrench[3] = t == 95 ? 4 : 0;
    return record;
  });
  const SafetyAssessment safety = JudgeSafety(scenario, MadeUpSetup(scenario), run, {});
  EXPECT_EQ(safety.rig[0].event, "jolt");
  EXPECT_EQ(safety.rig[1].event, "power_loss");
  EXPECT_NE(SafetyText(safety).find("after the event jolt had begun"), std::string::npos);
  // A single event whose hazard is not the first of the catalogue.
  scenario.events = {{.event = "object_slips"}};
  const auto slipping = CollectSafety(scenario, 100, [](std::uint64_t t) {
    TickRecord record = SceneRecord(t, {0.3, 0, 0.15}, 0.1);
    record.latest_event = t >= 60 ? 2 : 0;
    record.hands[1].wrench[2] = t == 70 ? 31 : 12;
    return record;
  });
  const SafetyAssessment slip = JudgeSafety(scenario, MadeUpSetup(scenario), slipping, {});
  EXPECT_EQ(slip.rig[0].event, "object_slips");
  EXPECT_NE(SafetyText(slip).find("after the event object_slips had begun"), std::string::npos);
  DeclareHazards(declared);
}

TEST(Safety, OfARunWithoutSimulatedTimeIsRefused) {
  const Scenario scenario = PersonScenario();
  const auto run = CollectSafety(scenario, 10, [](std::uint64_t t) {
    TickRecord record = RecordOf(t, 1, 0);
    record.ran = 0;
    return record;
  });
  EXPECT_THROW(JudgeSafety(scenario, MadeUpSetup(scenario), run, {}), InputError);
}

TEST(Safety, JsonHasTheMembersOfItsSchema) {
  const Scenario scenario = PersonScenario();
  const auto run =
      CollectSafety(scenario, 1500, [](std::uint64_t t) { return StopRecord(t, 10, 25); });
  SafetyOptions options;
  options.masses = SceneMasses{.cobot = 18, .object = 9};
  options.limits = {
      .edition = "test",
      .points = {
          {.region = "chest", .force = 140, .transient_factor = 2, .stiffness = 25e3, .mass = 40}}};
  const auto json = SafetyJson(JudgeSafety(scenario, MadeUpSetup(scenario), run, options));
  const auto schema = SafetySchema();
  for (const auto& [key, value] : json.items())
    EXPECT_TRUE(schema["properties"].contains(key)) << key;
  for (const auto& [key, value] : schema["properties"].items())
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["stops"].size(), 1U);
  EXPECT_EQ(json["stops"][0]["joints"].size(), 14U);
  EXPECT_EQ(json["unintended_contact"]["transient"].size(), 1U);
  for (const auto& [key, value] : schema["properties"]["unintended_contact"]["properties"].items())
    EXPECT_TRUE(json["unintended_contact"].contains(key)) << key;
}

}  // namespace
}  // namespace predictor::assessment
