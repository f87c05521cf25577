#include "recording/recover.h"

#include <filesystem>
#include <string>

#include "commands.h"

namespace predictor {

int RecoverCommand(const std::string& recording, const std::string& output) {
  std::string out = output;
  if (out.empty()) {
    std::filesystem::path path = recording;
    out = path.replace_extension("recovered.mcap").string();
  }
  const RecoverReport report = Recover(recording, out);
  WriteOut(report.Text() + "\nWritten: " + out + "\n");
  return kFinished;
}

}  // namespace predictor
