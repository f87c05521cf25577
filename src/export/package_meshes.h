// Manages the mesh and texture files of a package, their names in the package, and the files to
// which they refer.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "export/scene_package.h"
#include "models/urdf.h"

namespace predictor::scene_export {

// All files are in the package's folder "meshes". The file names differ even without their
// extensions and if case is ignored. This is necessary because Unity's URDF-Importer and MuJoCo use
// the file name without its extension as the name of an asset or mesh.
class PackageMeshes {
 public:
  // `scenario_folder` is the folder of the scenario. Textures must be in a place that the scenario
  // may read (scenario/paths.h).
  explicit PackageMeshes(std::filesystem::path scenario_folder)
      : scenario_folder_(std::move(scenario_folder)) {}

  // Adds a shape's mesh and returns its path in the package. `role` ("visual", "collision") is the
  // prefix of a new file's name. The function also adds the files to which the mesh refers
  // (textures, material libraries). Throws InputError if URDF-Importer does not read the format or
  // if the file cannot be read.
  std::string Add(const ModelShape& shape, const std::string& role);
  // Adds a texture to which a URDF refers, and returns its path in the package.
  std::string AddTexture(const std::filesystem::path& file);

  const std::map<std::string, PackageFile>& files() const { return files_; }
  // Returns the files that could not be added, such as "lost.png of box.dae", and sentences with
  // the reasons.
  const std::vector<std::string>& left_out() const { return left_out_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::string NewName(const std::string& role, const std::filesystem::path& file);
  std::string AddReferring(const std::filesystem::path& file, const std::string& role);
  std::string AddReferred(const std::string& uri, const std::filesystem::path& by);

  std::filesystem::path scenario_folder_;
  std::map<std::string, PackageFile> files_;
  std::map<std::filesystem::path, std::string> names_;  // names of the files in the package
  std::set<std::string> stems_;                         // names without extension, in lower case
  std::vector<std::string> left_out_, notes_;
};

}  // namespace predictor::scene_export
