#include "analysis/identify/identify.h"

#include <filesystem>
#include <optional>

#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "recorded_run.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "restored_scenario.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// Returns the scenario into which the friction is written. The paths in the scenario are unchanged.
Scenario CopyOf(const IdentifyCommandOptions& options, const RecordingHeader& header) {
  if (!options.scenario.empty()) return LoadScenario(FindShipped(options.scenario));
  return RecordedScenario(header, options.recording, FolderOf(options.output));
}

std::string HeadingOf(const Identification& result, const std::string& recording) {
  std::string text;
  AppendLine(&text, "# Joint friction identified from %s;", fs::path(recording).filename().c_str());
  AppendLine(
      &text,
      "# half-width of the 95 %% interval of viscous [N·m·s/rad] and Coulomb friction [N·m]:");
  for (const JointIdentification& j : result.joints) {
    if (j.identified())
      AppendLine(&text, "#   %s: %.3f, %.3f", j.name.c_str(), j.viscous.half_width,
                 j.coulomb.half_width);
    else
      AppendLine(&text, "#   %s: not identified, old values kept", j.name.c_str());
  }
  return text;
}

// Model paths are relative to the scenario's own folder.
void CheckModels(const Scenario& scenario, const fs::path& output) {
  try {
    ResolveModelPath(scenario.cobot.model, FolderOf(output));
    if (!scenario.object.model.empty()) ResolveModelPath(scenario.object.model, FolderOf(output));
  } catch (const InputError& error) {
    throw InputError(
        "--output", std::string("The scenario's models cannot be found from the output folder: ") +
                        error.what() + " Write the file into the folder of the recorded scenario.");
  }
}

void WriteScenario(const IdentifyCommandOptions& options, const RecordingHeader& header,
                   const Identification& result) {
  const Scenario scenario = WithFriction(CopyOf(options, header), result);
  CheckModels(scenario, options.output);
  WriteWholeFile(options.output, HeadingOf(result, options.recording) + SaveScenario(scenario));
}

Identification IdentifyRecording(const IdentifyCommandOptions& options, RecordingReader* reader) {
  std::optional<RestoredScenario> restored;  // the identification reads the recorded models
  Scenario nominal = options.scenario.empty() ? restored.emplace(reader->header()).Get()
                                              : LoadScenario(FindShipped(options.scenario));
  nominal.rate = 1 / reader->header().dt;
  IdentifyOptions how;
  how.mass_uncertainty = options.mass_uncertainty;
  how.com_uncertainty = options.com_uncertainty;
  Identifier identifier(nominal, how);
  ReadTicks(reader, "Reading", options.quiet,
            [&](const TickRecord& record) { identifier.Add(record); });
  return identifier.Finish();
}

}  // namespace

int IdentifyCommand(const IdentifyCommandOptions& options) {
  options.RefuseToReplace(options.output);
  options.CheckWritable();
  RecordingReader reader(options.recording);
  ShowProblem(reader.problem());
  const Identification result = IdentifyRecording(options, &reader);
  options.Write(IdentificationText(result), IdentificationJson(result));
  if (!options.output.empty()) WriteScenario(options, reader.header(), result);
  return result.complete() ? kFinished : kUnfit;
}

}  // namespace predictor
