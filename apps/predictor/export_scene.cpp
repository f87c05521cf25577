#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "core/error.h"
#include "export/scene_package.h"
#include "scenario/located.h"
#include "screen.h"

namespace predictor {
namespace {

scene_export::ScenePackage PackageOf(const Scenario& scenario, bool sdf) {
  using scene_export::SceneFormat;
  try {
    return scene_export::MakeScenePackage(scenario, sdf ? SceneFormat::kSdf : SceneFormat::kUrdf);
  } catch (const InputError& error) {
    throw Located(error, scenario);
  }
}

std::string JsonOf(const scene_export::ScenePackage& package, const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& [name, file] : package.files) files.push_back(name);
  const nlohmann::ordered_json result = {
      {"folder", folder}, {"files", files}, {"notes", package.notes}};
  return result.dump(2) + "\n";
}

}  // namespace

int ExportSceneCommand(const ScenarioOptions& options, const ExportOptions& to) {
  const Scenario scenario = options.Load();
  const std::filesystem::path folder =
      to.folder.empty() ? scenario.file.stem().string() + "_scene" : to.folder;
  const scene_export::ScenePackage package = PackageOf(scenario, to.sdf);
  scene_export::WriteScenePackage(package, folder, options.force);
  for (const std::string& note : package.notes) TheScreen().Print(note);
  options.Write("Wrote " + std::to_string(package.files.size()) + " files to " + folder.string() +
                    ". " + (folder / "README.txt").string() + " explains how to load them in " +
                    (to.sdf ? "Gazebo" : "Unity") + ".\n",
                JsonOf(package, folder.string()));
  return kFinished;
}

}  // namespace predictor
