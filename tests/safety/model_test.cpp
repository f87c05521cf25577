// Compares the model of the state machine (models/*.pml) with the state machine itself, so that
// Spin's results apply to the running program.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "safety/state_machine.h"
#include "support/soak.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

const std::string kModels = PREDICTOR_SOURCE_DIR "/models/";

RunEvent Event(int i) { return static_cast<RunEvent>(i); }

int IndexOf(RunCondition c) {
  for (std::size_t i = 0; i < kRunConditions.size(); ++i)
    if (kRunConditions[i] == c) return static_cast<int>(i);
  return -1;
}

// Returns a name in the form that the model uses. For example, "self-test passed" becomes
// SELF_TEST_PASSED.
std::string ModelName(std::string name) {
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    c = std::isalnum(byte) ? static_cast<char>(std::toupper(byte)) : '_';
  }
  return name;
}

std::string ModelName(RunCondition c) {
  const std::string name = ModelName(Name(c.state));
  if (c.state == RunState::kStopping && c.level == StopLevel::kPowerOff) return name + "_OFF";
  return c.state == RunState::kRecovery && c.level == StopLevel::kHold ? name + "_HELD" : name;
}

std::vector<std::string> Lines(const std::string& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// Maps names to numbers, from the lines `#define NAME 7` and `#define NAME OTHER_NAME`.
std::map<std::string, int> Numbers(const std::vector<std::string>& lines) {
  static const std::regex kDefine(R"(#define (\w+) (\w+))");
  std::map<std::string, int> numbers;
  for (const std::string& line : lines) {
    std::smatch match;
    if (!std::regex_match(line, match, kDefine)) continue;
    const std::string value = match[2];
    EXPECT_TRUE(
        numbers.emplace(match[1], numbers.count(value) ? numbers[value] : std::stoi(value)).second);
  }
  return numbers;
}

// Returns the first word and its arguments for each line "  ROW(INIT, SELFTEST, ...)".
std::vector<std::vector<std::string>> Rows(const std::vector<std::string>& lines) {
  std::vector<std::vector<std::string>> rows;
  static const std::regex kWord(R"(\w+)");
  for (const std::string& line : lines) {
    if (line.rfind("  ROW(", 0) != 0) continue;
    const std::string words = line.substr(6);
    rows.emplace_back(std::sregex_token_iterator(words.begin(), words.end(), kWord),
                      std::sregex_token_iterator());
  }
  return rows;
}

TEST(Model, CountsConditionsAndEventsAsTheCodeDoes) {
  const std::vector<std::string> lines = Lines(kModels + "transitions.pml");
  const std::map<std::string, int> numbers = Numbers(lines);
  for (std::size_t i = 0; i < kRunConditions.size(); ++i) {
    const std::string name = ModelName(kRunConditions[i]);
    ASSERT_TRUE(numbers.count(name)) << name;
    EXPECT_EQ(numbers.at(name), static_cast<int>(i)) << name;
  }
  // The k-th entry of the macro ROW belongs to the event k.
  static const std::regex kEntry(R"( *NEXT\(at, (\w+)\) = e(\d+);.*)");
  int entries = 0;
  for (const std::string& line : lines) {
    std::smatch match;
    if (!std::regex_match(line, match, kEntry)) continue;
    EXPECT_EQ(match[1], ModelName(Name(Event(entries))));
    EXPECT_EQ(std::stoi(match[2]), entries);
    EXPECT_EQ(numbers.at(match[1]), entries);
    ++entries;
  }
  EXPECT_EQ(entries, kRunEvents);
}

TEST(Model, EveryEntryOfItsTableIsTheCodes) {
  const std::vector<std::string> lines = Lines(kModels + "transitions.pml");
  const std::map<std::string, int> numbers = Numbers(lines);
  const auto rows = Rows(lines);
  ASSERT_EQ(rows.size(), kRunConditions.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RunCondition from = kRunConditions[i];
    ASSERT_EQ(rows[i].size(), 1U + kRunEvents);
    EXPECT_EQ(rows[i][0], ModelName(from));
    for (int e = 0; e < kRunEvents; ++e) {
      const std::string& to = rows[i][1U + static_cast<std::size_t>(e)];
      EXPECT_EQ(numbers.at(to), IndexOf(Next(from, Event(e))))
          << Name(from) << ", " << Name(Event(e));
    }
  }
}

struct Step {
  int from, event, to;
};

// Returns the steps of the model's state machine in a random run of `steps` steps. The model's
// times are longer here than in Spin's exhaustive search. With shorter times, a random person would
// rarely hold the key long enough to change the state.
std::vector<Step> Trace(const test::TemporaryFolder& folder, long seed, long steps) {
  const std::string command = "cd '" + folder.path().string() + "' && spin -T -n" +
                              std::to_string(seed) + " -u" + std::to_string(steps) +
                              " -DTRACES -DSILENCE=200 -DWIRE=3 -DMAIL=3 -DROOM=2 -DPRESSES=2 '" +
                              kModels + "safety.pml' 2>&1";
  const std::unique_ptr<FILE, int (*)(FILE*)> spin(popen(command.c_str(), "r"), pclose);
  std::vector<Step> trace;
  std::array<char, 512> line;
  while (spin && std::fgets(line.data(), static_cast<int>(line.size()), spin.get())) {
    std::istringstream words(line.data());
    std::string word;
    Step step{};
    if (words >> word >> step.from >> step.event >> step.to && word == "TRACE")
      trace.push_back(step);
  }
  return trace;
}

TEST(Model, ItsRandomRunsAreRunsOfTheStateMachineSoak) {
  ASSERT_EQ(std::system("command -v spin >/dev/null"), 0)
      << "Spin is missing: apt-get install spin (deps/apt-models.txt)";
  const test::TemporaryFolder folder;
  ASSERT_FALSE(folder.path().empty());
  std::set<std::pair<int, int>> seen;
  for (long seed = 1; seed <= Count(12, 400); ++seed) {
    StateMachine machine;
    const std::vector<Step> trace = Trace(folder, seed, 300'000);
    ASSERT_GT(trace.size(), 100U) << seed;
    for (const Step& step : trace) {
      ASSERT_TRUE(step.event >= 0 && step.event < kRunEvents) << step.event;
      ASSERT_EQ(IndexOf({machine.state(), machine.level()}), step.from) << seed;
      machine.Handle(Event(step.event));
      ASSERT_EQ(IndexOf({machine.state(), machine.level()}), step.to)
          << seed << ": " << Name(Event(step.event));
      seen.emplace(step.from, step.event);
    }
  }
  std::set<int> conditions;
  for (const auto& [from, event] : seen) conditions.insert(from);
  EXPECT_EQ(conditions.size(), kRunConditions.size());  // otherwise the runs would prove little
  EXPECT_GE(seen.size(), 50U);
}

}  // namespace
}  // namespace predictor
