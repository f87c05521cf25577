// Tests the oscillation index of a force, the energy through a port, and the metrics based on them.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "evaluation/oscillation_index.h"
#include "evaluation/port_energy.h"
#include "evaluation/summary.h"

namespace predictor {
namespace {

// The force has a slow component and a tremor at f, so the tremor's share is known.
TEST(OscillationIndex, IsThePartOfThePowerFromThreeToTenHertz) {
  for (const double f : {4.0, 6.25, 9.0}) {
    OscillationIndex index(0.001);
    std::vector<OscillationIndex::Window> windows;
    for (int i = 0; i < 9'000; ++i) {
      const double t = 1e-3 * i;
      const Vector3 force(3 * std::sin(2 * M_PI * t), 2 * std::cos(2 * M_PI * f * t), 7);
      if (const auto* window = index.Add(t, force)) windows.push_back(*window);
    }
    ASSERT_EQ(windows.size(), 3u);
    for (const auto& window : windows) {
      EXPECT_NEAR(window.index, 4.0 / (4 + 9), 0.01) << f;
      EXPECT_NEAR(window.rms, 2 / std::sqrt(2), 0.02) << f;
      EXPECT_NEAR(window.total, std::sqrt(6.5), 0.03) << f;
    }
    EXPECT_NEAR(windows[1].time, 4, 0.01);
  }
}

TEST(PortEnergy, MeasuresTheReturnedEnergyAndTheLowestSum) {
  PortEnergy port;
  for (int i = 0; i < 1000; ++i) port.Add(2, 0.001);
  for (int i = 0; i < 1000; ++i) port.Add(-3, 0.001);
  for (int i = 0; i < 1000; ++i) port.Add(4, 0.001);
  EXPECT_NEAR(port.sum, 3, 1e-9);
  EXPECT_NEAR(port.lowest, -1, 1e-9);
  EXPECT_NEAR(port.returned, 3, 1e-9);
  EXPECT_EQ(port.peak_return, 3);
  EXPECT_EQ(port.episodes, 1);
}

// Summarises `seconds` of records in RUN in which the left hand exerts force(t) along x while it
// moves at 0.5 m/s.
Summary OfForce(
    double seconds, const std::function<double(double)>& force,
    const std::function<void(TickRecord*)>& change = [](TickRecord*) {}) {
  SummaryBuilder builder((Scenario()));
  for (int i = 0; i < std::lround(1e3 * seconds); ++i) {
    TickRecord record{};
    record.tick = static_cast<std::uint64_t>(i) + 1;
    record.ran = 1;
    record.run_time = 1e-3 * i;
    record.hands[0].present = 1;
    record.hands[0].wrench[0] = force(record.run_time);
    record.hands[0].real.twist[0] = 0.5;
    change(&record);
    builder.Add(record);
  }
  return builder.summary();
}

TEST(Metrics, ContainTheOscillationOfEachHand) {
  const auto force = [](double t) {
    return 3 * std::sin(2 * M_PI * t) + 2 * std::sin(2 * M_PI * 5 * t);
  };
  const Summary summary = OfForce(6, force);
  EXPECT_NEAR(summary.Get<double>("oscillation.left.index"), 4.0 / 13, 0.01);
  EXPECT_NEAR(summary.Get<double>("oscillation.left.rms_n"), std::sqrt(2.0), 0.02);
  EXPECT_TRUE(IsMissing(summary.At("oscillation.left.strong_index").value));  // 2.5 N
  EXPECT_TRUE(IsMissing(summary.At("oscillation.right.index").value));
  EXPECT_TRUE(IsMissing(OfForce(3, force).At("oscillation.left.rms_n").value));  // no window
  // A window must not extend over a missing tick or a pause.
  const auto lost = OfForce(6, force, [](TickRecord* r) { r->tick += r->tick > 3000; });
  EXPECT_TRUE(IsMissing(lost.At("oscillation.left.rms_n").value));
  const auto paused = OfForce(6, force, [](TickRecord* r) { r->ran = r->tick != 3000; });
  EXPECT_TRUE(IsMissing(paused.At("oscillation.left.rms_n").value));
}

TEST(Metrics, ContainTheEnergyOfBothHands) {
  const Summary summary = OfForce(
      3, [](double t) { return t < 1   ? 4
                               : t < 2 ? -6
                                       : 8; },
      [](TickRecord* r) {
        if (r->tick > 2000) r->ran = 0;  // a pause, then braking
        if (r->tick > 2500) r->state = RunState::kStopping;
      });
  EXPECT_NEAR(summary.Get<double>("energy.supplied_j"), 2 - 3 + 2, 0.01);
  EXPECT_NEAR(summary.Get<double>("energy.lowest_j"), -1, 0.01);
  EXPECT_NEAR(summary.Get<double>("energy.returned_j"), 3, 0.01);
  EXPECT_EQ(summary.Get<double>("energy.peak_return_w"), 3);
  EXPECT_EQ(summary.Get<std::uint64_t>("energy.episodes"), 1u);
}

TEST(Metrics, ContainTheDistanceFromTheGuidance) {
  Scenario scenario;
  scenario.guidance.type = "circle";
  scenario.guidance.center = {-0.2, 0, 0};
  scenario.guidance.radius = 0.2;
  SummaryBuilder builder(scenario);
  TickRecord record{};
  record.ran = 1;
  for (const double off : {0.0, 0.01, 0.03}) {  // outwards from the start, which is on the circle
    record.object.pose.p = {0.5 + off, 0.1, 0.4};
    builder.Add(record);
  }
  const Summary summary = builder.summary();
  EXPECT_NEAR(summary.Get<Statistics>("guidance.distance_m").max(), 0.03, 1e-12);
  EXPECT_NEAR(summary.Get<Statistics>("guidance.distance_m").mean(), 0.04 / 3, 1e-12);
  EXPECT_NE(SummaryTable(summary).find("distance from the path [mm]"), std::string::npos);
}

TEST(Metrics, CountLateTicksAndIterations) {
  const Summary summary = OfForce(
      0.1, [](double) { return 0; },
      [](TickRecord* r) {
        r->missed = r->tick == 40 ? 3 : r->tick == 60;
        r->rendered = r->tick > 98;
        r->qp_iterations = r->tick == 99 ? 4 : 8;
      });
  EXPECT_EQ(summary.Get<std::uint64_t>("deadlines.late_ticks"), 2u);
  EXPECT_EQ(summary.Get<std::uint64_t>("deadlines.most_in_a_row"), 3u);
  EXPECT_EQ(summary.Get<Statistics>("qp.iterations").mean(), 6);
  EXPECT_EQ(summary.Get<Statistics>("qp.iterations").max(), 8);
}

}  // namespace
}  // namespace predictor
