// The program must refuse invalid input within a second and 256 MB, with a message that states what
// to change. The corpus is in tests/corpus/scenario. Its README explains how to add a file.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "fixture.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kIsMeasured = false;  // sanitizers themselves take time and memory
#else
constexpr bool kIsMeasured = true;
#endif
constexpr double kMaxSeconds = 1;          // of the processor
constexpr rlim_t kMaxMemory = 256u << 20;  // [B]

const fs::path kCorpus = fs::path(PREDICTOR_SOURCE_DIR) / "tests/corpus/scenario";

// The result of loading a file, and the resources that this took.
struct Outcome {
  std::string error;  // of the InputError; "" if it loaded
  bool is_exit_good;  // no crash, no other exception, and no exceeded limit
  double seconds;     // of the processor
  double megabytes;   // maximum resident memory
};

// Runs in the child process. It loads the file, writes the InputError to the pipe if there is one,
// and exits with 0. Any other failure gives another exit code.
[[noreturn]] void LoadAndExit(const fs::path& file, int pipe) {
  if (kIsMeasured) {
    const rlimit memory = {kMaxMemory, kMaxMemory};
    setrlimit(RLIMIT_AS, &memory);
  }
  int code = 0;
  try {
    LoadScenario(file);
  } catch (const InputError& error) {
    const std::string text = error.what();
    code = write(pipe, text.data(), text.size()) < 0;
  } catch (...) {
    code = 2;
  }
  _exit(code);
}

Outcome Load(const fs::path& file) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) LoadAndExit(file, ends[1]);
  close(ends[1]);
  Outcome outcome{};
  char buffer[4096];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof(buffer))) > 0;) {
    outcome.error.append(buffer, static_cast<std::size_t>(n));
  }
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  outcome.is_exit_good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  outcome.seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  outcome.megabytes = static_cast<double>(usage.ru_maxrss) / 1024;
  return outcome;
}

void ExpectRefused(const fs::path& file, const std::string& expected) {
  const Outcome outcome = Load(file);
  EXPECT_TRUE(outcome.is_exit_good);
  EXPECT_NE(outcome.error.find(expected), std::string::npos)
      << "expected: " << expected << "\ngot:      " << outcome.error;
  EXPECT_EQ(outcome.error.rfind(file.string(), 0), 0u) << "does not begin with the file's name";
  EXPECT_LT(outcome.error.size(), 4000u);
  if (kIsMeasured) {
    EXPECT_LT(outcome.seconds, kMaxSeconds);
    EXPECT_LT(outcome.megabytes, static_cast<double>(kMaxMemory >> 20));
  }
}

// ---- files
// ---------------------------------------------------------------------------------------

std::vector<std::string> CorpusNames() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kCorpus)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class Corpus : public testing::TestWithParam<std::string> {};

TEST_P(Corpus, IsRefused) {
  const fs::path file = kCorpus / (GetParam() + ".yaml");
  const std::string text = ReadFile(file), mark = "# expect: ";
  ASSERT_EQ(text.rfind(mark, 0), 0u) << "the first line must be: # expect: part of the error";
  const std::string expected = text.substr(mark.size(), text.find('\n') - mark.size());
  ASSERT_GT(expected.size(), 10u);
  ExpectRefused(file, expected);
}

INSTANTIATE_TEST_SUITE_P(Bad, Corpus, testing::ValuesIn(CorpusNames()),
                         [](const auto& file) { return file.param; });

// ---- files that are too large to keep
// ------------------------------------------------------------

class Generated : public testing::Test {
 protected:
  void ExpectRefusedText(const std::string& text, const std::string& expected) {
    const fs::path file = folder_ / "bad.yaml";
    std::ofstream(file, std::ios::binary) << text;
    ExpectRefused(file, expected);
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

// Repeats `unit` up to the largest size that is still read.
std::string Fill(const std::string& unit, const std::string& start = "") {
  std::string text = start;
  while (text.size() + unit.size() <= (1u << 20)) text += unit;
  return text;
}

TEST_F(Generated, AFileOf100Megabytes) {
  const fs::path file = folder_ / "large.yaml";
  {
    std::ofstream stream(file, std::ios::binary);
    const std::string block = Fill("# nothing\n");
    for (int i = 0; i < 100; ++i) stream << block;
  }
  ASSERT_GT(fs::file_size(file), 100e6);
  ExpectRefused(file, "the file has more than 1048576 bytes");
}

TEST_F(Generated, OneByteTooMany) {
  ExpectRefusedText(std::string((1u << 20) + 1, '#'), "the file has more than 1048576 bytes");
  ExpectRefusedText(std::string(1u << 20, '#'),
                    "a scenario must be a group of keys, but this is empty");
}

TEST_F(Generated, AnAliasBombOfManyLevels) {
  std::string bomb = "a0: &a0 [lol, lol]\n";
  for (int i = 1; i < 5000; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    const std::string name = "a" + std::to_string(i);
    bomb += name + ": &" + name + " [" + last + ", " + last + ", " + last + "]\n";
  }
  ExpectRefusedText(bomb, "bad.yaml:1:5: anchors (&) and aliases (*) are not allowed");
}

TEST_F(Generated, BracketsOfDepth100000) {
  const std::string open(100000, '['), close(100000, ']');
  ExpectRefusedText("a: " + open + close, "has more than 20000 opening brackets");
  ExpectRefusedText("a: " + open, "has more than 20000 opening brackets");
  ExpectRefusedText(Fill("{a: "), "has more than 20000 opening brackets");
  ExpectRefusedText("a: " + std::string(19000, '[') + std::string(19000, ']'),
                    "nested deeper than 32 levels");
}

TEST_F(Generated, BlocksOfAnyDepth) {
  std::string steps;
  for (int i = 0; i < 1400; ++i) steps += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  ExpectRefusedText(steps, "nested deeper than 32 levels");
  ExpectRefusedText(Fill("- "), "nested deeper than 32 levels");
}

// These structures are short to write but could be expensive to read.
TEST_F(Generated, AMegabyteOfAnything) {
  const std::vector<std::pair<std::string, std::string>> shapes = {
      {Fill("a,", "a: ["), "more than 50000 values"},
      {Fill("\n- a"), "more than 50000 values"},
      {Fill("? "), "here is a list or a group instead of a key"},
      {Fill(": "), "a key is missing"},
      {Fill("&a "), "anchors (&) and aliases (*)"},
      {Fill("*a "), "anchors (&) and aliases (*)"},
      {Fill("!"), "this is not valid YAML"},
      {Fill("\"a\":"), "this is not valid YAML"},
      {Fill("a"), "a scenario must be a group of keys"},
      {Fill("a\n"), "a scenario must be a group of keys"},
      {Fill("---\n"), "a second document"},
      {Fill("'"), "a scenario must be a group of keys"},
      {Fill("a", "name: \""), "this is not valid YAML"},
      {Fill("\n", "name: |\n"), "cobot.model is missing"},
  };
  for (const auto& [text, expected] : shapes) {
    SCOPED_TRACE(text.substr(0, 20));
    ExpectRefusedText(text, expected);
  }
}

TEST_F(Generated, ManyKeysAndAVeryLongOne) {
  std::string many;
  for (int i = 0; i < 49000; ++i) many += "k" + std::to_string(i) + ": 1\n";
  ExpectRefusedText(many, "\"k0\" is not a key");
  ExpectRefusedText("? " + std::string(1000000, 'f') + "\n: 1\n", "...\" is not a key");
}

TEST_F(Generated, SomethingThatIsNotAFile) {
  ExpectRefused(folder_, "this is not a file");
  ExpectRefused(folder_ / "missing.yaml", "file does not exist");
  ExpectRefused("/dev/zero", "this is not a file");
}

}  // namespace
}  // namespace predictor
