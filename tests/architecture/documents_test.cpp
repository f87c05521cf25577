// What the hazard log names as proof of a measure is there.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace {

const std::filesystem::path kRoot = PREDICTOR_SOURCE_DIR;

// A row's last column.
TEST(HazardLog, NamesAProofOfEachMeasureThatIsThere) {
  std::ifstream log(kRoot / "docs" / "hazards.md");
  const std::regex row(R"(\| H\d+ \|.*\| ([^|]*) \|)"),
      proof(R"(tests/[\w/.]+|[\w-]+\.md|soak \w+)"), file(R"(tests/[\w/.]+)");
  int rows = 0;
  for (std::string line; std::getline(log, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, row)) continue;
    ++rows;
    const std::string shown = match[1];
    EXPECT_TRUE(std::regex_search(shown, proof)) << line;
    for (std::sregex_iterator it(shown.begin(), shown.end(), file), end; it != end; ++it)
      EXPECT_TRUE(std::filesystem::exists(kRoot / it->str())) << it->str();
  }
  EXPECT_EQ(rows, 13);
}

}  // namespace
