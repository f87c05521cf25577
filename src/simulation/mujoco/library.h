// Provides owning pointers to MuJoCo's objects, and handles its errors.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

namespace predictor {

struct MujocoDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using SpecPtr = std::unique_ptr<mjSpec, MujocoDeleter>;
using ModelPtr = std::unique_ptr<mjModel, MujocoDeleter>;
using DataPtr = std::unique_ptr<mjData, MujocoDeleter>;

// After this call, MuJoCo prints nothing, writes no log file and does not end the process. MuJoCo's
// warnings are then only counted in mjData, and its errors return to Guarded. Only the first call
// has an effect, and any thread may call it.
void SilenceMujoco();

// Returns the reason why the engine could not compile `spec`, which is the first line of its
// message. The other lines refer to places in the engine's own model.
std::string FirstLine(mjSpec* spec);

// Calls function(model, data) and returns true, or false if MuJoCo raised an error (for instance,
// because an arena is too small). Without this function, such an error would end the process. After
// an error, `data` is unusable until mj_resetData. Does not use the heap or a lock, and does not
// throw.
bool Guarded(void (*function)(const mjModel*, mjData*), const mjModel* model,
             mjData* data) noexcept;

}  // namespace predictor
