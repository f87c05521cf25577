// Tests that the complete state can be saved and restored between two ticks, and that runs can be
// repeated from their records.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "core/error.h"
#include "emulator/repeat.h"
#include "runs.h"
#include "support/allocation_guard.h"
#include "support/soak.h"
#include "support/test_name.h"

namespace predictor {
namespace {

struct StateAfter {
  std::size_t next;  // index of the record after it
  std::vector<std::byte> bytes;
};

struct RecordedRun {
  std::vector<TickRecord> records;
  std::vector<StateAfter> states;
};

std::vector<std::byte> Save(Emulator* emulator) {
  std::vector<std::byte> bytes(kStateBytes);
  bytes.resize(emulator->SaveState(bytes));
  EXPECT_GT(bytes.size(), 1000U);
  return bytes;
}

// Submits the inputs that a page sends. The inputs are parameters that change back and forth, a
// moving hand, and latencies.
void PutIn(int k, Emulator* emulator) {
  RunInput input;
  if (k % 700 == 350) {
    input.kind = InputKind::kParameter;
    input.parameter = static_cast<Parameter>(k / 700 % kParameters);
    input.value = k % 1400 < 700 ? 0.8 : 0.9;
    emulator->Submit(input);
  }
  if (k % 11 == 0) {
    input.kind = InputKind::kHand;
    input.hand = static_cast<std::uint8_t>(k / 11 % 2);
    input.grip = k % 3000 < 2500;
    input.p = emulator->record().hands[input.hand].virtual_.pose.p;
    input.q = emulator->record().hands[input.hand].virtual_.pose.q;
    input.p[2] += 0.02 * (k / 2000 % 3);
    emulator->Submit(input);
  }
}

RecordedRun Record(const Scenario& scenario, int ticks) {
  RecordedRun run;
  Emulator emulator(scenario);
  for (int k = 0; k < ticks; ++k) {
    if (scenario.operator_.type == "browser") PutIn(k, &emulator);
    emulator.Tick();
    run.records.push_back(emulator.record());
    if (k % 1709 == 250) run.states.push_back({run.records.size(), Save(&emulator)});
    const RunState state = emulator.state();
    if (state == RunState::kStopping && run.records[run.records.size() - 2].state != state)
      run.states.push_back({run.records.size(), Save(&emulator)});
    if (state == RunState::kHeld && k % 300 == 0) emulator.Request(RunEvent::kReset);
    AutoStart(&emulator);
  }
  return run;
}

class StateTest : public testing::TestWithParam<std::pair<const char*, std::vector<std::string>>> {
};

TEST_P(StateTest, ARunRepeatsFromItsRecordsAndFromAnyOfItsStates) {
  const Scenario scenario = LoadTestScenario(GetParam().first, GetParam().second);
  const RecordedRun run = Record(scenario, 13'000);
  Emulator again(scenario);
  for (const TickRecord& record : run.records) {
    Repeat(record, &again);
    ASSERT_TRUE(SameTick(record, again.record())) << "tick " << record.tick;
  }
  ASSERT_GE(run.states.size(), 7U);
  for (const StateAfter& state : run.states) {
    again.LoadState(state.bytes);
    const std::size_t end = std::min(run.records.size(), state.next + 2000);
    for (std::size_t k = state.next; k < end; ++k) {
      Repeat(run.records[k], &again);
      ASSERT_TRUE(SameTick(run.records[k], again.record()))
          << "tick " << run.records[k].tick << ", " << k - state.next << " after the state";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenarios, StateTest,
    testing::Values(std::pair{"box_9kg", std::vector<std::string>{}},
                    std::pair{"box_9kg", std::vector<std::string>{"mode=direct"}},
                    std::pair{"box_9kg", std::vector<std::string>{"operator.embodied=true"}},
                    std::pair{"box_9kg",
                              std::vector<std::string>{"cobot.controller.type=joint_impedance",
                                                       "cobot.controller.joint_stiffness=200"}},
                    std::pair{"push", std::vector<std::string>{}},
                    std::pair{"underdamped", std::vector<std::string>{}},
                    std::pair{"push_boxes", std::vector<std::string>{}},
                    std::pair{"lift_crates", std::vector<std::string>{}},
                    std::pair{"bar_circle", std::vector<std::string>{}},
                    std::pair{"single_arm", std::vector<std::string>{}},
                    std::pair{"dual_ur5", std::vector<std::string>{}},
                    std::pair{"by_hand", std::vector<std::string>{}}),
    [](const auto& state) {
      std::string name = state.param.first;
      for (const std::string& set : state.param.second) name += "_" + set;
      return test::TestName(name);
    });

TEST_P(StateTest, LoadsIntoOneThatNeverTicked) {
  const Scenario scenario = LoadTestScenario(GetParam().first, GetParam().second);
  Emulator emulator(scenario), fresh(scenario);
  for (int k = 0; k < 1500; ++k) emulator.Tick(), AutoStart(&emulator);
  const std::vector<std::byte> state = Save(&emulator);
  fresh.LoadState(state);
  EXPECT_EQ(Save(&fresh), state);
}

// Uninitialised bytes would make the states of equal runs differ, and the emulator could refuse
// them as NaN.
TEST_P(StateTest, ContainsOnlyWhatWasWritten) {
  const Scenario scenario = LoadTestScenario(GetParam().first, GetParam().second);
  std::vector<std::byte> states[2];
  for (int k = 0; k < 2; ++k) {
    mallopt(M_PERTURB, k == 0 ? 0x80 : 0x01);  // fill value for new memory
    Emulator emulator(scenario);
    states[k] = Save(&emulator);
  }
  mallopt(M_PERTURB, 0);
  ASSERT_EQ(states[0].size(), states[1].size());
  const auto differ = std::mismatch(states[0].begin(), states[0].end(), states[1].begin()).first;
  EXPECT_EQ(differ, states[0].end()) << "byte " << differ - states[0].begin();
}

TEST(State, AnotherPressureOnTheHandleIsNoticed) {
  const Scenario scenario = LoadTestScenario("by_hand");
  const RecordedRun run = Record(scenario, 4000);
  Emulator again(scenario);
  std::size_t first = 0;
  for (TickRecord record : run.records) {
    if (record.tick == 3003) record.inputs[0].p[2] += 1e-12;
    Repeat(record, &again);
    if (first == 0 && !SameTick(record, again.record())) first = record.tick;
  }
  EXPECT_GE(first, 3003U);
  EXPECT_LE(first, 3020U);
}

std::vector<TickRecord> RecordsAfter(const std::vector<std::byte>& state,
                                     std::optional<std::uint64_t> seed, Emulator* emulator) {
  emulator->LoadState(state, seed);
  std::vector<TickRecord> records;
  for (int k = 0; k < 1000; ++k) {
    emulator->Tick();
    records.push_back(emulator->record());
  }
  return records;
}

bool AreSame(const std::vector<TickRecord>& a, const std::vector<TickRecord>& b) {
  return std::ranges::equal(a, b, SameTick);
}

TEST(ReseededState, TwoSeedsGiveTwoRunsAndOneSeedRepeatsItsRun) {
  const Scenario scenario = LoadTestScenario("box_9kg");
  Emulator emulator(scenario), other(scenario);
  for (int k = 0; k < 3000; ++k) emulator.Tick(), AutoStart(&emulator);
  ASSERT_EQ(emulator.state(), RunState::kRun);
  const std::vector<std::byte> state = Save(&emulator);
  const auto saved = RecordsAfter(state, std::nullopt, &emulator);
  const auto one = RecordsAfter(state, 1, &emulator), two = RecordsAfter(state, 2, &emulator);
  EXPECT_FALSE(AreSame(one, two));
  EXPECT_FALSE(AreSame(one, saved));
  EXPECT_TRUE(AreSame(RecordsAfter(state, 1, &emulator), one));
  EXPECT_TRUE(AreSame(RecordsAfter(state, 1, &other), one));
  EXPECT_TRUE(AreSame(RecordsAfter(state, std::nullopt, &other), saved));
}

// The random streams are the 9 of each hand, the pace, and the force and velocity sensors of two
// arms. Each of them has four words of 8 bytes and a spare number. A byte keeps its value with a
// probability of 1/256.
TEST(ReseededState, EqualsTheSavedOneExceptForItsRandomStreams) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  for (int k = 0; k < 3000; ++k) emulator.Tick(), AutoStart(&emulator);
  const std::vector<std::byte> state = Save(&emulator);
  emulator.LoadState(state, 5);
  const std::vector<std::byte> reseeded = Save(&emulator);
  ASSERT_EQ(reseeded.size(), state.size());
  int changed = 0;
  for (std::size_t k = 0; k < state.size(); ++k) changed += state[k] != reseeded[k];
  const int streams = 2 * 9 + 1 + 2 * 2;
  EXPECT_GT(changed, streams * 30);
  EXPECT_LE(changed, streams * (32 + 8 + 1));
}

// Without noise, tremor and drift, no seed has an effect. Therefore a seed changes nothing else.
TEST(ReseededState, ContinuesTheSameRunIfNothingIsRandom) {
  Scenario scenario = LoadTestScenario("box_9kg");
  HandSpec& hand = scenario.operator_.hand;
  hand.force_noise = hand.force_noise_floor = hand.tremor_force = hand.speed_drift = 0;
  scenario.rig.velocity_noise = 0;
  for (ArmSpec* arm : {&*scenario.device.left, &*scenario.device.right})
    arm->sensor.noise_force = arm->sensor.noise_torque = 0;
  Emulator emulator(scenario);
  for (int k = 0; k < 3000; ++k) emulator.Tick(), AutoStart(&emulator);
  ASSERT_EQ(emulator.state(), RunState::kRun);
  const std::vector<std::byte> state = Save(&emulator);
  const auto saved = RecordsAfter(state, std::nullopt, &emulator);
  EXPECT_TRUE(AreSame(RecordsAfter(state, 1, &emulator), saved));
  EXPECT_TRUE(AreSame(RecordsAfter(state, 2, &emulator), saved));
}

TEST(State, SavingDoesNotAllocateAndFits) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  for (int k = 0; k < 2000; ++k) emulator.Tick(), AutoStart(&emulator);
  std::vector<std::byte> bytes(kStateBytes);
  std::size_t size = 0;
  {
    const test::AllocationGuard guard;
    size = emulator.SaveState(bytes);
    EXPECT_EQ(guard.count(), 0U);
  }
  EXPECT_LT(size, kStateBytes / 2);
  EXPECT_EQ(emulator.SaveState(std::span(bytes).first(size - 1)), 0U);
  EXPECT_EQ(emulator.SaveState(std::span(bytes).first(size)), size);
}

// A recording may contain a forged state. The emulator must refuse it or continue, at worst with a
// stop. The sanitizers check that it reads no memory outside the state.
TEST(State, WithAnyByteChangedIsRefusedOrHarmlessSoak) {
  const Scenario scenario = LoadTestScenario("box_9kg");
  Emulator emulator(scenario);
  for (int k = 0; k < 2500; ++k) emulator.Tick(), AutoStart(&emulator);
  ASSERT_EQ(emulator.state(), RunState::kRun);
  const std::vector<std::byte> state = Save(&emulator);
  std::size_t refused = 0, taken = 0;
  const auto stride = static_cast<std::size_t>(Count(29, 1));
  for (std::size_t at = 0; at < state.size(); at += stride) {
    for (const unsigned mask : {1U << (at % 8), 0xFFU}) {
      std::vector<std::byte> hostile = state;
      hostile[at] ^= static_cast<std::byte>(mask);
      try {
        emulator.LoadState(hostile);
        ++taken;
      } catch (const InputError&) {
        ++refused;
        continue;
      }
      emulator.Tick();
      emulator.Tick();
      EXPECT_LT(static_cast<int>(emulator.record().state), kRunStates) << at;
    }
  }
  EXPECT_GT(refused, 0U);
  EXPECT_GT(taken, 0U);
  emulator.LoadState(state);
  EXPECT_EQ(Save(&emulator), state);
}

TEST(State, StatesOfOtherScenariosAreRefused) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Emulator other(LoadTestScenario("single_arm"));
  emulator.Tick();
  std::vector<std::byte> bytes = Save(&emulator);
  EXPECT_THROW(other.LoadState(bytes), InputError);
  bytes.pop_back();
  EXPECT_THROW(emulator.LoadState(bytes), InputError);
  EXPECT_THROW(emulator.LoadState({}), InputError);
}

}  // namespace
}  // namespace predictor
