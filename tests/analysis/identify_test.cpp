// Identifies the friction of cobots that differ slightly from their nominal model.
#include "analysis/identify/identify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>

#include "analysis/identify/fit.h"
#include "analysis/identify/loop.h"
#include "analysis/identify/real.h"
#include "analysis/scenarios.h"
#include "core/error.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "scenario/scenario_io.h"
#include "support/soak.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

constexpr int kJoints = 7;  // of the Panda

class IdentifyTest : public testing::Test {
 protected:
  IdentifyTest()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("identify_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~IdentifyTest() override { fs::remove_all(folder_); }

  // Passes each tick of the real cobot's excitation to `look`, with noise added to the torque.
  void Excite(const RealCobot& real, const std::function<void(const TickRecord&)>& look) {
    Emulator emulator(MakeReal(nominal_, real, folder_));
    TorqueNoise noise(real);
    const RunEnd end = Simulate(&emulator, nominal_.duration, [&](TickRecord record) {
      noise.Add(&record);
      look(record);
    });
    ASSERT_EQ(end, RunEnd::kFinished);
  }

  const Scenario nominal_ = Load("excite_cobot.yaml");
  const fs::path folder_;
};

// Counts how often 95 % intervals contain the true value, and how accurate the estimates are.
struct Tally {
  int intervals = 0, held = 0;
  int off = 0;       // number of errors above 5 % that the interval does not reveal
  double worst = 0;  // error divided by the half-width
  void Add(const Estimate& estimate, double truth) {
    ++intervals;
    const double error = std::abs(estimate.value - truth);
    held += error <= estimate.half_width;
    worst = std::max(worst, error / estimate.half_width);
    off += error > 0.05 * truth && !IsWide(estimate);
  }
  void Add(const Identification& found, const RealCobot& real) {
    for (std::size_t j = 0; j < found.joints.size(); ++j) {
      if (!found.joints[j].identified()) continue;
      Add(found.joints[j].viscous, real.viscous[j]);
      Add(found.joints[j].coulomb, real.coulomb[j]);
    }
  }
  // At least 90 % of the intervals must contain the true value, and no estimate may be far off. If
  // the noise widens the intervals to about 5 %, one estimate in twenty may count as `off`, because
  // the intervals are 95 % intervals.
  void Expect(double max_off = 0) const {
    EXPECT_LE(off, max_off) << "of " << intervals << " intervals";
    EXPECT_LT(worst, 3) << "half-widths";
    EXPECT_GE(held, intervals > 300 ? 0.9 * intervals : 0.8 * intervals)
        << "of " << intervals << " intervals";
  }
};

TEST_F(IdentifyTest, FrictionAndItsIntervalsSoak) {
  Tally tally;
  int load_held = 0;
  const long seeds = Count(3, 50);
  for (long seed = 1; seed <= seeds; ++seed) {
    const RealCobot real = DrawRealCobot(kJoints, static_cast<std::uint64_t>(seed));
    Identifier identifier(nominal_);
    Excite(real, [&](const TickRecord& record) { identifier.Add(record); });
    const Identification found = identifier.Finish();
    ASSERT_TRUE(found.complete()) << IdentificationText(found);
    EXPECT_FALSE(found.strained) << found.strain;
    EXPECT_EQ(found.base_parameters, 43);  // of a Panda (Gaz et al. 2019)
    EXPECT_LT(found.condition, 200);
    EXPECT_NE(found.model, InertiaModel::kFixed);
    tally.Add(found, real);
    ASSERT_TRUE(found.load.identified()) << found.load.refusal;
    load_held += std::abs(found.load.mass.value - 2.1) <= found.load.mass.half_width;
  }
  tally.Expect();
  EXPECT_GE(load_held, seeds > 20 ? 0.9 * static_cast<double>(seeds) : 1);
  RecordProperty("intervals", tally.intervals);
  RecordProperty("held", tally.held);
}

// The residuals are correlated, as changes in the temperature of a gear would cause. The residuals
// have a correlation time of 0.5 s and a standard deviation of 0.1 N·m.
TEST_F(IdentifyTest, IntervalsCountWhatNeighbouringResidualsHaveInCommonSoak) {
  Tally tally;
  double widening = 0;
  const long seeds = Count(1, 25);
  for (long seed = 1; seed <= seeds; ++seed) {
    const RealCobot real = DrawRealCobot(kJoints, static_cast<std::uint64_t>(seed));
    RandomStream random(real.seed, "drift");
    const double pole = std::exp(-0.001 / 0.5);
    std::array<double, kJoints> drift = {};
    Identifier with(nominal_), without(nominal_);
    Excite(real, [&](TickRecord record) {
      without.Add(record);
      for (std::size_t j = 0; j < kJoints; ++j) {
        drift[j] = pole * drift[j] + std::sqrt(1 - pole * pole) * 0.1 * random.Normal();
        record.cobot_torque[j] += drift[j];
      }
      with.Add(record);
    });
    const Identification found = with.Finish();
    tally.Add(found, real);
    widening += found.joints[3].viscous.half_width / without.Finish().joints[3].viscous.half_width /
                static_cast<double>(seeds);
  }
  tally.Expect(0.05 * tally.intervals);
  // The correlation makes the residuals' window means 4 times as large, and the interval must grow
  // by a larger factor.
  EXPECT_GT(widening, 6);
}

TEST_F(IdentifyTest, AJointThatDoesNotTurnIsRefusedTheOthersAreNot) {
  RealCobot real = DrawRealCobot(kJoints, 4);
  real.coulomb[6] = 200;  // the joint sticks
  Identifier identifier(nominal_);
  Excite(real, [&](const TickRecord& record) { identifier.Add(record); });
  const Identification found = identifier.Finish();
  EXPECT_FALSE(found.complete());
  const JointIdentification& stuck = found.joints[6];
  EXPECT_NE(stuck.refusal.find("panda_joint7"), std::string::npos) << stuck.refusal;
  EXPECT_NE(stuck.refusal.find("excite_cobot.yaml"), std::string::npos) << stuck.refusal;
  Tally tally;
  tally.Add(found, real);
  EXPECT_EQ(tally.intervals, 2 * (kJoints - 1)) << IdentificationText(found);
  tally.Expect();

  const Scenario written = WithFriction(nominal_, found);
  EXPECT_EQ(written.cobot.joint_friction.viscous[6], 1.0);  // unchanged
  EXPECT_EQ(written.cobot.joint_friction.coulomb[6], 0.0);
  EXPECT_EQ(written.cobot.joint_friction.viscous[0], found.joints[0].viscous.value);
  EXPECT_NE(IdentificationText(found).find("Not identified: \"panda_joint7\""), std::string::npos);
  EXPECT_NE(IdentificationJson(found).find("\"refusal\": \"\\\"panda_joint7"), std::string::npos);
}

TEST_F(IdentifyTest, FindsTheLoadAndPassesOverGaps) {
  Scenario other = nominal_;  // assumes a different load
  other.object.model.clear();
  other.object.primitive = PrimitiveSpec{};
  other.object.primitive->size = {0.1, 0.6, 0.1};
  other.object.primitive->mass = 1;
  other.object.primitive->center_of_mass = {0, 0.05, 0.02};
  Identifier identifier(other);
  const RealCobot real = DrawRealCobot(kJoints, 5);
  Excite(real, [&](const TickRecord& record) {
    if (record.tick % 5000 > 300 && record.tick % 777 != 0) identifier.Add(record);
  });
  const Identification found = identifier.Finish();
  ASSERT_TRUE(found.load.identified()) << found.load.refusal;
  EXPECT_NEAR(found.load.mass.value, 2.1, 1.5 * found.load.mass.half_width);
  for (const Estimate& c : found.load.com) EXPECT_NEAR(c.value, 0, 1.5 * c.half_width);
  EXPECT_LT(found.load.mass.half_width, 0.3);
  Tally tally;
  tally.Add(found, real);
  tally.Expect();
}

// A damaged or hostile recording contains NaN, huge values, ticks in the wrong order, and a last
// tick in the far future. The identifier must not allocate memory for all ticks up to the last one.
TEST_F(IdentifyTest, LeavesOutWhatCannotBe) {
  Identifier identifier(nominal_);
  const RealCobot real = DrawRealCobot(kJoints, 5);
  std::uint64_t spoilt = 0;
  Excite(real, [&](TickRecord record) {
    if (record.tick > 50'000) record.tick += std::uint64_t{1} << 52U;
    identifier.Add(record);
    if (record.tick % 4000 != 0) return;
    TickRecord hostile = record;
    ++hostile.tick;
    if (record.tick % 8000 == 0) {
      hostile.cobot_torque[2] = std::nan("");
      ++spoilt;
    } else if (record.tick % 12000 == 0) {
      hostile.cobot_torque[2] = 1e300;
    } else {
      hostile.tick = 17;
    }
    identifier.Add(hostile);
  });
  const Identification found = identifier.Finish();
  EXPECT_GT(spoilt, 0U);
  EXPECT_EQ(found.not_finite, spoilt);
  EXPECT_NE(IdentificationText(found).find("OMITTED: " + std::to_string(spoilt) + " ticks"),
            std::string::npos);
  Tally tally;
  tally.Add(found, real);
  tally.Expect();
}

TEST_F(IdentifyTest, LinksFarFromTheirModelAreNoticed) {
  RealCobot real = DrawRealCobot(kJoints, 6);
  real.mass_error = 0.3;
  real.com_error = 0.03;
  Identifier identifier(nominal_);
  Excite(real, [&](const TickRecord& record) { identifier.Add(record); });
  const Identification found = identifier.Finish();
  EXPECT_TRUE(found.strained) << found.strain;
  EXPECT_FALSE(found.load.identified());
  Tally tally;  // the friction is identified nevertheless
  tally.Add(found, real);
  tally.Expect();
}

// This test needs no simulation, because the identifier uses only the positions in the records.
TEST_F(IdentifyTest, OneSpeedIsNotEnough) {
  Identifier identifier(nominal_);
  TickRecord record{};
  record.cobot_dof = kJoints;
  record.ran = 1;
  record.object.pose.q[0] = record.end_effector.pose.q[0] = 1;
  for (std::uint64_t k = 0; k < 20000; ++k) {
    record.tick = k + 1;
    const double phase = std::fmod(0.001 * static_cast<double>(k), 4.0);
    record.cobot_q[2] = 0.2 * std::abs(phase - 2);  // back and forth at 0.2 rad/s
    identifier.Add(record);
  }
  const Identification found = identifier.Finish();
  EXPECT_NE(found.joints[2].refusal.find("same speed"), std::string::npos)
      << found.joints[2].refusal;
  EXPECT_NE(found.joints[0].refusal.find("moved backward for 0 s"), std::string::npos)
      << found.joints[0].refusal;
}

TEST_F(IdentifyTest, ReportsUnusableData) {
  Identifier identifier(nominal_);
  EXPECT_THROW(identifier.Finish(), InputError);  // no data yet
  TickRecord record{};
  record.cobot_dof = 6;
  identifier.Add(record);
  try {
    identifier.Finish();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("6 joints"), std::string::npos) << error.what();
  }
}

TEST_F(IdentifyTest, ClosesTheLoopOfTheCircleSoak) {
  IdentifyLoopOptions options;
  options.seeds = static_cast<int>(Count(2, 17));
  options.folder = folder_;
  const IdentifyLoopResult result =
      IdentifyLoop(Load("excite_cobot.yaml"), Load("bar_circle.yaml"), options);
  int forces = 0;
  for (const AxisAgreement& a : result.axes) {
    if (a.unit != "N") continue;
    ++forces;
    EXPECT_LT(a.after.rmse, 0.6 * a.before.rmse) << a.name;
    EXPECT_GT(a.after.correlation, a.before.correlation) << a.name;
    // Emulated and real runs must agree about as well as two real runs do.
    EXPECT_LT(a.after.rmse, 2 * a.repeat.rmse) << a.name;
    EXPECT_FALSE(a.indistinguishable_before()) << a.name;
  }
  EXPECT_EQ(forces, 6);
}

}  // namespace
}  // namespace predictor
