#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "commands.h"
#include "core/error.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

// An hour's run must not end in a summary that cannot be written.
void CheckWritable(const std::string& file) {
  if (file.empty() || file == "-") return;
  if (!std::ofstream(file, std::ios::app))
    throw InputError(
        "--summary: '" + file +
        "' cannot be written. Give a path in a folder that exists and may be written.");
}

}  // namespace

void WriteOut(const std::string& text) {
  if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
    throw std::runtime_error(std::string("standard output cannot be written: ") +
                             std::strerror(errno));
}

Scenario ScenarioOptions::Load() const {
  std::vector<std::string> overrides = set;
  if (seed) overrides.push_back("seed=" + std::to_string(*seed));
  if (duration) overrides.push_back("duration=" + std::to_string(*duration));
  CheckWritable(summary);
  return LoadScenario(file, overrides);
}

}  // namespace predictor
