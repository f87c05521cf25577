// A process beside the run, on the run's side: started, listened to, started again if it dies. What
// it does, or that it dies, moves nothing.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "process/control_channel.h"

namespace predictor {

struct ChildSetup {
  std::string name;        // as a sentence begins: "The viewer"
  std::string subcommand;  // by which this program becomes it: `predictor SUBCOMMAND`
  // The first line that it gets; "parent" comes along, and "port" once it has told one.
  Json start;
  int board = -1;    // descriptor, borrowed
  int mailbox = -1;  // likewise: what it may write into, and it alone; -1: nothing
  // What a person is to be told, a line or several. Like `hear`, called in a thread of its own, and
  // before that in the constructor.
  std::function<void(const std::string& text)> tell;
  // Each line that it says, but for {"say": …} and {"error": …}, which are told: believed in
  // nothing.
  std::function<void(const Json& line)> hear;
  // Between its end and its next start, which comes later after each that is short-lived.
  std::chrono::milliseconds longest_pause{60'000};
};

class SupervisedProcess {
 public:
  // Starts it and waits for the line {"ready": …}. By posix_spawn, which never copies the run's
  // memory: a fork would make each of its pages fault once, in the loop too; nothing is inherited
  // but those descriptors and its control channel. Throws InputError with what it says,
  // std::runtime_error if there can be no process.
  explicit SupervisedProcess(ChildSetup setup);
  ~SupervisedProcess();

  int pid() const;             // 0 while there is none
  std::uint16_t port() const;  // 0: it told none
  // Without waiting, from any thread; lost if it does not read.
  void Ask(const Json& line);
  // What it is to be told if it has to start again: `value` at `key` of ChildSetup::start.
  void Remember(const std::string& key, const Json& value);

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
