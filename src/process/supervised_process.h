// Implements the run's side of the connection to a process alongside the run. The run starts the
// process, listens to it, and restarts the process if it dies or falls silent. Neither the messages
// nor the death of this process can move the arms.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "process/control_channel.h"

namespace predictor {

struct ChildSetup {
  std::string name;        // beginning of a sentence: "The viewer"
  std::string subcommand;  // subcommand that starts the process: `predictor SUBCOMMAND`
  // The first line that is sent to the process. The keys "parent" and, once the process has
  // reported a port, "port" are added to this line.
  Json start;
  int board = -1;    // descriptor; not owned
  int mailbox = -1;  // likewise: the only memory that the process may write; -1: none
  // Receives messages for the user, of one or several lines. A separate thread calls this function
  // and `hear`. Before this thread starts, the constructor calls this function.
  std::function<void(const std::string& text)> notify;
  // Receives each line from the process except {"say": …} and {"error": …}, which go to `notify`.
  // The content of these lines is not trusted.
  std::function<void(const Json& line)> hear;
  // The longest pause before a restart. The pause grows after each short-lived start.
  std::chrono::milliseconds longest_pause{60'000};
  // The counter of the process's signs of life in shared memory, or null if the process has no such
  // counter. The supervisor reports a short silence, and ends the process after a longer silence.
  const std::atomic<std::uint32_t>* beats = nullptr;
  std::string without = "the run continues";  // describes the state of the run while there is no
                                              // such process
  int reads = -1;    // descriptor of another process's memory, for reading; not owned; -1: none
  int streams = -1;  // likewise, of a StreamBoard
};

class SupervisedProcess {
 public:
  // Starts the process and waits for the line {"ready": …}. Uses posix_spawn, which does not copy
  // the run's memory. After a fork, the first write to each page would cause a page fault, even in
  // the control loop. The process inherits only the descriptors above and its control channel.
  // Throws InputError with the process's error message, or std::runtime_error if the process cannot
  // be started.
  explicit SupervisedProcess(ChildSetup setup);
  ~SupervisedProcess();

  int pid() const;             // 0: there is no process at present
  std::uint16_t port() const;  // 0: the process reported no port
  // Sends a line from any thread, without waiting. Returns false if no process is running at
  // present or if the process does not read. If the process does not read, part of the line may
  // have been sent, so the caller should send no further lines.
  bool Ask(const Json& line);
  // Ends the process immediately. The run then starts the process again.
  void Kill();
  // Sets `key` of ChildSetup::start to `value`, so the process receives it if it is started again.
  void Remember(const std::string& key, const Json& value);

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
