// Records to write. Some records have random bits, and some resemble those of a run.
#pragma once

#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "core/record.h"
#include "recording/header.h"
#include "recording/reader.h"
#include "support/temporary_folder.h"

namespace predictor::recording_test {

// A temporary folder that is deleted with the test. The folder is in memory if the test permits
// this and a folder in memory exists.
class Folder {
 public:
  explicit Folder(bool in_memory = false) : folder_(Where(in_memory)) {}
  std::string File(const std::string& name) const { return (folder_ / name).string(); }
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  static std::filesystem::path Where(bool in_memory) {
    const std::filesystem::path memory = "/dev/shm";
    const bool there = in_memory && ::access(memory.c_str(), W_OK) == 0;
    return there ? memory : std::filesystem::temp_directory_path();
  }

  const test::TemporaryFolder folder_;
};

inline std::string ReadFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline void WriteFile(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline RecordingHeader SampleHeader() {
  RecordingHeader header;
  header.scenario_yaml = "predictor: 1\nname: Box\n";
  header.scenario_name = "Box";
  header.machine_yaml = "device: here\n";
  header.program_version = "0.1.0";
  header.engine = "MuJoCo 4.0.0";
  header.seed = 18446744073709551615U;
  header.dt = 0.001;
  header.loop = PredictedLoop{0.0181, 0.84};
  header.labels = {{"person", "P07"}, {"condition", "emulated"}};
  header.model_hashes = {{"package://a/b.urdf", "abc123"}};
  header.attachments = {{"robot.urdf", "application/xml", std::string("<robot/>\0x", 10)}};
  header.start_unix_ns = 1'700'000'000'000'000'000;
  return header;
}

// Returns a record of zeros, including the padding, with the inputs at their initial values.
inline TickRecord Nothing() {
  TickRecord record;
  std::memset(static_cast<void*>(&record), 0, sizeof record);
  record.inputs.fill(RunInput{});
  return record;
}

// Returns a tick that resembles those of a run and depends only on its number.
inline TickRecord SampleTick(std::uint64_t tick) {
  TickRecord r = Nothing();
  std::mt19937_64 random(tick);
  const auto noise = [&random] { return 1e-3 * static_cast<double>(random() % 1000); };
  const double t = static_cast<double>(tick) * 1e-3;
  r.tick = tick;
  r.run_time = t;
  r.state = RunState::kRun;
  r.cause_hand = -1;
  r.action = -1;
  r.ran = r.rendered = 1;
  r.hands_gripping = 2;
  r.parameters = {1, 1, 1, 30, 5};
  for (HandRecord& h : r.hands) {
    h.present = h.gripping = 1;
    h.arm_dof = 6;
    h.real.pose = {{std::sin(t), 0.1, 0.5}, {1, 0, 0, 0}};
    h.virtual_.pose = {{std::sin(t) + 1e-4, 0.1, 0.5}, {1, 0, 0, 0}};
    for (std::size_t k = 0; k < 6; ++k) {
      h.wrench_raw[k] = noise();
      h.wrench[k] = noise();
      h.q[k] = std::sin(t + static_cast<double>(k));
      h.v[k] = std::cos(t + static_cast<double>(k));
      h.command[k] = h.v[k];
    }
    h.arm_sequence = h.sensor_sequence = tick;
  }
  r.cobot_dof = 7;
  for (std::size_t k = 0; k < 7; ++k) {
    r.cobot_q[k] = std::sin(0.3 * t + static_cast<double>(k));
    r.cobot_torque[k] = noise();
  }
  r.object.pose.q = r.end_effector.pose.q = {1, 0, 0, 0};
  r.link_distance = HUGE_VAL;
  r.energy = noise();
  for (float& us : r.stage_us) us = static_cast<float>(noise());
  return r;
}

inline bool Same(const TickRecord& a, const TickRecord& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace predictor::recording_test
