// The parser must refuse each invalid URDF and state the reason, within a second and 256 MB.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "models/urdf.h"
#include "support/allocation_guard.h"
#include "support/temporary_folder.h"

namespace predictor::test {
namespace {

namespace fs = std::filesystem;

// The limit is processor time, so that the load on the computer does not matter.
constexpr double kMaxSeconds = 1;
constexpr long kMaxKilobytes = 256 << 10;

struct Refusal {
  std::string message;  // "" if the file was accepted
  int status = -1;      // of the reading process; 0 if it ended normally
  double seconds = 0;
  long kilobytes = 0;
};

// Reads `file` in a separate process and measures its time and memory.
Refusal TryToRead(const fs::path& file) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) {
    std::string message;
    try {
      ReadUrdf(file);
    } catch (const InputError& error) {
      message = error.what();
    }
    const bool is_written =
        write(ends[1], message.data(), message.size()) == static_cast<ssize_t>(message.size());
    _exit(is_written ? 0 : 1);
  }
  close(ends[1]);
  Refusal refusal;
  char buffer[4096];
  for (ssize_t bytes = 0; (bytes = read(ends[0], buffer, sizeof buffer)) > 0;) {
    refusal.message.append(buffer, static_cast<std::size_t>(bytes));
  }
  close(ends[0]);
  rusage usage = {};
  wait4(child, &refusal.status, 0, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  refusal.seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  refusal.kilobytes = usage.ru_maxrss;
  return refusal;
}

void ExpectRefused(const fs::path& file, const std::string& expected) {
  const Refusal refusal = TryToRead(file);
  EXPECT_EQ(refusal.status, 0) << "the process died";
  EXPECT_NE(refusal.message.find(expected), std::string::npos)
      << "expected: " << expected << "\nmessage: " << refusal.message;
  EXPECT_EQ(refusal.message.rfind(file.string() + ":", 0), 0u) << refusal.message;
  EXPECT_NE(std::string(".?").find(refusal.message.back()), std::string::npos)
      << "a full sentence: " << refusal.message;
  if (!AllocationGuard::kIsActive) return;  // sanitizers need more time and memory
  EXPECT_LT(refusal.seconds, kMaxSeconds);
  EXPECT_LT(refusal.kilobytes, kMaxKilobytes);
}

std::vector<std::string> Corpus() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(PREDICTOR_SOURCE_DIR "/tests/corpus/urdf")) {
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class UrdfCorpus : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Files, UrdfCorpus, testing::ValuesIn(Corpus()),
                         [](const auto& file) { return file.param; });

TEST_P(UrdfCorpus, IsRefused) {
  const fs::path file =
      fs::path(PREDICTOR_SOURCE_DIR "/tests/corpus/urdf") / (GetParam() + ".urdf");
  std::string first;
  std::getline(std::ifstream(file), first);
  const std::string opening = "<!-- expect: ", closing = " -->";
  ASSERT_EQ(first.rfind(opening, 0), 0u) << "the first line must say what is expected";
  ASSERT_GT(first.size(), opening.size() + closing.size());
  ExpectRefused(file, first.substr(opening.size(), first.size() - opening.size() - closing.size()));
}

// Generates files that are too large or too unusual to be stored.
class GeneratedUrdf : public testing::Test {
 protected:
  void Write(const std::string& text) { std::ofstream(file_, std::ios::binary) << text; }
  static std::string Repeat(const std::string& text, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) all += text;
    return all;
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  const fs::path file_ = folder_ / "generated.urdf";
};

TEST_F(GeneratedUrdf, OfAHundredMegabytes) {
  Write("<robot name=\"bad\">");
  fs::resize_file(file_, 100u << 20);
  ExpectRefused(file_, "104857600 bytes");
}

TEST_F(GeneratedUrdf, NestedDeeply) {
  Write("<robot name=\"bad\">" + Repeat("<a>", 100000) + Repeat("</a>", 100000) + "</robot>");
  ExpectRefused(file_, "nested more than");
}

TEST_F(GeneratedUrdf, BillionLaughs) {
  std::string text = "<?xml version=\"1.0\"?>\n<!DOCTYPE robot [\n<!ENTITY a0 \"ha\">\n";
  for (int i = 1; i < 30; ++i) {
    const std::string last = "&a" + std::to_string(i - 1) + ";";
    text += "<!ENTITY a" + std::to_string(i) + " \"" + Repeat(last, 10) + "\">\n";
  }
  Write(text + "]>\n<robot name=\"&a29;\"/>\n");
  ExpectRefused(file_, ":2: The file declares a document type");
}

TEST_F(GeneratedUrdf, FullOfElements) {
  Write("<robot name=\"bad\">" + Repeat("<a/>", 1000000) + "</robot>");
  ExpectRefused(file_, "0 links");
}

TEST_F(GeneratedUrdf, FullOfAttributes) {
  std::string text = "<robot name=\"bad\"";
  for (int i = 0; i < 380000; ++i) text += " a" + std::to_string(i) + "=''";
  Write(text + "/>");
  ExpectRefused(file_, "more than 100 attributes");
}

TEST_F(GeneratedUrdf, FullOfElementsWithManyAttributes) {
  std::string element = "<a";
  for (int i = 0; i < 100; ++i) element += " a" + std::to_string(i) + "='>'";
  Write("<robot name=\"bad\">" + Repeat(element + "/>", 4500) + "</robot>");
  ExpectRefused(file_, "0 links");
}

TEST_F(GeneratedUrdf, FullOfLinks) {
  std::string text = "<robot name=\"bad\">";
  for (int i = 0; i < 100000; ++i) text += "<link name=\"link" + std::to_string(i) + "\"/>";
  Write(text + "</robot>");
  ExpectRefused(file_, "100000 links");
}

TEST_F(GeneratedUrdf, FullOfJoints) {
  std::string text = "<robot name=\"bad\"><link name=\"a\"/><link name=\"b\"/>";
  for (int i = 0; i < 40000; ++i) {
    text += "<joint name=\"j" + std::to_string(i) +
            "\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>";
  }
  Write(text + "</robot>");
  ExpectRefused(file_, "child of two joints");
}

TEST_F(GeneratedUrdf, OfUnclosedComments) {
  Write(Repeat("<!--", 1000000));
  ExpectRefused(file_, "well-formed");
}

TEST_F(GeneratedUrdf, OfRandomBytes) {
  std::string text(1 << 20, ' ');
  std::uint32_t x = 1;
  for (char& c : text) c = static_cast<char>((x = x * 1664525 + 1013904223) >> 24);
  Write(text);
  ExpectRefused(file_, "zero byte");
}

TEST_F(GeneratedUrdf, ThatIsAPipe) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  ExpectRefused(file_, "is not a regular file");
}

TEST_F(GeneratedUrdf, ThatDoesNotExist) { ExpectRefused(file_, "does not exist"); }

TEST_F(GeneratedUrdf, ThatIsAFolder) {
  fs::create_directory(file_);
  ExpectRefused(file_, "is not a regular file");
}

// A valid file is cut at each point. The parser must refuse it, or read it if only white space is
// missing, and must never crash.
TEST_F(GeneratedUrdf, CutAnywhere) {
  std::ifstream stream(PREDICTOR_SOURCE_DIR "/assets/bar.urdf");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t end = text.rfind('>');
  for (std::size_t size = 0; size < end; size += 7) {
    EXPECT_THROW(ParseUrdf(text.substr(0, size), "cut.urdf", folder_), InputError) << size;
  }
  EXPECT_NO_THROW(ParseUrdf(text.substr(0, end + 1), "cut.urdf", folder_));
}

}  // namespace
}  // namespace predictor::test
