#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "commands.h"
#include "core/error.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

// An hour's run must not end in a summary that cannot be written. Leaves no file where none was.
void CheckWritable(const std::string& file) {
  if (file.empty() || file == "-") return;
  std::error_code error;
  const bool was_there = std::filesystem::exists(std::filesystem::symlink_status(file, error));
  if (!std::ofstream(file, std::ios::app))
    throw InputError(
        "--summary: '" + file +
        "' cannot be written. Give a path in a folder that exists and may be written.");
  if (!was_there) std::filesystem::remove(file, error);
}

// With a machine its file says all of the device: what is set of the scenario's would be ignored.
void RefuseToSetDevice(const std::string& assignment, const std::string& machine) {
  const std::string path = assignment.substr(0, assignment.find('='));
  if (path != "device" && !path.starts_with("device.")) return;
  throw InputError("--set " + path,
                   "with --machine the arms are those of " + machine +
                       ", and what is set of the scenario's own would mean nothing. Change it in "
                       "that file (under arms.left.arm and arms.right.arm), or leave --set out.");
}

}  // namespace

void WriteOut(const std::string& text) {
  if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
    throw std::runtime_error(std::string("standard output cannot be written: ") +
                             std::strerror(errno));
}

void TellProblem(const std::string& problem) {
  if (!problem.empty()) std::fprintf(stderr, "%s\n", problem.c_str());
}

Scenario ScenarioOptions::Load(const Machine* on) const {
  std::vector<std::string> overrides = set;
  for (const std::string& assignment : on ? set : std::vector<std::string>())
    RefuseToSetDevice(assignment, on->file.string());
  if (on) overrides.emplace_back("device.type=real");
  if (seed) overrides.push_back("seed=" + *seed);
  if (duration) overrides.push_back("duration=" + *duration);
  Scenario scenario = LoadScenario(file, overrides);
  if (on) ApplyMachine(*on, &scenario);
  CheckWritable(summary);
  return scenario;
}

void ScenarioOptions::Write(const std::string& text, const std::string& json) const {
  const bool to_stdout = summary == "-";
  if (!quiet) std::fputs(text.c_str(), to_stdout ? stderr : stdout);
  if (summary.empty()) return;
  if (to_stdout) return WriteOut(json);
  std::ofstream out(summary);
  out << json;
  if (!out.flush())
    throw InputError("--summary: '" + summary +
                     "' could not be written. Give a path in a folder that exists and may be "
                     "written, on a disk with room.");
}

}  // namespace predictor
