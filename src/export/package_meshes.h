// The mesh and texture files of a package: what each is called there, and what it refers to.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "export/scene_package.h"
#include "models/urdf.h"

namespace predictor {

// All files lie in the folder "meshes" of the package. No two of them share a name without its
// extension, whatever the case: Unity's URDF-Importer makes assets named after it, and MuJoCo names
// meshes by it.
class PackageMeshes {
 public:
  // `scenario_folder`: of the scenario; textures must lie where it may read (scenario/paths.h).
  explicit PackageMeshes(std::filesystem::path scenario_folder)
      : scenario_folder_(std::move(scenario_folder)) {}

  // Path in the package of a shape's mesh; `role` ("visual", "collision") begins a new file's name.
  // What the mesh's file refers to (textures, material libraries) comes along. Throws InputError
  // for a format that URDF-Importer does not read, and if the file cannot be read.
  std::string Add(const ModelShape& shape, const std::string& role);
  // The same of a texture that a URDF names.
  std::string AddTexture(const std::filesystem::path& file);

  const std::map<std::string, PackageFile>& files() const { return files_; }
  // What could not be had, as "lost.png of box.dae", and sentences on why.
  const std::vector<std::string>& left_out() const { return left_out_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::string NewName(const std::string& role, const std::filesystem::path& file);
  std::string AddReferring(const std::filesystem::path& file, const std::string& role);
  std::string AddReferred(const std::string& uri, const std::filesystem::path& by);

  std::filesystem::path scenario_folder_;
  std::map<std::string, PackageFile> files_;
  std::map<std::filesystem::path, std::string> names_;  // of files that are in the package
  std::set<std::string> stems_;                         // in lower case
  std::vector<std::string> left_out_, notes_;
};

}  // namespace predictor
