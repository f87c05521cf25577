// Tests the real-time loop: its end conditions, inputs and reports.
#include <gtest/gtest.h>

#include <thread>

#include "runs.h"

namespace predictor {
namespace {

struct Paced {
  explicit Paced(const std::string& scenario)
      : emulator(LoadTestScenario(scenario)), ring(std::make_unique<RecordRing>()) {}
  RunEnd Run(const RealTimeOptions& options) {
    return RunRealTime(&emulator, options, quit, ring.get(), &report);
  }
  Emulator emulator;
  std::unique_ptr<RecordRing> ring;
  std::atomic<bool> quit{false};
  RealTimeReport report;
};

TEST(RealTime, RunsItsTimeAndComesToRest) {
  Paced run("box_9kg");
  EXPECT_EQ(run.Run({0.5}), RunEnd::kFinished);
  EXPECT_EQ(run.emulator.state(), RunState::kHeld);
  EXPECT_EQ(run.emulator.record().cause, StopCause::kNone);
  EXPECT_NEAR(run.emulator.run_time(), 0.5, 1e-9);
  EXPECT_EQ(run.ring->written(), run.report.ticks);
  EXPECT_FALSE(run.report.scheduling.empty());
}

TEST(RealTime, EndsOnRequest) {
  Paced run("box_9kg");
  std::thread asks([&run] {
    TickRecord record;
    RingReader<TickRecord, kRecordRing> reader(*run.ring);
    while (!(reader.Next(&record) && record.state == RunState::kRun)) std::this_thread::yield();
    run.quit = true;
  });
  EXPECT_EQ(run.Run({3600, true}), RunEnd::kFinished);
  asks.join();
  EXPECT_EQ(run.emulator.state(), RunState::kHeld);
}

// A stop request arrives through the mailbox. The loop must continue to tick until its end is
// requested.
TEST(RealTime, AcceptsAStopAndStaysHeld) {
  Paced run("box_9kg");
  Shared<RunMailbox> mailbox;
  std::thread page([&run, &mailbox] {
    TickRecord record;
    RingReader<TickRecord, kRecordRing> reader(*run.ring);
    const auto await = [&](RunState state) {
      while (!(reader.Next(&record) && record.state == state)) std::this_thread::yield();
    };
    await(RunState::kRun);
    // A full queue must not delay a stop request.
    while (mailbox->inputs.Push({})) {
    }
    mailbox->stop_client = 7;
    ++mailbox->stops;
    while (!(reader.Next(&record) && record.input_count > 0 &&
             record.inputs[0].kind == InputKind::kStop))
      std::this_thread::yield();
    EXPECT_EQ(record.inputs[0].client, 7u);
    await(RunState::kHeld);
    const std::uint64_t tick = record.tick;
    while (!(reader.Next(&record) && record.tick > tick + 20)) std::this_thread::yield();
    run.quit = true;
  });
  EXPECT_EQ(run.Run({3600, true, &*mailbox}), RunEnd::kStopped);
  page.join();
  EXPECT_EQ(run.emulator.record().cause, StopCause::kOperator);
  EXPECT_EQ(run.emulator.record().state, RunState::kHeld);
}

// Unity's clients have a separate mailbox that accepts only stop requests.
TEST(RealTime, AcceptsAStopFromRosTcp) {
  Paced run("box_9kg");
  Shared<StopMailbox> stops;
  std::thread unity([&run, &stops] {
    TickRecord record;
    RingReader<TickRecord, kRecordRing> reader(*run.ring);
    while (!(reader.Next(&record) && record.state == RunState::kRun)) std::this_thread::yield();
    ++stops->stops;
  });
  RealTimeOptions options;
  options.duration = 3600;
  options.stops = &*stops;
  EXPECT_EQ(run.Run(options), RunEnd::kStopped);
  unity.join();
  EXPECT_EQ(run.emulator.record().cause, StopCause::kOperator);
}

// If the headset of a wearer falls silent, the run must stop, but only in motion and only with real
// arms. The record must show the cause.
TEST(RealTime, StopsForAHeadsetThatFellSilent) {
  Shared<RunMailbox> mailbox;
  mailbox->immersive = 1;
  mailbox->immersive_frame_ns = 1;  // far in the past
  Paced watched("box_9kg");
  EXPECT_EQ(watched.Run({3600, false, &*mailbox, true, true}), RunEnd::kStopped);
  const TickRecord& record = watched.emulator.record();
  EXPECT_EQ(record.cause, StopCause::kHeadset);
  EXPECT_EQ(record.cause_quantity, Quantity::kTime);
  EXPECT_GT(record.cause_value, kHeadsetSilence);
  EXPECT_EQ(record.cause_limit, kHeadsetSilence);

  Paced simulated("box_9kg");
  EXPECT_EQ(simulated.Run({0.1, false, &*mailbox, true, false}), RunEnd::kFinished);
  mailbox->immersive = 0;
  Paced without("box_9kg");
  EXPECT_EQ(without.Run({0.1, false, &*mailbox, true, true}), RunEnd::kFinished);
}

// After a session has ended, its frames must no longer count as a sign of life.
TEST(RealTime, StopsWhenAWearerTakesTheHeadsetOffInMotion) {
  Paced run("box_9kg");
  Shared<RunMailbox> mailbox;
  mailbox->immersive = 1;
  mailbox->immersive_frame_ns = UINT64_MAX;  // later than any time, so never silent
  std::thread page([&run, &mailbox] {
    TickRecord record;
    RingReader<TickRecord, kRecordRing> reader(*run.ring);
    while (!(reader.Next(&record) && record.run_time > 0.1)) std::this_thread::yield();
    mailbox->immersive_frame_ns = record.wall_ns;  // the last frame
  });
  EXPECT_EQ(run.Run({3600, false, &*mailbox, true, true}), RunEnd::kStopped);
  page.join();
  EXPECT_EQ(run.emulator.record().cause, StopCause::kHeadset);
  EXPECT_GT(run.emulator.run_time(), 0.1);
}

// The program may move the arms only while the watchdog runs.
TEST(RealTime, StopsWhereTheWatchdogIsSilent) {
  Paced run("box_9kg");
  std::atomic<std::uint32_t> beats{0};
  std::thread watchdog([&] {
    TickRecord record;
    RingReader<TickRecord, kRecordRing> reader(*run.ring);
    while (!(reader.Next(&record) && record.run_time > 0.2)) {
      ++beats;
      std::this_thread::yield();
    }
  });
  RealTimeOptions options;
  options.duration = 3600;
  options.watchdog = &beats;
  EXPECT_EQ(run.Run(options), RunEnd::kStopped);
  watchdog.join();
  const TickRecord& record = run.emulator.record();
  EXPECT_EQ(record.cause, StopCause::kWatchdog);
  EXPECT_EQ(record.cause_quantity, Quantity::kTime);
  EXPECT_GT(record.cause_value, kWatchdogSilence);
  EXPECT_EQ(record.cause_limit, kWatchdogSilence);
  EXPECT_GT(run.emulator.run_time(), 0.2);
}

// Another process can write to the mailbox, so the loop itself must check whether the switch is
// allowed.
TEST(RealTime, AcceptsAnotherScenarioOnlyInPermittedStates) {
  for (const bool choose : {false, true}) {
    Paced run("box_9kg");
    Shared<RunMailbox> mailbox;
    std::thread page([&run, &mailbox] {
      TickRecord record;
      RingReader<TickRecord, kRecordRing> reader(*run.ring);
      while (!(reader.Next(&record) && record.state == RunState::kIdle)) std::this_thread::yield();
      RunInput input;
      input.kind = InputKind::kScenario;
      input.value = 3;
      mailbox->inputs.Push(input);
      const std::uint64_t tick = record.tick;
      for (int k = 0; k < 2000 && !(reader.Next(&record) && record.tick > tick + 50); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      run.quit = true;
    });
    RealTimeOptions options{3600, true, &*mailbox, false};
    options.allow_scenario_switch = choose;
    run.Run(options);
    page.join();
    EXPECT_EQ(run.report.scenario, choose ? std::optional<std::size_t>(3) : std::nullopt);
  }
}

}  // namespace
}  // namespace predictor
