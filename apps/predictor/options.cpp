#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "commands.h"
#include "core/error.h"
#include "core/text.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"
#include "screen.h"

namespace predictor {
namespace {

// With --machine, only the machine file describes the device, so --set would have no effect.
void RefuseToSetDevice(const std::string& assignment, const std::string& machine) {
  const std::string path = assignment.substr(0, assignment.find('='));
  if (path != "device" && !path.starts_with("device.")) return;
  throw InputError("--set " + path,
                   "with --machine, the arms are described by " + machine +
                       ", so --set has no effect on them. Change the value in that file (under "
                       "arms.left.arm and arms.right.arm), or omit --set.");
}

// Returns the scenario's error about an option, with the option's name as the user typed it.
InputError NamedAsTyped(std::string text, const std::string& key) {
  const std::string name = "--set " + key;
  if (const std::size_t at = text.find(name); at != std::string::npos)
    text.replace(at, name.size(), "--" + key);
  return InputError(text);
}

void WriteRaw(const std::string& text) {
  if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
    throw std::runtime_error(std::string("standard output cannot be written: ") +
                             std::strerror(errno));
}

}  // namespace

void WriteOut(const std::string& text) { WriteRaw(Printable(text, Lines::kMany)); }

void ShowProblem(const std::string& problem) {
  if (!problem.empty()) TheScreen().Print(problem);
}

Scenario ScenarioOptions::Load(const Machine* on) const {
  std::vector<std::string> overrides = set;
  for (const std::string& assignment : on ? set : std::vector<std::string>())
    RefuseToSetDevice(assignment, on->file.string());
  if (on) overrides.emplace_back("device.type=real");
  if (seed) overrides.push_back("seed=" + *seed);
  if (duration) overrides.push_back("duration=" + *duration);
  CheckWritable();
  try {
    Scenario scenario = LoadScenario(FindShipped(file), overrides);
    if (on) ApplyMachine(*on, &scenario);
    return scenario;
  } catch (const InputError& error) {
    if (seed && std::string(error.what()).find("--set seed") != std::string::npos)
      throw NamedAsTyped(error.what(), "seed");
    if (duration && std::string(error.what()).find("--set duration") != std::string::npos)
      throw NamedAsTyped(error.what(), "duration");
    throw;
  }
}

void OutputOptions::RefuseToReplace(const std::string& target) const {
  std::error_code error;
  if (force || target.empty() || target == "-" || !std::filesystem::is_regular_file(target, error))
    return;
  throw InputError(Quote(target) +
                   " exists. Give another name, or use --force to replace the file.");
}

void OutputOptions::MakeRoom(const std::string& target) const {
  RefuseToReplace(target);
  std::error_code error;
  if (std::filesystem::is_regular_file(target, error)) std::filesystem::remove(target, error);
}

// Checks at the start, so that a long run does not end with a result that cannot be written.
// The check does not create a file that did not exist.
void OutputOptions::CheckWritable() const {
  if (json.empty() || json == "-") return;
  RefuseToReplace(json);
  std::error_code error;
  const bool existed = std::filesystem::exists(std::filesystem::symlink_status(json, error));
  if (!std::ofstream(json, std::ios::app))
    throw InputError("--json: " + Quote(json) +
                     " cannot be written. Give a path in an existing, writable folder.");
  if (!existed) std::filesystem::remove(json, error);
}

void OutputOptions::Print(const std::string& text) const {
  if (!quiet) std::fputs(Printable(text, Lines::kMany).c_str(), json == "-" ? stderr : stdout);
}

void OutputOptions::Write(const std::string& text, const std::string& result) const {
  Print(text);
  WriteJson(result);
}

void OutputOptions::WriteJson(const std::string& result) const {
  if (json.empty()) return;
  // Control characters must not reach a terminal. In JSON, control characters are replaced by
  // escape sequences.
  if (json == "-")
    return WriteRaw(isatty(STDOUT_FILENO) == 1 ? Printable(result, Lines::kMany) : result);
  std::ofstream out(json);
  out << result;
  if (!out.flush())
    throw InputError(
        "--json: " + Quote(json) +
        " could not be written. Give a path in a writable folder on a disk with free space.");
}

}  // namespace predictor
