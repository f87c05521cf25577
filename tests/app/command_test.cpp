// The program as a script or a shell meets it: exit codes, streams, signals.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

extern char** environ;

namespace {

namespace fs = std::filesystem;

std::string Scenario(const std::string& name) {
  return std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name + ".yaml";
}

// A running `predictor`, its standard input empty.
class Child {
 public:
  // out: file that standard output goes to; empty: a pipe that is kept.
  explicit Child(std::vector<std::string> arguments, const std::string& out = "") {
    std::array<int, 2> output{}, error{};
    EXPECT_EQ(pipe(output.data()), 0);
    EXPECT_EQ(pipe(error.data()), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    if (out.empty())
      posix_spawn_file_actions_adddup2(&actions, output[1], 1);
    else
      posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, error[1], 2);
    for (const int end : {output[0], output[1], error[0], error[1]})
      posix_spawn_file_actions_addclose(&actions, end);
    arguments.insert(arguments.begin(), "predictor");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&pid_, PREDICTOR_BINARY, &actions, nullptr, argv.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(output[1]);
    close(error[1]);
    out_ = output[0];
    error_ = error[0];
  }
  ~Child() {
    if (pid_ > 0) kill(pid_, SIGKILL), waitpid(pid_, nullptr, 0);
    CloseStreams();
  }

  // Waits until the error stream says `text`.
  bool Says(const std::string& text) {
    while (errors_.find(text) == std::string::npos)
      if (!ReadSome()) return errors_.find(text) != std::string::npos;
    return true;
  }
  void Send(int signal) const { kill(pid_, signal); }
  void CloseStreams() {
    if (out_ >= 0) close(out_);
    if (error_ >= 0) close(error_);
    out_ = error_ = -1;
  }
  // Exit code; −signal if one killed it.
  int Wait() {
    while (out_ >= 0 && ReadSome()) {
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  int pid() const { return pid_; }
  const std::string& output() const { return outputs_; }
  const std::string& errors() const { return errors_; }

 private:
  bool ReadSome() {
    std::array<pollfd, 2> ready = {pollfd{out_, POLLIN, 0}, pollfd{error_, POLLIN, 0}};
    if (poll(ready.data(), 2, 60'000) <= 0) return false;
    bool any = false;
    for (const pollfd& stream : ready) {
      if ((stream.revents & (POLLIN | POLLHUP)) == 0) continue;
      std::array<char, 4096> text;
      const ssize_t n = read(stream.fd, text.data(), text.size());
      if (n > 0) {
        (stream.fd == out_ ? outputs_ : errors_).append(text.data(), static_cast<std::size_t>(n));
        any = true;
      }
    }
    return any;
  }

  pid_t pid_ = -1;
  int out_ = -1, error_ = -1;
  std::string outputs_, errors_;
};

TEST(ExitCode, TellsHowItEnded) {
  const struct {
    std::vector<std::string> arguments;
    int code;
  } cases[] = {
      {{"simulate", Scenario("box_9kg"), "--duration", "1", "--quiet"}, 0},
      {{"simulate", Scenario("push"), "--quiet"}, 1},
      {{"simulate", Scenario("no_such_scenario")}, 2},
      {{"simulate", Scenario("box_9kg"), "--set", "safety.force=-1"}, 2},
      {{"simulate"}, 2},
      {{"dance"}, 2},
      {{}, 2},
      {{"--help"}, 0},
      {{"run", "--help"}, 0},
      {{"--version"}, 0},
      {{"schema"}, 0},
      {{"check", Scenario("box_9kg"), "--no-search", "--quiet"}, 0},
      {{"check", Scenario("underdamped"), "--no-search", "--quiet"}, 1},
  };
  for (const auto& c : cases) {
    Child child(c.arguments);
    EXPECT_EQ(child.Wait(), c.code) << testing::PrintToString(c.arguments) << child.errors();
  }
}

TEST(ExitCode, OfARunThatNeverStartedComesWithTheArmAndItsDistance) {
  Child child({"simulate", Scenario("box_9kg"), "--quiet", "--set", "safety.align_tolerance=1e-9"});
  EXPECT_EQ(child.Wait(), 3);
  EXPECT_NE(child.errors().find("the left arm stayed"), std::string::npos) << child.errors();
}

TEST(ExitCode, OfAnUnknownCommandComesWithItsName) {
  Child child({"dance"});
  EXPECT_EQ(child.Wait(), 2);
  EXPECT_NE(child.errors().find("no command 'dance'"), std::string::npos) << child.errors();
}

TEST(Summary, GoesToStandardOutputAloneOrToAFile) {
  Child child({"simulate", Scenario("box_9kg"), "--duration", "1", "--summary", "-"});
  EXPECT_EQ(child.Wait(), 0);
  const auto summary = nlohmann::json::parse(child.output());
  EXPECT_EQ(summary["ticks"], 1000);
  EXPECT_DOUBLE_EQ(summary["duration_s"], 1);
  EXPECT_NE(child.errors().find("No safety stop."), std::string::npos);  // the table

  const fs::path file = fs::temp_directory_path() / ("summary-" + std::to_string(getpid()));
  Child other({"simulate", Scenario("box_9kg"), "--duration", "1", "--summary", file.string()});
  EXPECT_EQ(other.Wait(), 0);
  std::ifstream stream(file);
  EXPECT_EQ(nlohmann::json::parse(stream)["seed"], 1);
  fs::remove(file);
}

TEST(Summary, ThatCannotBeWrittenIsToldBeforeTheRunOrFails) {
  Child nowhere({"simulate", Scenario("box_9kg"), "--summary", "/no/such/folder/file"});
  EXPECT_EQ(nowhere.Wait(), 2);
  EXPECT_NE(nowhere.errors().find("cannot be written"), std::string::npos);
  EXPECT_EQ(nowhere.errors().find("Simulating"), std::string::npos);
  Child full({"simulate", Scenario("box_9kg"), "--duration", "1", "--summary", "-"}, "/dev/full");
  EXPECT_EQ(full.Wait(), 3);
}

// Whatever asks a run to end has the arms brought to rest first, and the summary told.
class Signals : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, Signals, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT));

TEST_P(Signals, EndARunAtRest) {
  Child child({"run", Scenario("box_9kg"), "--viewer", "off", "--summary", "-"});
  ASSERT_TRUE(child.Says("RUN")) << child.errors();
  child.Send(GetParam());
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  const auto summary = nlohmann::json::parse(child.output());
  EXPECT_TRUE(summary["stop"].is_null());
  EXPECT_LT(summary["duration_s"], 29);
  EXPECT_GT(summary["ticks"], 0);
}

TEST(Signals, BeforeTheStartAreNoFailure) {
  Child child({"run", Scenario("box_9kg"), "--viewer", "off"});
  ASSERT_TRUE(child.Says("Device"));
  child.Send(SIGINT);
  EXPECT_EQ(child.Wait(), 0) << child.errors();
}

// The page's process, child of the run; 0 if there is none.
int ViewerOf(int run) {
  std::ifstream children("/proc/" + std::to_string(run) + "/task/" + std::to_string(run) +
                         "/children");
  for (int child = 0; children >> child;) {
    std::ifstream command("/proc/" + std::to_string(child) + "/cmdline");
    std::string text;
    std::getline(command, text);
    if (text.find("viewer-process") != std::string::npos) return child;
  }
  return 0;
}

// Whatever becomes of the page, the tick goes on, and no tick is lost by it.
TEST(Viewer, ThatIsKilledStopsNothing) {
  Child child({"run", Scenario("box_9kg"), "--port", "0", "--duration", "6", "--summary", "-"});
  ASSERT_TRUE(child.Says("/#code=")) << child.errors();
  ASSERT_TRUE(child.Says("RUN")) << child.errors();
  const int viewer = ViewerOf(child.pid());
  ASSERT_GT(viewer, 0);
  ASSERT_EQ(kill(viewer, SIGKILL), 0);
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  const auto summary = nlohmann::json::parse(child.output());
  EXPECT_TRUE(summary["stop"].is_null());
  EXPECT_EQ(summary["ticks"], 6000);
}

TEST(Viewer, OfASecondRunOnTheSamePortIsRefusedInWords) {
  Child first({"run", Scenario("box_9kg"), "--port", "0"});
  ASSERT_TRUE(first.Says("/#code=")) << first.errors();
  const std::size_t at = first.errors().find("localhost:") + 10;
  const std::string port = first.errors().substr(at, first.errors().find('/', at) - at);
  Child second({"run", Scenario("box_9kg"), "--port", port});
  EXPECT_EQ(second.Wait(), 2);
  EXPECT_NE(second.errors().find("--port"), std::string::npos) << second.errors();
}

TEST(RosTcp, IsServedBesideTheRun) {
  Child child({"run", Scenario("box_9kg"), "--viewer", "off", "--ros-tcp", "--ros-tcp-port", "0",
               "--ros-tcp-mode", "ros2", "--duration", "1"});
  EXPECT_TRUE(child.Says("ROS-TCP   port ")) << child.errors();
  EXPECT_TRUE(child.Says("ROS2"));
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  Child wrong({"run", Scenario("box_9kg"), "--viewer", "off", "--ros-tcp", "--ros-tcp-port", "0",
               "--ros-tcp-allow", "everywhere"});
  EXPECT_EQ(wrong.Wait(), 2);
  EXPECT_NE(wrong.errors().find("is not a network"), std::string::npos);
}

TEST(Streams, ThatAreClosedEndNothing) {
  Child child({"run", Scenario("box_9kg"), "--viewer", "off", "--duration", "4"});
  ASSERT_TRUE(child.Says("RUN"));
  child.CloseStreams();
  EXPECT_GE(child.Wait(), 0);  // not killed by SIGPIPE
}

}  // namespace
