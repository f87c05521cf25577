#include "devices/audit.h"

#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scenario/paths.h"

namespace predictor {
namespace {

using Json = nlohmann::json;

// Writes a record that consists of the time [ns], the hand (0 or 1), the size, and the bytes. If
// the hand is 2, the bytes are data about the run, as JSON.
void Put(std::ofstream* out, std::uint64_t time, std::uint32_t hand, const void* bytes,
         std::size_t size) {
  const auto length = static_cast<std::uint32_t>(size);
  out->write(reinterpret_cast<const char*>(&time), sizeof time);
  out->write(reinterpret_cast<const char*>(&hand), sizeof hand);
  out->write(reinterpret_cast<const char*>(&length), sizeof length);
  out->write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
}

template <class Spec>
Json PoseJson(const Spec& pose) {
  return {{"xyz", {pose.xyz.x(), pose.xyz.y(), pose.xyz.z()}},
          {"rpy", {pose.rpy.x(), pose.rpy.y(), pose.rpy.z()}}};
}

Json ArmJson(const Scenario& s, int hand, const char* make, const JointVector& q) {
  const ArmSpec& arm = s.arm(hand);
  return {{"make", make},
          {"urdf", ResolveModelPath(arm.model, s.folder()).string()},
          {"remove_links", arm.remove_links},
          {"end_effector", arm.end_effector},
          {"base", PoseJson(arm.base)},
          {"handle", PoseJson(arm.handle)},
          {"velocity_limit", arm.velocity_limit},
          {"acceleration_limit", arm.acceleration_limit},
          {"loop",
           {{"bandwidth", arm.loop.bandwidth},
            {"damping_ratio", arm.loop.damping_ratio},
            {"delay", arm.loop.delay}}},
          {"q", std::vector<double>(q.data(), q.data() + q.size())}};
}

// Returns the limits on a handle that docs/concepts/states.md states for each stage. Null means
// that no limit applies or that the rules for stops replace the limit.
Json StagesJson(const Scenario& s, const Bench& bench) {
  Json stages = Json::array();
  for (const RunStage& stage : bench.stages()) {
    Json known = {{"time", stage.time},
                  {"state", Name(stage.state)},
                  {"speed", nullptr},
                  {"rotation", nullptr}};
    const auto promise = [&](double speed, double rotation) {
      known["speed"] = speed;
      known["rotation"] = rotation;
    };
    if (stage.state == RunState::kAlign) promise(s.safety.align_speed, 0.3);
    if (stage.state == RunState::kRun)
      promise(s.safety.handle_speed, s.safety.handle_rotation_speed);
    if (stage.state == RunState::kRecovery) promise(0.05, 0.25);
    for (const JointVector& q : stage.q)
      known["q"].push_back(std::vector<double>(q.data(), q.data() + q.size()));
    stages.push_back(known);
  }
  return stages;
}

}  // namespace

void AppendForAudit(const std::string& file, const std::string& name, const FaultRig& rig,
                    const Bench& bench, const BenchStop& stop) {
  const Scenario& s = bench.scenario();
  Json arms = Json::array();
  for (int hand = 0; hand < kHands; ++hand)
    arms.push_back(ArmJson(s, hand, rig.arms[static_cast<std::size_t>(hand)],
                           stop.q[static_cast<std::size_t>(hand)]));
  const std::string known = Json{
      {"name", name},
      {"arms", arms},
      {"stop", stop.decided},
      {"rest", stop.rested},
      {"stages", StagesJson(s, bench)},
      {"handle_speed", s.safety.handle_speed},
      {"stop_acceleration", s.safety.stop_acceleration},
      {"stop_jerk",
       s.safety.stop_jerk}}.dump();
  std::ofstream out(file, std::ios::app | std::ios::binary);
  Put(&out, bench.now(), 2, known.data(), known.size());
  for (const Sent& sent : bench.sent())
    Put(&out, sent.time, static_cast<std::uint32_t>(sent.hand), sent.bytes.data(),
        sent.bytes.size());
}

void AppendForAudit(const std::string& file, const Fault& fault, std::uint64_t seed,
                    const FaultRig& rig, const Bench& bench, const BenchStop& stop) {
  AppendForAudit(file, fault.ToString() + ", seed " + std::to_string(seed), rig, bench, stop);
}

std::string Audit(const std::string& file) {
  const std::string command =
      "python3 " PREDICTOR_SOURCE_DIR "/tests/devices/audit/audit_commands.py " + file + " 2>&1";
  FILE* script = popen(command.c_str(), "r");
  if (script == nullptr) return "the script cannot be run";
  std::string said;
  std::array<char, 512> bytes{};
  while (std::fgets(bytes.data(), bytes.size(), script) != nullptr) said += bytes.data();
  const int status = pclose(script);
  return status == 0 ? "" : said + "(status " + std::to_string(status) + ")";
}

}  // namespace predictor
