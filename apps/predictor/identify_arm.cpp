#include "analysis/identify_arm/identify_arm.h"

#include <filesystem>

#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "recorded_run.h"
#include "recording/reader.h"
#include "restored_scenario.h"

namespace predictor {
namespace {

void AddRecordingOf(const std::string& file, bool quiet, ArmIdentifier* identifier) {
  RecordingReader reader(file);
  ShowProblem(reader.problem());
  try {
    identifier->Begin(RestoredScenario(reader.header()).Get(), reader.header().dt);
  } catch (const InputError& error) {
    throw InputError(file, error.what());
  }
  ReadTicks(&reader, "Reading", quiet, [&](const TickRecord& record) { identifier->Add(record); });
}

void WriteArm(const ArmIdentification& result, int hand, const std::string& source,
              const std::string& file) {
  if (file.empty()) return;
  if (!result.hands[static_cast<std::size_t>(hand)].identified())
    throw InputError(file, std::string("Not written, because the ") + HandName(hand) +
                               " arm was not identified.");
  WriteWholeFile(file, ArmFile(result, hand, source));
}

}  // namespace

int IdentifyArmCommand(const IdentifyArmOptions& options) {
  options.RefuseToReplace(options.left);
  options.RefuseToReplace(options.right);
  options.CheckWritable();
  ArmIdentifier identifier;
  std::vector<std::string> names;
  for (const std::string& file : options.recordings) {
    AddRecordingOf(file, options.quiet, &identifier);
    names.push_back(std::filesystem::path(file).filename().string());
  }
  const ArmIdentification result = identifier.Finish();
  const std::string source = Join(names);
  options.Write(ArmText(result, source), ArmJson(result, source));
  WriteArm(result, 0, source, options.left);
  WriteArm(result, 1, source, options.right);
  return result.complete() ? kFinished : kUnfit;
}

}  // namespace predictor
