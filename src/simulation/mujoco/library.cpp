#include "simulation/mujoco/library.h"

#include <csetjmp>
#include <mutex>

namespace predictor {
namespace {

thread_local std::jmp_buf* return_point = nullptr;

// MuJoCo ends the process if this function returns after an error, so it must not return.
void OnMessage(const mjLogMessage* message) {
  if (message->level == mjLOG_ERROR && return_point != nullptr) std::longjmp(*return_point, 1);
}

}  // namespace

void SilenceMujoco() {
  static std::once_flag once;
  std::call_once(once, [] { mju_setLogHandler(OnMessage); });
}

std::string FirstLine(mjSpec* spec) {
  const std::string error = mjs_getError(spec);
  return error.substr(0, error.find('\n'));
}

// Only MuJoCo's C frames are between setjmp and longjmp, so no destructor is skipped.
bool Guarded(void (*function)(const mjModel*, mjData*), const mjModel* model,
             mjData* data) noexcept {
  std::jmp_buf here;
  if (setjmp(here) != 0) {
    return_point = nullptr;
    return false;
  }
  return_point = &here;
  function(model, data);
  return_point = nullptr;
  return true;
}

}  // namespace predictor
