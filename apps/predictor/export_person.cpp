#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "assessment/opensim_files.h"
#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "evaluated_run.h"

namespace predictor {

int ExportPersonCommand(const ExportPersonOptions& options) {
  namespace fs = std::filesystem;
  const fs::path folder =
      options.folder.empty()
          ? fs::path(options.recording).replace_extension("").string() + ".opensim"
          : options.folder;
  options.CheckWritable();
  const EvaluatedRun run = OpenRun(options.recording, options, options.tracks);
  auto samples = assessment::Held(run.run.samples);
  if (samples.empty())
    throw InputError(options.recording, "No hand held a handle, so there is nothing to export.");
  const assessment::PersonSetup setup = assessment::SetupOf(run.scenario, run.run.handles);
  assessment::AddTracks(run.tracks, setup, run.start_unix, &samples);
  const auto files = assessment::OpenSimFiles(setup, samples);
  for (const assessment::NamedFile& file : files) options.RefuseToReplace(folder / file.name);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "The folder cannot be created: " + error.message());
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const assessment::NamedFile& file : files) {
    WriteWholeFile(folder / file.name, file.text);
    names.push_back(file.name);
  }
  const nlohmann::ordered_json result = {{"folder", folder.string()}, {"files", names}};
  options.Write("Wrote the body, its motion and the forces of the hands to " + folder.string() +
                    ". To compute the inverse dynamics, run there: opensim-cmd run-tool "
                    "inverse_dynamics.xml\n",
                result.dump(2) + "\n");
  return kFinished;
}

}  // namespace predictor
