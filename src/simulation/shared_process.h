// Runs a separate process that shares memory with the run.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

class SharedProcess {
 public:
  // Makes `size` bytes of memory, all zero. Error messages name the scenario's `key`. Throws
  // InputError.
  SharedProcess(std::string key, std::size_t size);
  // Ends the process.
  ~SharedProcess();
  SharedProcess(const SharedProcess&) = delete;
  SharedProcess& operator=(const SharedProcess&) = delete;

  // Starts the program in `folder`, with the memory as descriptor 3. Throws InputError, with
  // `remedy` as its last sentence.
  void Start(const std::vector<std::string>& command, const std::filesystem::path& folder,
             const std::string& remedy);

  void* memory() const noexcept { return memory_; }

  // Gives the process, but not the processes that it starts, a real-time priority (SCHED_FIFO), or
  // an ordinary one if `priority` is 0. Returns the error's number, 0 for none.
  int SetPriority(int priority) noexcept;

  bool HasEnded() noexcept;
  bool was_seen_to_end() const noexcept { return ended_; }
  // Waits until the program ends by itself, for at most this time [s], and then ends it.
  void End(double patience) noexcept;
  // "exit code 1", or "" while it runs.
  std::string HowItEnded() noexcept;

 private:
  std::string key_;
  std::size_t size_;
  int descriptor_ = -1;  // of the memory, until Start
  void* memory_ = nullptr;
  pid_t pid_ = 0;
  bool ended_ = true;
  int status_ = 0;  // of waitpid
};

}  // namespace predictor
