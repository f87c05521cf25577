#include "safety/state_machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "core/text.h"

namespace predictor {
namespace {

// An independent copy of the state table. The copy has one row per condition in the order of
// kRunConditions, and one word per event in the order of RunEvent. "." means no change.
constexpr const char* kExpected = R"(
INIT      SELFTEST .    .     .     .    OFF      OFF       .         .        .        .
SELFTEST  .        IDLE .     .     .    OFF      OFF       .         .        .        .
IDLE      .        .    ALIGN .     .    STOPPING OFF       .         .        RECOVERY .
ALIGN     OFF      OFF  .     ARMED OFF  STOPPING OFF       OFF       OFF      OFF      OFF
ARMED     .        .    .     .     RUN  STOPPING OFF       .         .        .        .
RUN       OFF      OFF  OFF   OFF   .    STOPPING OFF       OFF       OFF      OFF      OFF
RECOVERY  OFF      OFF  OFF   OFF   OFF  STOPPING OFF       OFF       OFF      .        IDLE
AFTER     OFF      OFF  OFF   OFF   OFF  STOPPING OFF       OFF       OFF      .        HELD
STOPPING  .        .    .     .     .    .        OFF       HELD      .        .        .
OFF       .        .    .     .     .    .        .         UNPOWERED .        .        .
HELD      .        .    .     .     .    .        UNPOWERED .         IDLE     AFTER    .
UNPOWERED .        .    .     .     .    .        .         .         SELFTEST .        .
)";

std::string ShortName(RunCondition c) {
  const bool off = c.state == RunState::kStopping && c.level == StopLevel::kPowerOff;
  const bool after = c.state == RunState::kRecovery && c.level == StopLevel::kHold;
  return off ? "OFF" : after ? "AFTER" : Name(c.state);
}

RunEvent Event(int i) { return static_cast<RunEvent>(i); }

int IndexOf(RunCondition c) {
  const auto at = std::find(kRunConditions.begin(), kRunConditions.end(), c);
  return at == kRunConditions.end() ? -1 : static_cast<int>(at - kRunConditions.begin());
}

constexpr RunCondition kStart{};

// Returns the conditions that are reachable from `from` without the events and the states in the
// given sets.
std::set<int> Reachable(RunCondition from, const std::set<RunEvent>& without_events = {},
                        const std::set<RunState>& without_states = {}) {
  std::set<int> seen;
  std::vector<RunCondition> open = {from};
  while (!open.empty()) {
    const RunCondition c = open.back();
    open.pop_back();
    if (!seen.insert(IndexOf(c)).second) continue;
    for (int e = 0; e < kRunEvents; ++e) {
      if (without_events.count(Event(e))) continue;
      const RunCondition next = Next(c, Event(e));
      if (!without_states.count(next.state)) open.push_back(next);
    }
  }
  return seen;
}

bool Reaches(const std::set<int>& seen, RunState state) {
  return std::any_of(seen.begin(), seen.end(), [&](int i) {
    return kRunConditions[static_cast<std::size_t>(i)].state == state;
  });
}

TEST(StateMachine, EveryEventInEveryStateLeadsWhereItShould) {
  std::istringstream rows(kExpected);
  for (const RunCondition from : kRunConditions) {
    std::string name, to;
    rows >> name;
    ASSERT_EQ(name, ShortName(from));
    for (int e = 0; e < kRunEvents; ++e) {
      rows >> to;
      EXPECT_EQ(ShortName(Next(from, Event(e))), to == "." ? name : to)
          << name << " on " << Name(Event(e));
    }
  }
}

TEST(StateMachine, EveryStateIsReachableAndNoOther) {
  const std::set<int> seen = Reachable(kStart);
  EXPECT_EQ(seen.size(), kRunConditions.size());
  EXPECT_FALSE(seen.count(-1));
  std::set<RunState> states;
  for (const RunCondition c : kRunConditions) states.insert(c.state);
  EXPECT_EQ(states.size(), static_cast<std::size_t>(kRunStates));
}

TEST(StateMachine, NoTwoRowsOfTheTableContradict) {
  std::set<std::tuple<int, int>> keys;
  for (const Transition& t : kTransitions) {
    EXPECT_GE(IndexOf(t.from), 0);
    EXPECT_GE(IndexOf(t.to), 0);
    EXPECT_TRUE(keys.emplace(IndexOf(t.from), static_cast<int>(t.event)).second);
  }
}

TEST(StateMachine, FollowsTheTable) {
  for (int length = 0; length < kRunEvents * kRunEvents * kRunEvents; ++length) {
    StateMachine machine;
    RunCondition expected;
    for (int e : {length / (kRunEvents * kRunEvents), length / kRunEvents % kRunEvents,
                  length % kRunEvents}) {
      const RunCondition next = Next(expected, Event(e));
      EXPECT_EQ(machine.Handle(Event(e)), next != expected);
      expected = next;
      EXPECT_EQ(machine.state(), expected.state);
      EXPECT_EQ(machine.level(), expected.level);
    }
  }
}

TEST(StateMachine, AnEventOutsideTheEnumerationStopsWhatMoves) {
  const auto unknown = static_cast<RunEvent>(200);
  for (const RunCondition from : kRunConditions) {
    const RunCondition to = Next(from, unknown);
    if (FollowsTask(from.state)) {
      EXPECT_EQ(ShortName(to), "OFF");
    } else {
      EXPECT_EQ(to, from);
    }
  }
}

// Non-zero velocities may be sent only in ALIGN, RUN, RECOVERY or STOPPING.
TEST(StateMachineInvariants, OnlyFourStatesMove) {
  for (const RunCondition c : kRunConditions) {
    const bool moves = c.state == RunState::kAlign || c.state == RunState::kRun ||
                       c.state == RunState::kRecovery || c.state == RunState::kStopping;
    EXPECT_EQ(MayMove(c.state), moves) << Name(c);
    EXPECT_EQ(StateMachine::TimePasses(c.state), c.state == RunState::kRun);
  }
  // The arms must come to rest before the machine enters a state without motion, unless the event
  // itself ends a motion at rest.
  for (const RunCondition from : kRunConditions) {
    for (int e = 0; e < kRunEvents; ++e) {
      const RunCondition to = Next(from, Event(e));
      if (!MayMove(from.state) || MayMove(to.state)) continue;
      EXPECT_TRUE(Event(e) == RunEvent::kStandstill || Event(e) == RunEvent::kAligned ||
                  Event(e) == RunEvent::kRecovered)
          << Name(from) << " on " << Name(Event(e));
    }
  }
}

TEST(StateMachineInvariants, SeverityNeverFallsWithoutReset) {
  for (const int i : Reachable(kStart)) {
    const RunCondition from = kRunConditions[static_cast<std::size_t>(i)];
    for (int e = 0; e < kRunEvents; ++e) {
      const RunCondition to = Next(from, Event(e));
      if (Event(e) != RunEvent::kReset) {
        EXPECT_GE(to.level, from.level) << Name(from) << " on " << Name(Event(e));
      }
      if (Event(e) == RunEvent::kStopRequested) {
        EXPECT_GE(to.level, StopLevel::kHold);
      }
      if (Event(e) == RunEvent::kStopAndPowerOff) {
        EXPECT_EQ(to.level, StopLevel::kPowerOff);
      }
    }
  }
}

TEST(StateMachineInvariants, EveryStopReachesStandstillByOneEvent) {
  EXPECT_EQ(Next({RunState::kStopping, StopLevel::kHold}, RunEvent::kStandstill).state,
            RunState::kHeld);
  EXPECT_EQ(Next({RunState::kStopping, StopLevel::kPowerOff}, RunEvent::kStandstill).state,
            RunState::kUnpowered);
  for (const RunCondition c : kRunConditions) {
    for (const RunEvent stop : {RunEvent::kStopRequested, RunEvent::kStopAndPowerOff}) {
      const RunState next = Next(c, stop).state;
      EXPECT_TRUE(next == RunState::kStopping || next == RunState::kHeld ||
                  next == RunState::kUnpowered);
    }
  }
}

TEST(StateMachineInvariants, NoWayFromAStopToRunAvoidsResetIdleAndArmed) {
  for (const RunState stop : {RunState::kStopping, RunState::kHeld, RunState::kUnpowered}) {
    for (const RunCondition from : kRunConditions) {
      if (from.state != stop) continue;
      // If RUN were not reachable, the other checks would prove nothing.
      EXPECT_TRUE(Reaches(Reachable(from), RunState::kRun));
      EXPECT_FALSE(Reaches(Reachable(from, {RunEvent::kReset}), RunState::kRun));
      EXPECT_FALSE(Reaches(Reachable(from, {}, {RunState::kIdle}), RunState::kRun));
      EXPECT_FALSE(Reaches(Reachable(from, {}, {RunState::kArmed}), RunState::kRun));
    }
  }
}

TEST(StateMachineInvariants, NothingIsEnabledBeforeTheSelfTest) {
  const std::set<int> seen = Reachable(kStart, {RunEvent::kSelfTestPassed});
  EXPECT_FALSE(Reaches(seen, RunState::kIdle));
  const RunCondition unpowered{RunState::kUnpowered, StopLevel::kPowerOff};
  EXPECT_FALSE(Reaches(Reachable(unpowered, {RunEvent::kSelfTestPassed}), RunState::kIdle));
}

// ---- docs/concepts/states.md
// -----------------------------------------------------------------------------

using Edge = std::tuple<std::string, std::string, std::string>;  // from, event, to

// Returns the table that the page should contain. The table lists every transition that changes the
// condition, and it calls the default rule "any other".
std::set<Edge> EdgesOfCode() {
  std::set<Edge> edges;
  for (const Transition& t : kTransitions) {
    if (t.from != t.to) edges.emplace(Name(t.from), Name(t.event), Name(t.to));
  }
  for (const RunCondition c : kRunConditions) {
    const RunCondition to = Next(c, static_cast<RunEvent>(200));
    if (to != c) edges.emplace(Name(c), "any other", Name(to));
  }
  return edges;
}

std::vector<std::string> Split(const std::string& s, char at) {
  std::vector<std::string> parts;
  std::istringstream in(s);
  for (std::string part; std::getline(in, part, at);) parts.emplace_back(Trimmed(part));
  return parts;
}

std::vector<std::string> Page() {
  std::ifstream in(PREDICTOR_SOURCE_DIR "/docs/concepts/states.md");
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// Returns the rows of the table under `## heading`, without its two header lines.
std::vector<std::vector<std::string>> Rows(const std::string& heading) {
  std::vector<std::vector<std::string>> rows;
  bool inside = false;
  for (const std::string& line : Page()) {
    if (line.rfind("## ", 0) == 0) inside = line == "## " + heading;
    if (!inside || line.empty() || line[0] != '|') continue;
    std::vector<std::string> cells = Split(line, '|');
    rows.emplace_back(cells.begin() + 1, cells.end());
  }
  if (rows.size() >= 2) rows.erase(rows.begin(), rows.begin() + 2);
  return rows;
}

TEST(StatesPage, TableIsTheCodes) {
  std::set<Edge> edges;
  for (const auto& row : Rows("Transitions")) {
    ASSERT_EQ(row.size(), 3U);
    EXPECT_TRUE(edges.emplace(row[0], row[1], row[2]).second);
  }
  EXPECT_EQ(edges, EdgesOfCode());
}

TEST(StatesPage, DiagramIsTheCodes) {
  std::set<Edge> edges;
  for (const std::string& line : Page()) {
    const auto arrow = line.find(" --> "), colon = line.find(": ");
    if (arrow == std::string::npos || colon == std::string::npos) continue;
    const auto name = [](const std::string& id) {
      if (id == "RECOVERY_HELD") return std::string("RECOVERY (after a stop)");
      return id == "STOPPING_OFF" ? std::string("STOPPING (power off)") : id;
    };
    const std::string from = name(std::string(Trimmed(line.substr(0, arrow))));
    const std::string to = name(std::string(Trimmed(line.substr(arrow + 5, colon - arrow - 5))));
    for (const std::string& event : Split(line.substr(colon + 2), ',')) {
      EXPECT_TRUE(edges.emplace(from, event, to).second);
    }
  }
  EXPECT_EQ(edges, EdgesOfCode());
}

TEST(StatesPage, NamesEveryEventAndState) {
  std::set<std::string> events, expected_events, states, expected_states;
  for (const auto& row : Rows("Events")) events.insert(row.at(0));
  for (int e = 0; e < kRunEvents; ++e) expected_events.insert(Name(Event(e)));
  EXPECT_EQ(events, expected_events);
  EXPECT_EQ(expected_events.size(), static_cast<std::size_t>(kRunEvents));
  for (const std::string& line : Page()) {
    if (line.rfind("## ", 0) == 0) break;
    if (line.rfind("| ", 0) == 0) states.insert(Split(line, '|').at(1));
  }
  states.erase("State");
  for (int s = 0; s < kRunStates; ++s) expected_states.insert(Name(static_cast<RunState>(s)));
  EXPECT_EQ(states, expected_states);
}

}  // namespace
}  // namespace predictor
