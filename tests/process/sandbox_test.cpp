// Tests which rights a process keeps after it has entered the sandbox. The tests run inside this
// process.
#include "process/sandbox.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/sockios.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/ipc.h>
#include <sys/mman.h>
#include <sys/msg.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace predictor {
namespace {

using Enter = std::function<std::string()>;

// Returns the result of `look` in a separate process inside the sandbox.
std::string Inside(const Enter& enter, const std::function<std::string()>& look) {
  std::array<int, 2> pipe_ends{};
  EXPECT_EQ(pipe(pipe_ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    const std::string missing = enter();
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
std::string Inside(const std::function<std::string()>& look) { return Inside(EnterSandbox, look); }

// This function queries the kernel itself, without the code under test.
bool KernelHasBoth() {
  constexpr long kCreateRuleset = 444;
  return syscall(kCreateRuleset, nullptr, 0, 1) >= 1 && prctl(PR_GET_SECCOMP) >= 0;
}

class SandboxTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!KernelHasBoth()) GTEST_SKIP() << "This kernel lacks Landlock or seccomp.";
    ASSERT_EQ(Inside([] { return std::string("whole"); }), "whole");
  }
};

// System calls by number. Outside the sandbox, each of these calls succeeds or fails with an error
// other than EPERM.
struct Call {
  const char* name;
  std::function<long()> make;
};

std::vector<Call> Dangerous(const std::string& file) {
  const char* f = file.c_str();
  static char buffer[256];
  return {
      {"open", [] { return open("/etc/passwd", O_RDONLY); }},
      {"openat2",
       [] {
         const std::array<std::uint64_t, 3> how{};
         return syscall(SYS_openat2, AT_FDCWD, "/etc/passwd", how.data(), sizeof how);
       }},
      {"socket", [] { return socket(AF_INET, SOCK_DGRAM, 0); }},
      {"AF_UNIX", [] { return socket(AF_UNIX, SOCK_STREAM, 0); }},
      {"execve", [] { return execl("/bin/true", "true", nullptr); }},
      {"execveat",
       [] {
         const std::array<const char*, 2> arguments = {"true", nullptr};
         return syscall(SYS_execveat, AT_FDCWD, "/bin/true", arguments.data(), nullptr, 0);
       }},
      {"fork", [] { return fork(); }},
      {"chmod", [f] { return chmod(f, 0777); }},
      {"fchmodat2", [f] { return syscall(452, AT_FDCWD, f, 0777, 0); }},
      {"setxattr", [f] { return setxattr(f, "user.a", "b", 1, 0); }},
      {"utimensat", [f] { return utimensat(AT_FDCWD, f, nullptr, 0); }},
      {"shmget", [] { return shmget(IPC_PRIVATE, 4096, IPC_CREAT | 0600); }},
      {"memfd_create", [] { return memfd_create("a", 0); }},
      {"msgget", [] { return msgget(IPC_PRIVATE, IPC_CREAT | 0600); }},
      {"kill", [] { return kill(getppid(), 0); }},
      {"tgkill", [] { return tgkill(getppid(), getppid(), 0); }},
      {"ptrace", [] { return ptrace(PTRACE_SEIZE, getppid(), nullptr, nullptr); }},
      {"io_uring_setup", [] { return syscall(SYS_io_uring_setup, 1, buffer); }},
      {"bpf", [] { return syscall(SYS_bpf, 0, buffer, 64); }},
      {"userfaultfd", [] { return syscall(SYS_userfaultfd, 0); }},
      {"unshare", [] { return unshare(CLONE_NEWUSER); }},
      {"executable memory",
       [] {
         void* memory = mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC,
                             MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
         return memory == MAP_FAILED ? -1L : 0L;
       }},
  };
}

// Returns the calls that do not fail with EPERM.
std::string NotRefused(const std::vector<Call>& calls) {
  std::string passed;
  for (const Call& call : calls) {
    errno = 0;
    const long result = call.make();
    if (result != -1 || errno != EPERM)
      passed += std::string(call.name) + " " + std::to_string(result) + "/" +
                std::to_string(errno) + ", ";
  }
  return passed;
}

// Returns the system calls that only query data. Only the second stage of the sandbox refuses them.
std::vector<Call> Looking() {
  static struct stat status {};
  static char buffer[4096];
  return {
      {"stat", [] { return stat("/etc/shadow", &status); }},
      {"statx", [] { return syscall(SYS_statx, AT_FDCWD, "/etc/shadow", 0, 0x7ff, buffer); }},
      {"access", [] { return access("/etc/shadow", F_OK); }},
      {"readlink", [] { return readlink("/proc/self/exe", buffer, sizeof buffer); }},
      {"TCP socket", [] { return socket(AF_INET, SOCK_STREAM, 0); }},
      {"setresuid", [] { return setresuid(1, 1, 1); }},
      {"prlimit", [] { return syscall(SYS_prlimit64, 0, RLIMIT_NOFILE, nullptr, buffer); }},
  };
}

TEST_F(SandboxTest, RefusesAllThatIsNotNeeded) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() / "file";
  std::ofstream(file) << "text";
  EXPECT_EQ(Inside([&] { return NotRefused(Dangerous(file)) + NotRefused(Looking()); }), "");
}

// While the process prepares itself, it may read, but it must not make any of the following calls.
TEST_F(SandboxTest, RefusesTheSameWhileItPrepares) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() / "file";
  std::ofstream(file) << "text";
  Preparation may;
  may.read = {folder.path()};
  may.write = {folder.path()};
  may.listen = may.give_up_more = true;
  std::vector<Call> calls = Dangerous(file);
  calls.erase(calls.begin());  // Landlock refuses open, see below
  EXPECT_EQ(Inside([&] { return EnterPreparation(may); }, [&] { return NotRefused(calls); }), "");
}

TEST_F(SandboxTest, ReadsWhatItMayWhileItPrepares) {
  const test::TemporaryFolder folder, other;
  const std::string file = folder.path() / "file", foreign = other.path() / "file";
  std::ofstream(file) << "text";
  std::ofstream(foreign) << "text";
  Preparation may;
  may.read = {folder.path(), folder.path() / "missing"};
  may.give_up_more = true;
  const auto enter = [&] { return EnterPreparation(may); };
  EXPECT_EQ(Inside(enter,
                   [&] {
                     std::string text;
                     std::ifstream(file) >> text;
                     for (const std::string& name : {foreign, std::string("/etc/passwd")})
                       if (open(name.c_str(), O_RDONLY) >= 0) text += " reads " + name;
                     if (open(file.c_str(), O_WRONLY) >= 0) text += " writes";
                     if (open((file + "2").c_str(), O_CREAT | O_WRONLY, 0600) >= 0)
                       text += " makes";
                     if (unlink(file.c_str()) == 0) text += " removes";
                     if (socket(AF_INET, SOCK_STREAM, 0) >= 0) text += " connects";
                     if (!EnterSandbox().empty()) text += " cannot continue";
                     if (open(file.c_str(), O_RDONLY) >= 0) text += " reads later";
                     return text;
                   }),
            "text");
}

TEST_F(SandboxTest, WritesWhereItMayAlone) {
  const test::TemporaryFolder folder, other;
  Preparation may;
  may.write = {folder.path()};
  EXPECT_EQ(Inside([&] { return EnterPreparation(may); },
                   [&] {
                     std::ofstream(folder.path() / "in") << "text";
                     std::ofstream(other.path() / "out") << "text";
                     return std::string("done");
                   }),
            "done");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "in"));
  EXPECT_FALSE(std::filesystem::exists(other.path() / "out"));
}

TEST_F(SandboxTest, OpensPortsButMakesNoConnectionWhileItPrepares) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  Preparation may;
  may.listen = true;
  EXPECT_EQ(Inside([&] { return EnterPreparation(may); },
                   [&] {
                     const auto* to = reinterpret_cast<const sockaddr*>(&address);
                     const int port = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
                     std::string done = listen(port, 1) == 0 ? "listens" : "";
                     const int second = socket(AF_INET, SOCK_STREAM, 0);
                     if (connect(second, to, size) == 0) done += " connects";
                     if (sendto(second, "x", 1, MSG_FASTOPEN, to, size) >= 0) done += " sends";
                     if (socket(AF_INET, SOCK_DGRAM, 0) >= 0) done += " UDP";
                     return done;
                   }),
            "listens");
  close(listener);
}

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
              execl("/bin/true", "true", nullptr);  // would not return on success
              for (const int domain : {AF_INET, AF_INET6, AF_UNIX})
                if (socket(domain, SOCK_STREAM, 0) >= 0) made += "socket ";
              return made + "done";
            }),
            "done");
}

TEST_F(SandboxTest, TouchesNoOtherProcess) {
  int pair[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
  EXPECT_EQ(Inside([&] {
              std::string touched;
              if (kill(getppid(), 0) == 0) touched += "kill ";
              if (tgkill(getppid(), getppid(), 0) == 0) touched += "tgkill ";
              const int owner = getppid();
              const f_owner_ex extended{F_OWNER_PID, owner};
              if (fcntl(pair[0], F_SETOWN, owner) == 0) touched += "F_SETOWN ";
              if (fcntl(pair[0], F_SETOWN_EX, &extended) == 0) touched += "F_SETOWN_EX ";
              if (fcntl(pair[0], F_SETSIG, SIGKILL) == 0) touched += "F_SETSIG ";
              if (ioctl(pair[0], FIOSETOWN, &owner) == 0) touched += "FIOSETOWN ";
              if (ioctl(pair[0], SIOCSPGRP, &owner) == 0) touched += "SIOCSPGRP ";
              if (fcntl(pair[0], F_SETFL, O_NONBLOCK) != 0) touched += "not even its own ";
              if (tgkill(getpid(), gettid(), 0) != 0) touched += "not even itself ";
              return touched + "done";
            }),
            "done");
  close(pair[0]), close(pair[1]);
}

}  // namespace
}  // namespace predictor
