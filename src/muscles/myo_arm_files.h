// Loads MyoArm's files into MuJoCo's structures.
#pragma once

#include <mujoco/mujoco.h>

#include <filesystem>
#include <memory>

namespace predictor::muscles {

struct MyoDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using MyoModel = std::unique_ptr<mjModel, MyoDeleter>;
using MyoData = std::unique_ptr<mjData, MyoDeleter>;

// Reads a folder with MyoArm's parts or an MJCF file (see LoadMyoArm), without meshes and with
// the middle deltoid on the outer side of the upper arm. Throws InputError.
MyoModel ReadMyoArm(const std::filesystem::path& model);

}  // namespace predictor::muscles
