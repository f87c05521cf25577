#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.h"
#include "core/error.h"
#include "recording/recover.h"

namespace predictor {
namespace {

std::string JsonOf(const RecoverReport& report, const std::string& file) {
  const nlohmann::json result = {{"file", file},
                                 {"was_complete", report.was_complete},
                                 {"ticks", report.ticks},
                                 {"chunks", report.chunks},
                                 {"damaged_chunks", report.damaged_chunks},
                                 {"salvaged_ticks", report.salvaged_ticks},
                                 {"lost_ticks", report.lost_ticks},
                                 {"snapshots", report.snapshots},
                                 {"events", report.events},
                                 {"gave_up_at", report.gave_up_at},
                                 {"preamble", report.preamble}};
  return result.dump(2) + "\n";
}

}  // namespace

int RepairCommand(const RecordingOptions& options) {
  std::filesystem::path out = options.output;
  if (out.empty())
    out = std::filesystem::path(options.recording).replace_extension("repaired.mcap");
  options.CheckWritable();
  std::error_code error;
  if (std::filesystem::equivalent(out, options.recording, error))
    throw InputError(out.string(), "Write the repaired recording to a different file.");
  options.MakeRoom(out.string());
  const RecoverReport report = Recover(options.recording, out.string());
  options.Write(report.Text() + "\nWrote " + out.string() + ".\n", JsonOf(report, out.string()));
  return kFinished;
}

}  // namespace predictor
