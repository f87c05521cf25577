// Tests the evaluator's process: its output, its rights, and what happens when it dies.
#include "support/process.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <mutex>
#include <set>
#include <thread>

#include "assessment/samples.h"
#include "core/error.h"
#include "evaluator/evaluator_process.h"
#include "scenario/scenario_io.h"

namespace predictor::evaluator {
namespace {

using assessment::RecordOf;
using test::Becomes;
using test::StatusOf;

// Returns a scenario whose operator has a body and stands where RecordOf needs it.
Scenario Box() {
  return LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
}

class EvaluatorProcessTest : public testing::Test {
 protected:
  void Start(const Scenario& scenario) {
    evaluator_ = std::make_unique<EvaluatorProcess>(scenario, board_, states_, &mailbox_, &streams_,
                                                    Described(), [this](const std::string& text) {
                                                      const std::lock_guard lock(mutex_);
                                                      reported_ += text + "\n";
                                                    });
  }
  void Run(std::uint64_t first, std::uint64_t last, double height = 1) {
    for (std::uint64_t tick = first; tick <= last; ++tick) {
      TickRecord record = RecordOf(tick, height, 20);
      record.wall_ns = WallOf(tick);
      board_->records.Publish(record);
    }
  }
  static std::uint64_t WallOf(std::uint64_t tick) { return 5'000'000'000 + 1'000'000 * tick; }
  static std::vector<tracks::StreamDescription> Described() {
    tracks::StreamDescription elbow{.name = "elbow", .rate = 100};
    elbow.channels = {"left_elbow.p.x", "left_elbow.p.y", "left_elbow.p.z"};
    elbow.units = {"m", "m", "m"};
    return {elbow, {.name = "watch", .rate = 1, .channels = {"pulse"}, .units = {"1/min"}}};
  }
  void Send(std::uint32_t stream, std::uint64_t tick, const std::vector<double>& values) {
    StreamSample sample{.wall_ns = WallOf(tick), .stream = stream};
    sample.count = static_cast<std::uint32_t>(values.size());
    std::ranges::copy(values, sample.values.begin());
    streams_->samples.Publish(sample);
  }
  // The left elbow hangs beside the trunk of the person, outwards from the handle.
  void SendElbowAt(std::uint64_t tick, double x = 0.75) { Send(0, tick, {x, -0.35, 0.15}); }
  static const InputState& Of(const PersonState& state, PersonInput input) {
    return state.inputs[static_cast<std::size_t>(input)];
  }
  // The person looks down at the handles.
  void MeasureHeadAt(std::uint64_t tick) {
    HeadRecord head;
    head.wall_ns = WallOf(tick);
    head.p = {0.75, 0, 0.75};
    head.q = {0, 0, 0, 1};  // looks along -x
    mailbox_->heads.Publish(head);
  }
  // Returns the origins of the head in the states of the ticks `first` to `last`.
  std::set<HeadSource> HeadsOf(std::uint64_t first, std::uint64_t last) const {
    std::set<HeadSource> heads;
    PersonState state;
    for (std::uint64_t i = 0; i < (*states_).states.written(); ++i)
      if ((*states_).states.Get(i, &state) && state.tick >= first && state.tick <= last)
        heads.insert(state.head);
    return heads;
  }
  // Returns the newest state. Before the process has written the first state, the returned state
  // has tick 0.
  PersonState Newest() const {
    PersonState state;
    const std::uint64_t written = (*states_).states.written();
    if (written > 0) (*states_).states.Get(written - 1, &state);
    return state;
  }
  bool Reports(const std::string& text) {
    return Becomes([&] {
      const std::lock_guard lock(mutex_);
      return reported_.find(text) != std::string::npos;
    });
  }

  Shared<RunBoard> board_;
  Shared<EvaluationBoard> states_;
  Shared<RunMailbox> mailbox_;
  Shared<StreamBoard> streams_;
  std::mutex mutex_;
  std::string reported_;
  std::unique_ptr<EvaluatorProcess> evaluator_;
};

TEST_F(EvaluatorProcessTest, JudgesEachHundredthOfASecond) {
  Start(Box());
  Run(1, 500);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 500; }));
  EXPECT_EQ((*states_).states.written(), 50u);
  const PersonState state = Newest();
  EXPECT_EQ(state.status, PersonStatus::kJudged);
  EXPECT_EQ(state.reached, 1);
  EXPECT_GT(state.gauges[0].value, 100);
  EXPECT_LT(state.gauges[0].low, state.gauges[0].value);
  EXPECT_GT(state.gauges[0].high, state.gauges[0].value);
}

// A head arrives later than its tick, so the evaluator waits for it.
TEST_F(EvaluatorProcessTest, UsesTheHeadThatArrivesAfterItsTick) {
  Start(Box());
  Run(1, 10);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 10; }));
  MeasureHeadAt(10);
  Run(11, 100);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  for (std::uint64_t tick = 40; tick <= 100; tick += 30) MeasureHeadAt(tick);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 100; }));
  EXPECT_EQ(HeadsOf(1, 10), std::set{HeadSource::kModelled});
  EXPECT_EQ(HeadsOf(20, 100), std::set{HeadSource::kMeasured});
  EXPECT_EQ((*states_).states.written(), 10u);  // no state was left out
}

TEST_F(EvaluatorProcessTest, ModelsTheHeadAgainWhenTheHeadsetFallsSilent) {
  Start(Box());
  for (std::uint64_t tick = 0; tick <= 100; tick += 20) MeasureHeadAt(tick);
  Run(1, 100);
  // The last tick is more than 0.3 s after the last head.
  Run(101, 410);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 410; }));
  EXPECT_EQ(HeadsOf(10, 100), std::set{HeadSource::kMeasured});
  EXPECT_EQ(HeadsOf(110, 410), std::set{HeadSource::kModelled});
}

TEST_F(EvaluatorProcessTest, IgnoresAHeadFromAFarFuture) {
  Start(Box());
  MeasureHeadAt(100'000);
  Run(1, 50);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 50; }));
  for (std::uint64_t tick = 60; tick <= 120; tick += 20) MeasureHeadAt(tick);
  Run(51, 100);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 100; }));
  EXPECT_EQ(HeadsOf(80, 100), std::set{HeadSource::kMeasured});
}

TEST_F(EvaluatorProcessTest, PutsTheElbowWhereAStreamMeasuresIt) {
  Start(Box());
  for (std::uint64_t tick = 0; tick <= 300; tick += 10) SendElbowAt(tick);
  Run(1, 300);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 300; }));
  const PersonState state = Newest();
  EXPECT_EQ(Of(state, PersonInput::kLeftElbow).status, InputStatus::kMeasured);
  EXPECT_EQ(Of(state, PersonInput::kRightElbow).status, InputStatus::kNone);
  const auto& elbow = state.points[static_cast<std::size_t>(BodyPoint::kLeftElbow)];
  EXPECT_NEAR(elbow[0], 0.75, 0.05);
  EXPECT_NEAR(elbow[1], -0.35, 0.05);
  EXPECT_NEAR(elbow[2], 0.15, 0.05);
}

TEST_F(EvaluatorProcessTest, SaysSinceWhenAStreamIsSilent) {
  Start(Box());
  for (std::uint64_t tick = 0; tick <= 100; tick += 10) SendElbowAt(tick);
  Run(1, 600);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 600; }));
  EXPECT_EQ(Of(Newest(), PersonInput::kLeftElbow).status, InputStatus::kMissing);
  EXPECT_NEAR(Of(Newest(), PersonInput::kLeftElbow).last, 0.1, 0.02);
  EXPECT_EQ(Of(Newest(), PersonInput::kHeartRate).status, InputStatus::kMissing);
  EXPECT_TRUE(std::isnan(Of(Newest(), PersonInput::kHeartRate).last));
}

TEST_F(EvaluatorProcessTest, ShowsTheHeartRateUntilItIsOld) {
  Start(Box());
  Run(1, 100);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 100; }));
  Send(1, 100, {71});
  Run(101, 1000);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 1000; }));
  EXPECT_EQ(Newest().heart_rate, 71);
  Run(1001, 5200);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 5200; }));
  EXPECT_TRUE(std::isnan(Newest().heart_rate));
  EXPECT_EQ(Of(Newest(), PersonInput::kHeartRate).status, InputStatus::kMissing);
  EXPECT_NEAR(Of(Newest(), PersonInput::kHeartRate).last, 0.1, 0.02);
}

// Another process wrote the samples, so they may contain anything.
TEST_F(EvaluatorProcessTest, IgnoresSamplesThatCannotBeTrue) {
  Start(Box());
  Send(7, 5, {1});             // unknown stream
  Send(0, 5, {1, 2});          // wrong number of channels
  Send(1, 5, {std::nan("")});  // missing
  Send(1, 6, {INFINITY});      // not a number
  Send(1, 900'000, {60});      // from a far future
  for (std::uint64_t tick = 0; tick <= 100; tick += 10) SendElbowAt(tick, 40);  // far away
  Run(1, 500);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 500; }));
  EXPECT_TRUE(std::isnan(Newest().heart_rate));
  EXPECT_EQ(Newest().status, PersonStatus::kJudged);
  EXPECT_LT(Newest().points[static_cast<std::size_t>(BodyPoint::kLeftElbow)][0], 2);
}

TEST_F(EvaluatorProcessTest, HasNoRightsAndWritesItsStatesOnly) {
  Start(Box());
  const int pid = evaluator_->pid();
  EXPECT_EQ(StatusOf(pid, "NoNewPrivs"), "1");
  EXPECT_EQ(getpriority(PRIO_PROCESS, static_cast<id_t>(pid)), 10);
  if (geteuid() == 0) {
    EXPECT_EQ(StatusOf(pid, "Uid"), "65534\t65534\t65534\t65534");
    EXPECT_EQ(StatusOf(pid, "CapEff"), "0000000000000000");
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (!StatusOf(getpid(), "Seccomp").empty()) {
    EXPECT_EQ(StatusOf(pid, "Seccomp"), "2");
  }
#endif
  std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
  int writable = 0;
  for (std::string line; std::getline(maps, line);)
    if (line.find("memfd:predictor") != std::string::npos)
      writable += line.find(" rw-s ") != std::string::npos;
  if (geteuid() == 0) {
    EXPECT_EQ(writable, 1);
  }
}

TEST_F(EvaluatorProcessTest, ItsDeathIsReportedAndItRestarts) {
  Start(Box());
  Run(1, 200);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 200; }));
  const int pid = evaluator_->pid();
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  EXPECT_TRUE(Reports("The evaluator has ended (signal 9); the run continues."));
  ASSERT_TRUE(Becomes([&] { return evaluator_->pid() != 0 && evaluator_->pid() != pid; }));
  Run(201, 400);
  ASSERT_TRUE(Becomes([&] { return Newest().tick == 400; }));
  EXPECT_NEAR(Newest().since, 0.206, 1e-9);  // damage and fatigue start from zero again
}

TEST_F(EvaluatorProcessTest, EndsWithTheRun) {
  Start(Box());
  const int pid = evaluator_->pid();
  evaluator_.reset();
  EXPECT_NE(kill(pid, 0), 0);
}

TEST_F(EvaluatorProcessTest, ReportsWhatIsMissingOrImpossible) {
  Scenario scenario = Box();
  scenario.operator_.stance.reset();
  EXPECT_THROW(Start(scenario), InputError);
}

// A process with this descriptor must be able to read the states but not to change them.
TEST(EvaluationBoard, CanBeGivenAwayReadOnly) {
  const Shared<EvaluationBoard> states;
  const int descriptor = states.read_only_descriptor();
  EXPECT_EQ(
      mmap(nullptr, sizeof(EvaluationBoard), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0),
      MAP_FAILED);
  Shared<EvaluationBoard> reader(dup(descriptor), false);
  EXPECT_EQ(reader->states.written(), 0u);
}

}  // namespace
}  // namespace predictor::evaluator
