// Recordings computed again.
#include "analysis/verify.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "recording/provenance.h"
#include "recording/writer.h"
#include "scenario/scenario_io.h"
#include "support/soak.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

class VerifyTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "verify-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    scenario_ =
        LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml", {"duration=4"});
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Records the scenario with a state each second; `look` may change a record, or drop it (false).
  std::string Record(const std::function<bool(TickRecord*)>& look) {
    const std::string file = folder_ / "run.mcap";
    Emulator emulator(scenario_);
    RecordingWriter writer(file, DescribeRun(scenario_, "1", {}));
    std::vector<std::byte> state(kStateBytes);
    Simulate(&emulator, scenario_.duration, [&](const TickRecord& tick) {
      TickRecord record = tick;
      if (look(&record)) writer.Add(record);
      if (record.tick % 1000 == 0)
        writer.AddSnapshot(record.tick, std::span(state).first(emulator.SaveState(state)));
    });
    writer.Close();
    return file;
  }
  Verification VerifyFile(const std::string& file) {
    RecordingReader reader(file);
    fs::create_directories(folder_ / "restored");
    return Verify(&reader, RestoreScenario(reader.header(), folder_ / "restored"),
                  [](std::uint64_t) {});
  }

  fs::path folder_;
  Scenario scenario_;
};

TEST_F(VerifyTest, ARunIsTheSameAgain) {
  const Verification result = VerifyFile(Record([](TickRecord*) { return true; }));
  EXPECT_GT(result.ticks, 4000U);
  EXPECT_FALSE(result.departure);
  EXPECT_EQ(result.missing + result.skipped, 0U);
}

// In the soak to their ends; those that stop always to their stop.
TEST_F(VerifyTest, EveryScenarioIsTheSameAgainSoak) {
  int scenarios = 0;
  for (const auto& entry :
       fs::directory_iterator(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios")) {
    if (entry.path().extension() != ".yaml") continue;
    scenario_ = LoadScenario(entry.path());
    const bool stops = entry.path().stem() == "push" || entry.path().stem() == "underdamped";
    const long most = stops ? 1000 : Count(3, 1000);
    scenario_.duration = std::min<double>(scenario_.duration, static_cast<double>(most));
    bool stopped = false;
    const Verification result = VerifyFile(Record([&](TickRecord* record) {
      stopped = stopped || record->cause != StopCause::kNone;
      return true;
    }));
    EXPECT_FALSE(result.departure) << entry.path();
    EXPECT_EQ(stopped, stops) << entry.path();
    EXPECT_GT(result.ticks, 2000U) << entry.path();
    fs::remove(folder_ / "run.mcap");
    ++scenarios;
  }
  EXPECT_GE(scenarios, 8);
}

TEST_F(VerifyTest, TheLastBitOfOneNumberIsFound) {
  const Verification result = VerifyFile(Record([](TickRecord* record) {
    if (record->tick == 3210) record->cobot_q[2] = std::nextafter(record->cobot_q[2], 1e9);
    return true;
  }));
  ASSERT_TRUE(result.departure);
  EXPECT_EQ(result.departure->tick, 3210U);
  EXPECT_EQ(result.departure->field, "cobot.q[2]");
  EXPECT_NE(result.departure->recorded, result.departure->computed);
}

// Inputs that were made up lead elsewhere.
TEST_F(VerifyTest, AnInputThatWasNotGivenIsFound) {
  const Verification result = VerifyFile(Record([](TickRecord* record) {
    if (record->tick == 2500) {
      record->input_count = 1;
      record->inputs[0].kind = InputKind::kParameter;
      record->inputs[0].parameter = Parameter::kDampingRatio;
      record->inputs[0].value = 0.8;
    }
    return true;
  }));
  ASSERT_TRUE(result.departure);
  EXPECT_GE(result.departure->tick, 2500U);
  EXPECT_LE(result.departure->tick, 2503U);
}

TEST_F(VerifyTest, AfterAGapItGoesOnFromTheNextState) {
  const Verification result = VerifyFile(
      Record([](TickRecord* record) { return record->tick < 1500 || record->tick >= 1600; }));
  EXPECT_FALSE(result.departure);
  EXPECT_EQ(result.missing, 100U);
  EXPECT_EQ(result.skipped, 401U);  // to 2000, after which there is a state
  EXPECT_GT(result.ticks, 3000U);
}

}  // namespace
}  // namespace predictor
