// Runs the program as a separate process.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <string>
#include <vector>

extern char** environ;

namespace predictor {

// A running `predictor` whose standard input is empty.
class Child {
 public:
  // A run without --record is started with --no-record. `out` is the file that receives standard
  // output. If `out` is empty, a pipe receives the output. `errors_to` is the descriptor that
  // receives standard error. If `errors_to` is negative, a pipe receives the output.
  explicit Child(std::vector<std::string> arguments, const std::string& out = "",
                 int errors_to = -1) {
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
    posix_spawn_file_actions_adddup2(&actions, errors_to >= 0 ? errors_to : error[1], 2);
    for (const int end : {output[0], output[1], error[0], error[1]})
      posix_spawn_file_actions_addclose(&actions, end);
    if (!arguments.empty() && arguments[0] == "run" &&
        std::find(arguments.begin(), arguments.end(), "--record") == arguments.end())
      arguments.emplace_back("--no-record");
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

  // Waits until the error stream contains `text`.
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
  // Returns the exit code, or −signal if a signal killed the process.
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

}  // namespace predictor
