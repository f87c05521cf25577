#include "recording/share.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "core/error.h"
#include "core/text.h"

namespace predictor {

int ShareCommand(const RecordingOptions& options) {
  namespace fs = std::filesystem;
  const fs::path out = options.output.empty()
                           ? fs::path(options.recording).replace_extension("shared.mcap")
                           : fs::path(options.output);
  options.CheckWritable();
  std::error_code error;
  if (fs::equivalent(out, options.recording, error))
    throw InputError(out.string(), "Write the copy to a different file.");
  options.MakeRoom(out.string());
  const std::vector<std::string> removed = WriteShared(options.recording, out.string());
  const nlohmann::ordered_json result = {{"file", out.string()}, {"removed", removed}};
  options.Write("Wrote " + out.string() + " without the person. Removed: " +
                    (removed.empty() ? "nothing, because the recording has no such data"
                                     : Printable(Join(removed))) +
                    ".\n",
                result.dump(2) + "\n");
  return kFinished;
}

}  // namespace predictor
