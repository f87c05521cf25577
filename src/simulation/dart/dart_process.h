// Implements the emulator's side of the connection to the program predictor-dart.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "simulation/dart/protocol.h"
#include "simulation/shared_process.h"

namespace predictor {

class DartProcess {
 public:
  // Starts the program and sends the scene to the program. Throws InputError if the program was not
  // built or cannot read the scene.
  explicit DartProcess(const dart_engine::SceneData& scene);
  ~DartProcess();
  DartProcess(const DartProcess&) = delete;
  DartProcess& operator=(const DartProcess&) = delete;

  // Returns the contents of the next request, and of the last answer.
  dart_engine::Memory& memory() noexcept { return *memory_; }

  // Sends a request and waits for the answer. Returns false if the step failed, or if the program
  // ended or no longer answers. Does not use the heap.
  bool Ask(dart_engine::Request kind) noexcept;

  // Returns a sentence that states why the program no longer answers, or "" if the program still
  // answers.
  std::string Failure() noexcept;
  // Restarts the program if it has ended. If a restart is impossible, the function does nothing.
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

// Returns the version that the program reports, for example "DART 6.12.1", or "" if there is no
// program.
std::string DartVersion();

}  // namespace predictor
