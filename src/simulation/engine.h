// MuJoCo's objects with owners, and its errors caught.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>

namespace predictor {

struct MujocoDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using SpecPtr = std::unique_ptr<mjSpec, MujocoDeleter>;
using ModelPtr = std::unique_ptr<mjModel, MujocoDeleter>;
using DataPtr = std::unique_ptr<mjData, MujocoDeleter>;

// From here on MuJoCo prints nothing, writes no log file and does not end the process: its warnings
// are counted in mjData only, and its errors return to Guarded. Done once; any thread.
void SilenceMujoco();

// Calls function(model, data) and returns true; false if MuJoCo raised an error in it (an arena
// too small, for instance), where by default it would end the process. `data` is then unusable
// until mj_resetData. No heap, lock or exception.
bool Guarded(void (*function)(const mjModel*, mjData*), const mjModel* model,
             mjData* data) noexcept;

}  // namespace predictor
