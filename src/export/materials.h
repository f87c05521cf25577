// Determines which visuals of a URDF have their own material. A mesh without one shows the colours
// of its file.
#pragma once

#include <filesystem>
#include <vector>

#include "export/scene_tree.h"
#include "models/urdf.h"

namespace predictor::scene_export {

class UrdfMaterials {
 public:
  // `scenario_folder`: folder of the scenario that refers to the URDF.
  UrdfMaterials(const UrdfModel& urdf, const std::filesystem::path& scenario_folder);

  // Shapes of a link's <visual> elements, by the link's index in the URDF.
  const std::vector<SceneShape>& Visuals(std::size_t link) const { return visuals_[link]; }

 private:
  std::vector<std::vector<SceneShape>> visuals_;
};

}  // namespace predictor::scene_export
