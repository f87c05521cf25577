// Reads any file as a mesh in the format that the first byte selects. Determines the size of the
// mesh and puts the files to which the mesh refers into a package.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "export/package_meshes.h"
#include "fuzz/target.h"
#include "models/mesh_size.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static constexpr const char* kForms[] = {"stl", "obj", "msh", "dae", "mtl"};
  static const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("predictor_fuzz_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const std::filesystem::path file = folder / (std::string("mesh.") + kForms[data[0] % 5]);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  (void)predictor::CountTriangles(file);
  try {
    predictor::scene_export::PackageMeshes package(folder);
    if (data[0] % 5 == 4)
      (void)package.AddTexture(file);
    else
      (void)package.Add({.kind = predictor::ShapeKind::kMesh, .mesh = file}, "visual");
  } catch (const predictor::InputError&) {
  }
  std::filesystem::remove_all(folder);
  return 0;
}
