#include "commissioning/session.h"

#include <gtest/gtest.h>

#include "commissioning/loop_record.h"
#include "commissioning/rig_station.h"

namespace predictor::commissioning {
namespace {

constexpr std::uint64_t kPeriod = 1'000'000;  // period of the robot's states and of the session's
                                              // steps [ns]

// In this virtual time, every wait ends late.
class LateTime final : public VirtualTime {
 public:
  LateTime() { Work(300e-6); }
  void Wait(double time) override { Work(time + 60e-6); }
  void Work(double time) { VirtualTime::Wait(time); }
};

TEST(SessionPace, LateWakingAndWorkLoseNoStatesOfARobot) {
  constexpr int kSteps = 10'000;
  LateTime time;
  ScriptedPerson person([&](const std::string&) {
    time.Work(200e-6);
    return static_cast<char>(0);
  });
  Session session(&time, &person, {});
  session.Step();
  LoopRecorder recorder(0, 1e-9 * kPeriod);
  std::uint64_t last = 0;
  const std::uint64_t begin = time.Now();
  session.OnStep([&](bool) -> std::string {
    const std::uint64_t state = time.Now() / kPeriod;
    if (state != last) recorder.AddSample(1e-9 * static_cast<double>(state * kPeriod), 0);
    last = state;
    recorder.AddCommand(session.due(), session.Now(), 0);
    return "";
  });
  for (int k = 0; k < kSteps; ++k) session.Step();
  EXPECT_EQ(time.Now() - begin, kSteps * kPeriod);
  const Gaps gaps = std::move(recorder).Finish().gaps;
  EXPECT_EQ(gaps.samples, kSteps);
  EXPECT_EQ(gaps.lost, 0);
  EXPECT_EQ(gaps.late, 0);
}

TEST(SessionPace, StepsThatAreOverAreSkippedNotMadeUpFor) {
  LateTime time;
  int step = 0;
  ScriptedPerson person([&](const std::string&) {
    time.Work(++step == 5 ? 3.7e-3 : 200e-6);
    return static_cast<char>(0);
  });
  Session session(&time, &person, {});
  std::vector<std::uint64_t> periods;
  std::vector<double> due;
  session.OnStep([&](bool) -> std::string {
    periods.push_back(time.Now() / kPeriod);
    due.push_back(session.due());
    return "";
  });
  for (int k = 0; k < 10; ++k) session.Step();
  for (std::size_t k = 1; k < periods.size(); ++k)
    EXPECT_EQ(periods[k] - periods[k - 1], k == 5 ? 4u : 1u) << k;
  // A late wake-up must not shift the deadlines.
  for (std::size_t k = 1; k < due.size(); ++k)
    EXPECT_NEAR(due[k] - due[k - 1], k == 5 ? 0.004 : 0.001, 1e-9) << k;
}

}  // namespace
}  // namespace predictor::commissioning
