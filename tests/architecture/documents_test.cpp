// Checks that the evidence that documents cite exists. The evidence consists of the files in the
// hazard log and the rows in the record of long runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

const std::filesystem::path kRoot = PREDICTOR_SOURCE_DIR;

// Returns the lines of the list item "Shown by" in each hazard's section.
TEST(HazardLog, NamesAProofOfEachMeasureThatIsThere) {
  std::ifstream log(kRoot / "docs" / "concepts" / "hazards.md");
  const std::regex heading(R"(## H\d+: .+)"), proof(R"(tests/[\w/.]+|[\w-]+\.md|soak \w+)"),
      file(R"(tests/[\w/.]+)");
  std::vector<std::string> shown;
  bool inside = false;
  for (std::string line; std::getline(log, line);) {
    if (std::regex_match(line, heading)) shown.emplace_back();
    if (line.rfind("- **Shown by**:", 0) == 0)
      inside = true;
    else if (line.rfind("  ", 0) != 0)
      inside = false;
    if (inside && !shown.empty()) shown.back() += line;
  }
  EXPECT_EQ(shown.size(), 15u);
  for (const std::string& text : shown) {
    EXPECT_TRUE(std::regex_search(text, proof)) << text;
    for (std::sregex_iterator it(text.begin(), text.end(), file), end; it != end; ++it)
      EXPECT_TRUE(std::filesystem::exists(kRoot / it->str())) << it->str();
  }
}

struct LongRun {
  std::string date, commit, test, count, seconds, result;
};

std::vector<LongRun> Record() {
  std::ifstream in(kRoot / "docs" / "soak-record.csv");
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "date,commit,test,count,seconds,result");
  std::vector<LongRun> runs;
  const std::regex row(
      R"((\d{4}-\d\d-\d\d),([0-9a-f]{7,40}\+?),([^,]+),((?:\d+ ?)+|-),(\d+),(passed|failed|skipped))");
  for (std::smatch match; std::getline(in, line);) {
    EXPECT_TRUE(std::regex_match(line, match, row)) << line;
    if (!match.empty())
      runs.push_back({match[1], match[2], match[3], match[4], match[5], match[6]});
  }
  return runs;
}

bool IsRecorded(const std::vector<LongRun>& runs, const std::string& test,
                const std::string& count) {
  return std::ranges::any_of(runs, [&](const LongRun& run) {
    return run.result == "passed" && run.test.find(test) != std::string::npos &&
           (" " + run.count + " ").find(" " + count + " ") != std::string::npos;
  });
}

TEST(LongRuns, AreRecordedOnlyIfOneOfThatCountPassed) {
  const std::vector<LongRun> runs = {
      {"2026-01-02", "0123abc", "a.KillSoak", "5 300", "9", "passed"},
      {"2026-01-02", "0123abc", "a.LoadSoak", "20", "9", "failed"}};
  EXPECT_TRUE(IsRecorded(runs, "KillSoak", "300"));
  EXPECT_FALSE(IsRecorded(runs, "KillSoak", "30"));
  EXPECT_FALSE(IsRecorded(runs, "LoadSoak", "20"));
}

// A document that quotes results of ./dev soak must cite a row, as in [soak: KilledAtRandomMoments
// 300](soak-record.csv), or state that the record has no row yet.
TEST(LongRuns, ThatDocumentsQuoteAreInTheRecord) {
  const std::vector<LongRun> runs = Record();
  const std::regex citation(R"(\[soak: ([\w.]+) (\d+|-)\]\(\.\./soak-record\.csv\))"),
      old(R"((not in|older than) \[the record)");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "docs")) {
    // The following documents mention the command itself, without a result.
    const std::string name = entry.path().filename();
    if (entry.path().extension() != ".md" || name == "decisions.md" || name == "hazards.md")
      continue;
    std::ifstream in(entry.path());
    std::ostringstream all;
    all << in.rdbuf();
    const std::string text = all.str();
    int cited = 0;
    for (std::sregex_iterator it(text.begin(), text.end(), citation), end; it != end; ++it, ++cited)
      EXPECT_TRUE(IsRecorded(runs, (*it)[1], (*it)[2])) << name << ": " << it->str();
    if (text.find("./dev soak") != std::string::npos) {
      EXPECT_TRUE(cited > 0 || std::regex_search(text, old)) << name;
    }
  }
}

}  // namespace
