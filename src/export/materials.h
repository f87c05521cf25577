// Which visuals of a URDF have a material of their own: a mesh without one shows its file's
// colours.
#pragma once

#include <filesystem>
#include <vector>

#include "export/scene_tree.h"
#include "models/urdf.h"

namespace predictor {

class UrdfMaterials {
 public:
  // `scenario_folder`: of the scenario that asks for the URDF.
  UrdfMaterials(const UrdfModel& urdf, const std::filesystem::path& scenario_folder);

  // Shapes of <visual> of a link, by its index in the URDF.
  const std::vector<SceneShape>& Visuals(std::size_t link) const { return visuals_[link]; }

 private:
  std::vector<std::vector<SceneShape>> visuals_;
};

}  // namespace predictor
