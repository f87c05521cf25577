#include "process/sandboxed_call.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "support/temporary_folder.h"

namespace predictor {
namespace {

using Bytes = std::vector<std::byte>;

Bytes BytesOf(const std::string& text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

std::string TextOf(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string ReadAll(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Returns the result as text, or "failed: " and the reason.
std::string TextOfCall(const std::function<std::string()>& produce,
                       const std::vector<std::filesystem::path>& readable = {},
                       const SandboxedLimits& limits = {1000, 20}) {
  try {
    return TextOf(CallSandboxed(readable, limits, [&] { return BytesOf(produce()); }));
  } catch (const SandboxedFailure& failure) {
    return std::string("failed: ") + failure.what();
  }
}

TEST(SandboxedCall, ReturnsTheBytesAndReadsWhatItMay) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "a") << "content";
  EXPECT_EQ(TextOfCall([&] { return ReadAll(folder.path() / "a"); }, {folder.path() / "a"}),
            "content");
  EXPECT_EQ(TextOfCall([] { return std::string(1000, 'x'); }), std::string(1000, 'x'));
}

TEST(SandboxedCall, AnExceptionArrivesAsItsMessageMadePrintable) {
  EXPECT_EQ(TextOfCall([]() -> std::string { throw std::runtime_error("no\x1b[2J triangles"); }),
            "failed: no\\x1b[2J triangles");
}

TEST(SandboxedCall, ACrashAHangAndTooMuchAreFailures) {
  EXPECT_EQ(TextOfCall([]() -> std::string {
              std::signal(SIGSEGV, SIG_DFL);  // sanitizers catch it
              raise(SIGSEGV);
              return "";
            }),
            "failed: its reader crashed (signal 11)");
  EXPECT_EQ(TextOfCall(
                []() -> std::string {
                  for (;;) pause();
                },
                {}, {1000, 0.2}),
            "failed: its reader took longer than 0.2 s");
  EXPECT_EQ(TextOfCall([] { return std::string(1001, 'x'); }), "failed: it contains too much data");
  EXPECT_EQ(TextOfCall([] { return std::string(1 << 22, 'x'); }),
            "failed: it contains too much data");
  EXPECT_EQ(TextOfCall([]() -> std::string { _exit(7); }), "failed: its reader failed");
}

TEST(SandboxedCall, CanAccessNothingElse) {
  if (kSanitized) GTEST_SKIP() << "Sanitizers need what the sandbox refuses.";
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "secret") << "secret";
  std::ofstream(folder.path() / "mesh") << "mesh";
  const int secret = open((folder.path() / "secret").c_str(), O_RDWR);
  const int inherited = fcntl(secret, F_DUPFD, 50);
  ASSERT_GE(inherited, 50);
  const auto look = [&] {
    std::string found;
    if (!ReadAll(folder.path() / "secret").empty()) found += "another file, ";
    if (open((folder.path() / "new").c_str(), O_WRONLY | O_CREAT, 0600) >= 0)
      found += "a new file, ";
    if (open((folder.path() / "mesh").c_str(), O_WRONLY) >= 0) found += "writing, ";
    if (socket(AF_INET, SOCK_STREAM, 0) >= 0) found += "a socket, ";
    if (fcntl(inherited, F_GETFD) >= 0) found += "a descriptor of its parent, ";
    if (kill(getppid(), 0) == 0) found += "its parent, ";
    if (fork() >= 0) found += "a process, ";
    return found + "nothing";
  };
  EXPECT_EQ(TextOfCall(look, {folder.path() / "mesh"}), "nothing");
  close(inherited);
  close(secret);
}

}  // namespace
}  // namespace predictor
