// Runs a separate process that shares memory with the emulator.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

class SharedProcess {
 public:
  // Makes `size` bytes of memory and sets them to zero. Error messages name the scenario's `key`.
  // Throws InputError.
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

  // Gives the process, but not the processes that it starts, a real-time priority (SCHED_FIFO). If
  // `priority` is 0, gives it an ordinary priority. Returns the number of the error, or 0 if there
  // is no error.
  int SetPriority(int priority) noexcept;

  bool HasEnded() noexcept;
  bool was_seen_to_end() const noexcept { return ended_; }
  // Waits for at most this time [s] until the program ends by itself. If it is still running then,
  // ends it.
  void End(double patience) noexcept;
  // Returns how the process ended (for example, "exit code 1"), or "" while it runs.
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
