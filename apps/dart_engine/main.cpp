// predictor-dart: steps a world of DART for a run of PREDICTOR, which starts it. This engine is a
// separate program because Debian's DART aborts on a diverged state, and because DART's libraries
// would conflict with those of PREDICTOR.
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <dart/config.hpp>
#include <exception>
#include <iostream>
#include <memory>

#include "dart_world.h"
#include "simulation/dart/protocol.h"
#include "simulation/dart/turn.h"

namespace predictor::dart_engine {
namespace {

enum : int { kEnded = 0, kBadStart = 2 };  // exit codes

// If a value exceeded this limit, DART's own checks would end the process.
constexpr double kLargest = 1e9;

bool IsUsable(const double* values, int size) {
  for (int i = 0; i < size; ++i)
    if (!(std::fabs(values[i]) <= kLargest)) return false;
  return true;
}

bool IsUsable(const StateData& state, const ForceData& forces) {
  return IsUsable(state.q, kMaxPositions) && IsUsable(state.v, kMaxDof) &&
         IsUsable(state.hand_mass, kHandCount) && IsUsable(forces.joint, kMaxDof) &&
         IsUsable(forces.object, 6) && IsUsable(forces.coulomb, kMaxJoints);
}

class Server {
 public:
  explicit Server(Memory* memory) : memory_(*memory) {}

  Result Answer() noexcept {
    try {
      if (memory_.kind == Request::kBuild) {
        scene_ = memory_.scene;
        world_ = std::make_unique<DartWorld>(scene_);
        return Result::kDone;
      }
      if (world_ == nullptr) throw std::runtime_error("no scene");
      if (!IsUsable(memory_.state, memory_.forces)) return Result::kNotFinite;
      if (memory_.kind == Request::kPrepare) return world_->Prepare(&memory_);
      if (memory_.kind == Request::kAccelerations) return world_->Accelerations(&memory_);
      return world_->Advance(&memory_);
    } catch (const std::exception& error) {
      std::snprintf(memory_.text, sizeof memory_.text, "%s", error.what());
      return Result::kFailed;
    }
  }

  void Serve(pid_t run) {
    for (std::uint32_t last = 0;;) {
      while (!WaitForChange(&memory_.request, last))
        if (getppid() != run) return;
      last = Load(&memory_.request);
      if (memory_.kind == Request::kEnd) return;
      memory_.result = Answer();
      Publish(&memory_.answer, last);
    }
  }

 private:
  Memory& memory_;
  SceneData scene_{};
  std::unique_ptr<DartWorld> world_;
};

int Main() {
  const pid_t run = getppid();
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  std::cerr.setstate(std::ios::badbit);  // DART warns there about bodies without mass
  void* address = mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, kDescriptor, 0);
  if (address == MAP_FAILED) {
    std::fputs("predictor-dart is started by predictor.\n", stderr);
    return kBadStart;
  }
  Memory* memory = static_cast<Memory*>(address);
  if (memory->version != kVersion || memory->size != sizeof(Memory)) {
    std::fputs("predictor-dart and predictor have different versions. Build both again.\n", stderr);
    return kBadStart;
  }
  Server(memory).Serve(run);
  return kEnded;
}

}  // namespace
}  // namespace predictor::dart_engine

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], predictor::dart_engine::kVersionOption) == 0) {
    std::fputs("DART " DART_VERSION, stdout);
    return 0;
  }
  return predictor::dart_engine::Main();
}
