// Writes a recording and a JSON file with the values that other readers must find in it. The
// program makes the JSON directly from the records, without the encoder's function that visits the
// fields. Usage: FOLDER [TICKS].
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "recording/samples.h"
#include "recording/scene.h"
#include "recording/writer.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;
using namespace recording_test;

constexpr std::uint64_t kTicks = 1300;

// Returns a number, or its name if it is not finite, because JSON cannot represent it.
Json Number(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  return x;
}
Json Numbers(const double* x, std::size_t n) {
  Json list = Json::array();
  for (std::size_t k = 0; k < n; ++k) list.push_back(Number(x[k]));
  return list;
}
Json Vector(const double* x) {
  return {{"x", Number(x[0])}, {"y", Number(x[1])}, {"z", Number(x[2])}};
}
Json PoseJson(const PoseRecord& pose) {
  return {
      {"position", Vector(pose.p.data())},
      {"orientation", {{"x", pose.q[1]}, {"y", pose.q[2]}, {"z", pose.q[3]}, {"w", pose.q[0]}}}};
}
Json TwistJson(const std::array<double, 6>& v) {
  return {{"linear", Vector(v.data())}, {"angular", Vector(v.data() + 3)}};
}
Json WrenchJson(const std::array<double, 6>& f) {
  return {{"force", Vector(f.data())}, {"torque", Vector(f.data() + 3)}};
}
Json MotionJson(const MotionRecord& m) {
  return {{"pose", PoseJson(m.pose)}, {"twist", TwistJson(m.twist)}};
}
Json StatusJson(const StatusRecord& s) {
  return {{"cause", static_cast<int>(s.cause)},
          {"hand", s.hand},
          {"quantity", static_cast<int>(s.quantity)},
          {"power_off", s.power_off},
          {"value", Number(s.value)},
          {"limit", Number(s.limit)}};
}

Json HandJson(const HandRecord& h) {
  return {{"present", h.present},
          {"gripping", h.gripping},
          {"arm_dof", h.arm_dof},
          {"sensor_saturated", h.sensor_saturated},
          {"arm_fault", h.arm_fault},
          {"warnings", h.warnings},
          {"at_lower", h.at_lower},
          {"at_upper", h.at_upper},
          {"arm_in_motion", h.arm_in_motion},
          {"arm_waits", h.arm_waits},
          {"real", MotionJson(h.real)},
          {"virtual_handle", MotionJson(h.virtual_)},
          {"wrench_raw", WrenchJson(h.wrench_raw)},
          {"wrench", WrenchJson(h.wrench)},
          {"coupling", WrenchJson(h.coupling)},
          {"true_wrench", WrenchJson(h.true_wrench)},
          {"q", Numbers(h.q.data(), h.arm_dof)},
          {"v", Numbers(h.v.data(), h.arm_dof)},
          {"command", Numbers(h.command.data(), h.arm_dof)},
          {"arm_age", Number(h.arm_age)},
          {"sensor_age", Number(h.sensor_age)},
          {"arm_sequence", std::to_string(h.arm_sequence)},
          {"sensor_sequence", std::to_string(h.sensor_sequence)},
          {"manipulability", Number(h.manipulability)},
          {"warning_values", Numbers(h.warning_values.data(), kWarningValues)}};
}

Json RunJson(const TickRecord& r) {
  return {{"tick", std::to_string(r.tick)},
          {"run_time", Number(r.run_time)},
          {"wall_ns", std::to_string(r.wall_ns)},
          {"state", static_cast<int>(r.state)},
          {"cause", static_cast<int>(r.cause)},
          {"cause_hand", r.cause_hand},
          {"hands_gripping", r.hands_gripping},
          {"action", r.action},
          {"cause_value", Number(r.cause_value)},
          {"cause_limit", Number(r.cause_limit)},
          {"cause_quantity", static_cast<int>(r.cause_quantity)},
          {"ran", r.ran},
          {"rendered", r.rendered},
          {"refused", r.refused},
          {"why_refused", r.why_refused},
          {"controller", r.controller},
          {"cobot_stop", r.cobot_stop},
          {"attachment", r.attachment},
          {"events", r.events},
          {"latest_event", r.latest_event},
          {"requests", r.requests},
          {"qp_rows", r.qp_rows},
          {"missed", r.missed},
          {"read", StatusJson(r.read)},
          {"written", StatusJson(r.written)},
          {"harder", StatusJson(r.harder)},
          {"parameters", Numbers(r.parameters.data(), kParameters)},
          {"perturbation", Numbers(r.perturbation.data(), 3)}};
}

Json InputsJson(const TickRecord& r) {
  Json list = Json::array();
  for (std::size_t k = 0; k < r.input_count; ++k) {
    const RunInput& i = r.inputs[k];
    list.push_back({{"kind", static_cast<int>(i.kind)},
                    {"parameter", static_cast<int>(i.parameter)},
                    {"hand", i.hand},
                    {"grip", i.grip},
                    {"client", i.client},
                    {"value", Number(i.value)},
                    {"p", Numbers(i.p.data(), 3)},
                    {"q", Numbers(i.q.data(), 4)}});
  }
  return {{"input_count", r.input_count}, {"inputs", list}};
}

Json TickJson(const TickRecord& r) {
  Json timing;
  for (std::size_t s = 0; s < kStages; ++s) timing[kStageNames[s]] = r.stage_us[s];
  Json json = {{"/run", RunJson(r)},
               {"/hands/left", HandJson(r.hands[0])},
               {"/cobot",
                {{"dof", r.cobot_dof},
                 {"q", Numbers(r.cobot_q.data(), r.cobot_dof)},
                 {"v", Numbers(r.cobot_v.data(), r.cobot_dof)},
                 {"torque", Numbers(r.cobot_torque.data(), r.cobot_dof)},
                 {"end_effector", MotionJson(r.end_effector)}}},
               {"/object", {{"object", MotionJson(r.object)}, {"energy", Number(r.energy)}}},
               {"/qp",
                {{"relaxed", r.qp_relaxed},
                 {"failed", r.qp_failed},
                 {"guard_altered", r.guard_altered},
                 {"iterations", r.qp_iterations},
                 {"relative_slack", TwistJson(r.relative_slack)},
                 {"limit_slack", Number(r.limit_slack)},
                 {"link_distance", Number(r.link_distance)},
                 {"kkt_residual", Number(r.kkt_residual)}}},
               {"/timing", timing}};
  if (r.hands[1].present) json["/hands/right"] = HandJson(r.hands[1]);
  if (r.input_count > 0) json["/inputs"] = InputsJson(r);
  return json;
}

TickRecord Special(std::uint64_t tick) {
  TickRecord r = SampleTick(tick);
  if (tick % 100 == 0) r.energy = std::numeric_limits<double>::quiet_NaN();
  if (tick % 100 == 1) r.hands[1] = {};  // this tick has one hand only
  if (tick % 100 == 2) {
    r.cause = r.read.cause = StopCause::kTracking;
    r.cause_quantity = Quantity::kLength;
    r.cause_value = 0.03;
    r.cause_limit = 0.02;
    r.cause_hand = 1;
    r.harder = {StopCause::kStale, 0, Quantity::kArmAge, 1, {}, 0.021, 0.02};
    r.requests = kEndRequest;
    r.missed = 4'000'000'000;
  }
  if (tick % 100 == 3) {
    r.input_count = 2;
    r.inputs[0].kind = InputKind::kParameter;
    r.inputs[0].value = -1.5;
    r.inputs[1].kind = InputKind::kHand;
    r.inputs[1].p = {1, 2, 3};
    r.inputs[1].client = 4'000'000'000;
  }
  if (tick % 100 == 4) r.cobot_dof = r.hands[0].arm_dof = 0;
  if (r.cobot_dof == 0) {
    r.cobot_q = r.cobot_v = r.cobot_torque = {};
    r.hands[0].q = r.hands[0].v = r.hands[0].command = {};
  }
  return r;
}

int Main(const std::string& folder, std::uint64_t ticks) {
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
  RecordingWriter writer(folder + "/sample.mcap", SampleHeader(),
                         RecordedScene(scenario, {0.5, 0, 0.3}));
  std::ofstream expected(folder + "/expected.jsonl");
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    writer.Add(Special(tick));
    expected << TickJson(Special(tick)).dump() << '\n';
    if (tick == 500) writer.AddSnapshot(tick, std::vector<std::byte>(1000, std::byte{7}));
    if (tick == 600) writer.AddEvent("marker", tick);
    if (tick == 700) writer.NoteLoss(3, tick);
  }
  writer.Close();
  RecordingReader(folder + "/sample.mcap").Check();
  return 0;
}

}  // namespace
}  // namespace predictor

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) return 2;
  try {
    return predictor::Main(argv[1], argc == 3 ? std::stoull(argv[2]) : predictor::kTicks);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
