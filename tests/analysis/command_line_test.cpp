// Tests the command-line options that set keys of the scenario, and the files that the program
// writes.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace predictor {
namespace {

namespace fs = std::filesystem;

struct Output {
  int code = -1;
  std::string text;  // standard output and error
};

// Runs `predictor simulate` on the shortest scenario with these options.
Output Simulate(const std::string& options) {
  const std::string command = std::string(PREDICTOR_BINARY) + " simulate --quiet " +
                              PREDICTOR_SOURCE_DIR "/scenarios/single_arm.yaml " + options +
                              " 2>&1";
  Output output;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.text.append(buffer.data(), n);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) output.code = WEXITSTATUS(status);
  return output;
}

bool Contains(const Output& output, const std::string& words) {
  return output.text.find(words) != std::string::npos;
}

TEST(CommandLine, SeedHasTheRangeOfTheScenarios) {
  for (const char* seed : {"-1", "1.5", "18446744073709551616", "x", "''"}) {
    const Output output = Simulate(std::string("--duration 0.1 --seed ") + seed);
    EXPECT_EQ(output.code, 2) << seed << output.text;
    EXPECT_TRUE(Contains(output, "seed is ")) << seed << output.text;
    EXPECT_TRUE(Contains(output, "from 0 to 18446744073709551615.")) << seed << output.text;
  }
  const Output largest = Simulate("--duration 0.1 --json - --seed 18446744073709551615");
  EXPECT_EQ(largest.code, 0) << largest.text;
  EXPECT_TRUE(Contains(largest, "\"seed\": 18446744073709551615")) << largest.text;
}

TEST(CommandLine, DurationHasTheRangeAndPrecisionOfTheScenarios) {
  for (const char* duration : {"-1", "0", "nan", "1e9", "1s"}) {
    const Output output = Simulate(std::string("--duration ") + duration);
    EXPECT_EQ(output.code, 2) << duration << output.text;
    EXPECT_TRUE(Contains(output, "duration is ")) << duration << output.text;
  }
  // A duration may be small but must be positive.
  EXPECT_EQ(Simulate("--duration 1e-9").code, 0);
}

class SummaryFile : public testing::Test {
 protected:
  SummaryFile() {
    std::string folder = (fs::temp_directory_path() / "predictor-summary-XXXXXX").string();
    folder_ = mkdtemp(folder.data());
    file_ = folder_ / "summary.json";
  }
  ~SummaryFile() override { fs::remove_all(folder_); }
  Output Run(const std::string& options) const {
    return Simulate("--duration 0.1 --json " + file_.string() + " " + options);
  }

  fs::path folder_, file_;
};

TEST_F(SummaryFile, IsWrittenAfterARun) {
  EXPECT_EQ(Run("").code, 0);
  EXPECT_GT(fs::file_size(file_), 100u);
}

TEST_F(SummaryFile, IsNotLeftEmptyByABadScenario) {
  // The program can refuse the first value because of its key alone. It can refuse the second value
  // only after it has loaded the models.
  for (const char* bad : {"--set seed=-1", "--set cobot.end_effector=nope"}) {
    EXPECT_EQ(Run(bad).code, 2) << bad;
    EXPECT_FALSE(fs::exists(file_)) << bad;
  }
}

TEST_F(SummaryFile, IsKeptAsItWasByABadScenario) {
  std::ofstream(file_) << "of an earlier run";
  EXPECT_EQ(Run("--set cobot.end_effector=nope").code, 2);
  std::ostringstream text;
  text << std::ifstream(file_).rdbuf();
  EXPECT_EQ(text.str(), "of an earlier run");
}

TEST_F(SummaryFile, ThatCannotBeWrittenIsRefusedBeforeTheRun) {
  fs::create_directory(file_);
  const Output output = Run("");
  EXPECT_EQ(output.code, 2);
  EXPECT_TRUE(Contains(output, "cannot be written")) << output.text;
}

}  // namespace
}  // namespace predictor
