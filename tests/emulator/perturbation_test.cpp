// Tests the displacements of the handles that identify the operator's arm: their course, bounds and
// times.
#include "emulator/perturbation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "core/minimum_jerk.h"
#include "runs.h"

namespace predictor {
namespace {

Vector3 Displacement(const TickRecord& r) {
  return {r.perturbation[0], r.perturbation[1], r.perturbation[2]};
}

TEST(QuinticMotion, IsOfMinimumJerkFromRest) {
  const QuinticMotion motion({}, 0.006, 0.12);
  for (double t = 0; t <= 0.12; t += 0.01) {
    EXPECT_NEAR(motion.At(t).position, 0.006 * MinimumJerk(t / 0.12), 1e-15);
    EXPECT_NEAR(motion.At(t).velocity, 0.006 / 0.12 * MinimumJerkRate(t / 0.12), 1e-15);
  }
}

// Checks the boundary conditions, and compares the derivatives with finite differences.
TEST(QuinticMotion, ContinuesAMotionAndEndsAtRest) {
  const QuinticMotion::Point start = {0.003, 0.05, -0.4};
  const QuinticMotion motion(start, 0, 0.12);
  EXPECT_DOUBLE_EQ(motion.At(0).position, start.position);
  EXPECT_DOUBLE_EQ(motion.At(0).velocity, start.velocity);
  EXPECT_DOUBLE_EQ(motion.At(0).acceleration, start.acceleration);
  EXPECT_NEAR(motion.At(0.12).position, 0, 1e-15);
  EXPECT_NEAR(motion.At(0.12).velocity, 0, 1e-14);
  EXPECT_NEAR(motion.At(0.12).acceleration, 0, 1e-12);
  constexpr double kStep = 1e-5;
  for (double t = 0.01; t < 0.11; t += 0.01) {
    const auto before = motion.At(t - kStep), after = motion.At(t + kStep);
    EXPECT_NEAR(motion.At(t).velocity, (after.position - before.position) / (2 * kStep), 1e-7);
    EXPECT_NEAR(motion.At(t).acceleration, (after.velocity - before.velocity) / (2 * kStep), 1e-5);
  }
}

// A displacement that is taken back early must not exceed its amplitude by more than 1 %.
TEST(QuinticMotion, TakenBackAtAnyTimeHardlyGoesFarther) {
  const QuinticMotion out({}, 1, 1);
  for (double t = 0; t <= 1; t += 0.02) {
    const QuinticMotion back(out.At(t), 0, 1);
    for (double s = 0; s <= 1; s += 0.02) {
      EXPECT_LE(back.At(s).position, 1.01) << t << " " << s;
      EXPECT_GE(back.At(s).position, -0.01) << t << " " << s;
    }
  }
}

TEST(Perturbation, IsRefusedNearInstability) {
  try {
    const Emulator emulator(LoadTestScenario("identify_arm", {"perturbation.margin=8"}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("stability margin is only"), std::string::npos)
        << error.what();
  }
}

// With several seeds, the displacements must not stop a run and must stay within their bounds. Both
// hands must move alike, and the directions must be balanced.
TEST(Perturbation, KeepsItsBoundsAndStopsNoRun) {
  for (const int seed : {1, 2, 3, 4}) {
    double largest = 0, force = 0, coupling = 0, fastest = 0, error = 0;
    Vector3 before = Vector3::Zero();
    std::multiset<int> directions;
    const TestRun run = RunScenario(
        "identify_arm", {"duration=60", "seed=" + std::to_string(seed)}, [&](const TickRecord& r) {
          const Vector3 u = Displacement(r);
          EXPECT_TRUE(u.isZero(0) || r.state == RunState::kRun);
          fastest = std::max(fastest, (u - before).norm() / 0.001);
          if (u.norm() > 0 && before.norm() == 0)
            directions.insert(static_cast<int>(std::lround(std::atan2(u.y(), u.x()) * 4 / M_PI)));
          before = u;
          largest = std::max(largest, u.norm());
          if (u.norm() == 0) return;
          for (const HandRecord& hand : r.hands) {
            force = std::max(force, Vector3(hand.wrench[0], hand.wrench[1], hand.wrench[2]).norm());
            coupling = std::max(coupling, std::abs(hand.coupling[0]) + std::abs(hand.coupling[1]));
            const Vector3 apart = FromRecord(hand.real.pose).p - FromRecord(hand.virtual_.pose).p;
            error = std::max(error, (apart - u).norm());
          }
        });
    EXPECT_EQ(run.end, RunEnd::kFinished) << seed;
    EXPECT_GT(directions.size(), 30U);
    for (const int d : directions) EXPECT_GE(directions.count(d), directions.size() / 8 - 1) << d;
    EXPECT_NEAR(largest, 0.007, 1e-12);
    EXPECT_LE(force, 15) << seed;
    EXPECT_EQ(coupling, 0) << seed;
    EXPECT_LE(fastest, 1.876 * 0.007 / 0.1);
    EXPECT_LT(error, 0.003) << seed;  // the device's lag
  }
}

TEST(Perturbation, StopsNoShippedScenarioThatRunsWithoutIt) {
  for (const char* name : {"box_9kg", "box_18kg", "single_arm", "dual_ur5", "linear_axis"})
    for (const int seed : {11, 12}) {
      bool moved = false;
      const TestRun run = RunScenario(
          name, {"seed=" + std::to_string(seed), "perturbation={consent: true, margin: 1.5}"},
          [&](const TickRecord& r) { moved = moved || Displacement(r).norm() > 0.005; });
      EXPECT_EQ(run.end, RunEnd::kFinished) << name << " " << seed;
      EXPECT_TRUE(moved) << name << " " << seed;
    }
}

// The seed must determine the times and directions.
TEST(Perturbation, IsRepeatedBySeed) {
  const auto sum = [](int seed) {
    Vector3 total = Vector3::Zero();
    RunScenario("identify_arm", {"duration=15", "seed=" + std::to_string(seed)},
                [&](const TickRecord& r) { total += r.run_time * Displacement(r); });
    return total;
  };
  EXPECT_EQ(sum(5), sum(5));
  EXPECT_NE(sum(5), sum(6));
}

// A push of 20 N must end a displacement and prevent the next one.
TEST(Perturbation, IsTakenBackWhenAHandPushes) {
  Vector3 before = Vector3::Zero();
  double jump = 0, during = 0;
  int began_while_pushing = 0;
  const TestRun run =
      RunScenario("identify_arm",
                  {"duration=20", "safety.force=60",
                   "operator.script.1={action: push, start: 6, duration: 8, rise_time: 0.4, "
                   "force: [45, 0, 0], hand: left}"},
                  [&](const TickRecord& r) {
                    const Vector3 u = Displacement(r);
                    jump = std::max(jump, (u - before).norm());
                    if (u.norm() > 0 && before.norm() == 0 && r.run_time > 6.5 && r.run_time < 13.9)
                      ++began_while_pushing;
                    if (r.run_time > 7 && r.run_time < 13) during = std::max(during, u.norm());
                    before = u;
                  });
  EXPECT_EQ(run.end, RunEnd::kFinished);
  EXPECT_EQ(began_while_pushing, 0);
  EXPECT_EQ(during, 0);
  EXPECT_LT(jump, 1.2 * 1.876 * 0.007 / 0.12 * 0.001);
}

// A state saved during a displacement must continue bit for bit.
TEST(Perturbation, ContinuesFromASavedState) {
  const Scenario scenario = LoadTestScenario("identify_arm");
  Emulator first(scenario), second(scenario);
  std::vector<std::byte> state(kStateBytes);
  AutoStart(&first);
  for (int k = 0; k < 30000 && Displacement(first.record()).norm() < 0.003; ++k) {
    first.Tick();
    AutoStart(&first);
  }
  ASSERT_GE(Displacement(first.record()).norm(), 0.003);
  state.resize(first.SaveState(state));
  second.LoadState(state);
  for (int k = 0; k < 3000; ++k) {
    first.Tick();
    second.Tick();
    ASSERT_EQ(Displacement(first.record()), Displacement(second.record())) << k;
    ASSERT_EQ(first.record().hands[0].command, second.record().hands[0].command) << k;
  }
}

}  // namespace
}  // namespace predictor
