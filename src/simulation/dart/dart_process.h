// The program predictor-dart, as the run sees it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "simulation/dart/protocol.h"
#include "simulation/shared_process.h"

namespace predictor {

class DartProcess {
 public:
  // Starts the program and gives it the scene. Throws InputError: the program was not built, or it
  // cannot read the scene.
  explicit DartProcess(const dart_engine::SceneData& scene);
  ~DartProcess();
  DartProcess(const DartProcess&) = delete;
  DartProcess& operator=(const DartProcess&) = delete;

  // What the next request contains, and the last answer.
  dart_engine::Memory& memory() noexcept { return *memory_; }

  // Sends a request and waits for the answer. Returns false if the step failed, and if the program
  // ended or no longer answers. Uses no heap.
  bool Ask(dart_engine::Request kind) noexcept;

  // Why the program no longer answers, as a sentence; "" if it does.
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

// Whether this build has the program.
bool HasDart();

}  // namespace predictor
