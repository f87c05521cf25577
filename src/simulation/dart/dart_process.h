// The run's side of the program predictor-dart.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "simulation/dart/protocol.h"
#include "simulation/shared_process.h"

namespace predictor {

class DartProcess {
 public:
  // Starts the program and gives it the scene. Throws InputError if the program was not built or
  // cannot read the scene.
  explicit DartProcess(const dart_engine::SceneData& scene);
  ~DartProcess();
  DartProcess(const DartProcess&) = delete;
  DartProcess& operator=(const DartProcess&) = delete;

  // Returns the contents of the next request, and of the last answer.
  dart_engine::Memory& memory() noexcept { return *memory_; }

  // Sends a request and waits for the answer. Returns false if the step failed, or if the program
  // ended or no longer answers. Does not use the heap.
  bool Ask(dart_engine::Request kind) noexcept;

  // Returns a sentence that states why the program no longer answers, or "" if it does.
  std::string Failure() noexcept;
  // Starts the program again if it ended; does nothing if that is impossible.
  void Revive() noexcept;

 private:
  void Start();

  dart_engine::SceneData scene_;
  std::unique_ptr<SharedProcess> process_;
  dart_engine::Memory* memory_ = nullptr;
  std::uint32_t request_ = 0;  // number of the last one
  bool is_silent_ = false;
  std::string failure_;
};

// Returns whether this build contains the program.
bool HasDart();

// Returns what the program says, "DART 6.12.1" for example, or "" if there is none.
std::string DartVersion();

}  // namespace predictor
