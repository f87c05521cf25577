#include <cstdio>

#include "commands.h"
#include "core/error.h"
#include "export/scene_package.h"
#include "scenario/located.h"

namespace predictor {
namespace {

ScenePackage PackageOf(const Scenario& scenario) {
  try {
    return MakeScenePackage(scenario);
  } catch (const InputError& error) {
    throw Located(error, scenario);
  }
}

}  // namespace

int ExportSceneCommand(const ScenarioOptions& options, const ExportOptions& to) {
  const Scenario scenario = options.Load();
  const std::filesystem::path folder =
      to.folder.empty() ? scenario.file.stem().string() + "_scene" : to.folder;
  const ScenePackage package = PackageOf(scenario);
  WriteScenePackage(package, folder, to.force);
  for (const std::string& note : package.notes) std::fprintf(stderr, "%s\n", note.c_str());
  if (!options.quiet) {
    WriteOut("Wrote " + std::to_string(package.files.size()) + " files to " + folder.string() +
             ". " + (folder / "README.txt").string() + " tells how Unity reads them.\n");
  }
  return kFinished;
}

}  // namespace predictor
