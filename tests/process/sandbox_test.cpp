// What is left to a process that gave up its rights: looked at from inside.
#include "process/sandbox.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <functional>
#include <string>

namespace predictor {
namespace {

// What `look` says in a process of its own, inside the sandbox.
std::string Inside(const std::function<std::string()>& look) {
  std::array<int, 2> pipe_ends{};
  EXPECT_EQ(pipe(pipe_ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    const std::string missing = EnterSandbox();
    const std::string text = missing.empty() ? look() : "missing: " + missing;
    (void)!write(pipe_ends[1], text.data(), text.size());
    _exit(0);
  }
  close(pipe_ends[1]);
  std::string said;
  std::array<char, 512> part{};
  for (ssize_t n; (n = read(pipe_ends[0], part.data(), part.size())) > 0;)
    said.append(part.data(), static_cast<std::size_t>(n));
  close(pipe_ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status)) << status;
  return said;
}

class SandboxTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string said = Inside([] { return std::string("whole"); });
    if (said.starts_with("missing")) GTEST_SKIP() << "This system lacks it; " << said;
    ASSERT_EQ(said, "whole");
  }
};

TEST_F(SandboxTest, OpensNoFile) {
  ASSERT_GE(access("/etc/passwd", R_OK), 0);
  EXPECT_EQ(Inside([] {
              std::string opened;
              for (const char* file : {"/etc/passwd", "/proc/self/maps", "/dev/null", "."})
                if (open(file, O_RDONLY) >= 0) opened += file;
              if (open("/tmp", O_TMPFILE | O_WRONLY, 0600) >= 0) opened += "/tmp";
              if (mkdir("/tmp/predictor-sandbox-test", 0700) == 0) opened += "mkdir";
              return opened;
            }),
            "");
}

TEST_F(SandboxTest, MakesNoProcessAndNoConnection) {
  EXPECT_EQ(Inside([] {
              std::string made;
              if (fork() >= 0) made += "fork ";
              execl("/bin/true", "true", nullptr);  // would not come back
              for (const int domain : {AF_INET, AF_INET6, AF_UNIX})
                if (socket(domain, SOCK_STREAM, 0) >= 0) made += "socket ";
              return made + "done";
            }),
            "done");
}

TEST_F(SandboxTest, TouchesNoOtherProcess) {
  EXPECT_EQ(Inside([] {
              std::string touched;
              if (kill(getppid(), 0) == 0) touched += "kill ";
              if (tgkill(getppid(), getppid(), 0) == 0) touched += "tgkill ";
              int pair[2];
              if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) == 0) {
                const int owner = getppid();
                const f_owner_ex extended{F_OWNER_PID, owner};
                if (fcntl(pair[0], F_SETOWN, owner) == 0) touched += "F_SETOWN ";
                if (fcntl(pair[0], F_SETOWN_EX, &extended) == 0) touched += "F_SETOWN_EX ";
                if (fcntl(pair[0], F_SETSIG, SIGKILL) == 0) touched += "F_SETSIG ";
                if (ioctl(pair[0], FIOSETOWN, &owner) == 0) touched += "FIOSETOWN ";
                if (ioctl(pair[0], SIOCSPGRP, &owner) == 0) touched += "SIOCSPGRP ";
                if (fcntl(pair[0], F_SETFL, O_NONBLOCK) != 0) touched += "not even its own ";
              } else {
                touched += "no socketpair ";
              }
              if (tgkill(getpid(), gettid(), 0) != 0) touched += "not even itself ";
              return touched + "done";
            }),
            "done");
}

}  // namespace
}  // namespace predictor
