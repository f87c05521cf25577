#include "recorded_run.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "core/error.h"
#include "core/text.h"
#include "recording/provenance.h"
#include "recording/scene.h"
#include "report.h"
#include "screen.h"

namespace predictor {
namespace {

constexpr double kSnapshotTime = 10;  // between saved states [s]

}  // namespace

std::map<std::string, std::string> RecordOptions::Labels() const {
  std::map<std::string, std::string> result;
  for (const std::string& label : labels) {
    const std::size_t equals = label.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InputError("--label: " + Quote(label) + " is not a label. Write key=value.");
    result[label.substr(0, equals)] = label.substr(equals + 1);
  }
  return result;
}

RecordingHeader HeaderOf(const Emulator& emulator, const RecordOptions& options) {
  RecordingHeader header = DescribeRun(emulator.scenario(), PREDICTOR_VERSION, options.Labels());
  header.machine_yaml = options.machine;
  header.loop = PredictedLoopOf(emulator);
  return header;
}

std::string NewRecordingName(const Scenario& scenario) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char time[32];
  std::strftime(time, sizeof time, "%Y-%m-%d_%H-%M-%S", &local);
  std::error_code error;
  std::filesystem::create_directories("runs", error);
  if (error)
    throw InputError("runs", "The folder for recordings could not be created: " + error.message() +
                                 ". Run the program in a writable folder, give a file with "
                                 "--record, or use --no-record.");
  const std::string stem = "runs/" + scenario.file.stem().string() + "_" + time;
  std::string name = stem + ".mcap";
  for (int k = 2; std::filesystem::exists(name); ++k)
    name = stem + "_" + std::to_string(k) + ".mcap";
  return name;
}

VirtualRecording::VirtualRecording(Emulator* emulator, const RecordOptions& options)
    : emulator_(emulator),
      file_(options.file),
      writer_(file_, HeaderOf(*emulator, options),
              RecordedScene(emulator->scenario(), emulator->setup().object_start), nullptr,
              {.tell = [](const std::string& text) { TheScreen().Tell(text); }}),
      snapshot_ticks_(static_cast<std::uint64_t>(std::lround(kSnapshotTime / emulator->dt()))),
      state_(kStateBytes) {}

void VirtualRecording::Add(const TickRecord& record) {
  writer_.Add(record);
  if (record.tick % snapshot_ticks_ != 0) return;
  const std::size_t size = emulator_->SaveState(state_);
  writer_.AddSnapshot(record.tick, std::span(state_).first(size));
}

std::string VirtualRecording::Told() const {
  char text[96];
  std::snprintf(text, sizeof text, ": %llu ticks, %.1f MB.",
                static_cast<unsigned long long>(writer_.ticks()),
                1e-6 * static_cast<double>(writer_.bytes()));
  return "Recorded " + file_ + text;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "predictor-XXXXXX").string();
  if (!mkdtemp(name.data()))
    throw std::runtime_error("a temporary folder could not be created in " +
                             std::filesystem::temp_directory_path().string());
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace predictor
