// Measures the CPU time per tick and the bytes per minute that a recording needs.
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "recording/scene.h"
#include "recording/writer.h"
#include "samples.h"
#include "sections.h"

namespace predictor::bench {
namespace {

struct Cost {
  double us = 0;     // CPU time per tick
  double bytes = 0;  // per minute
};

Cost Measure(const Recording& run, const std::vector<JsonChannel>& scene) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("bench-" + std::to_string(::getpid()) + ".mcap");
  RecordingHeader header;
  header.dt = run.dt;
  header.start_unix_ns = 1'700'000'000'000'000'000;
  RecordingWriter writer(path.string(), header, scene);
  const double empty = static_cast<double>(writer.bytes());
  const double start = CpuSeconds();
  for (const TickRecord& record : run.ticks) writer.Add(record);
  writer.Close();
  const double seconds = CpuSeconds() - start;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  std::filesystem::remove(path);
  const auto ticks = static_cast<double>(run.ticks.size());
  return {1e6 * seconds / ticks, (bytes - empty) / (ticks * run.dt) * 60};
}

}  // namespace

void CompareRecordings(const std::vector<std::string>& names) {
  Heading("Recordings (time of one core for encoding, compressing and writing; size)");
  std::printf("%-28s %12s %14s %18s\n", "run", "us per tick", "MB per minute", "without scene");
  for (const std::string& name : names) {
    const Recording run = Record(name);
    const Cost whole = Measure(run, RecordedScene(run.scenario, Vector3(0.5, 0, 0.3)));
    const Cost bare = Measure(run, {});
    std::printf("%-28s %12.2f %14.1f %8.2f, %5.1f MB\n", name.c_str(), whole.us, whole.bytes / 1e6,
                bare.us, bare.bytes / 1e6);
  }
}

}  // namespace predictor::bench
