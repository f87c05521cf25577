// What a report tells of one run, gathered in one pass over its records.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/histogram.h"
#include "core/record.h"
#include "evaluation/summary.h"
#include "report/oscillation_index.h"
#include "report/trace.h"
#include "scenario/scenario.h"

namespace predictor {

// What is known of a recording beside its ticks.
struct RunInfo {
  std::string name;           // of the file, or what else tells it from others
  std::string file;           // in full, where the name is a short one
  Scenario scenario;          // resolved
  std::string scenario_yaml;  // resolved
  std::string program_version;
  std::map<std::string, std::string> labels;
  std::string date;     // when it began, in words; empty: not known
  std::string problem;  // of the file, in words: that it was cut
  struct Event {
    std::uint64_t tick = 0;
    std::string text;
  };
  std::vector<Event> events;  // markers
};

// Channels of a hand, in the trace.
enum class HandChannel : std::size_t {
  kError,          // real from virtual handle [mm]; only while simulated time passes, as below
  kErrorRotation,  // [deg]
  kForceX,         // of the hand, axes of W [N]
  kForceY,
  kForceZ,
  kForce,           // [N]
  kTorque,          // [N·m]
  kSpeed,           // of the real handle [mm/s]
  kCouplingForce,   // [N]
  kCouplingTorque,  // [N·m]
  kEnergy,          // that the hand has put in at the real handle [J]
  kEnergyVirtual,   // the same at the virtual handle's motion [J]
  kEnergyCoupling,  // that the coupling has put into the virtual world [J]
  kJoint,           // of the arm, kMaxArmJoints of them [deg]
};
inline constexpr std::size_t kHandChannels =
    static_cast<std::size_t>(HandChannel::kJoint) + kMaxArmJoints;

enum class RunChannel : std::size_t {
  kDistance,       // error of the handles' distance from each other [mm]
  kAngle,          // of their relative rotation [deg]
  kElbow,          // distance of the nearest link pair [m]
  kElbowSlack,     // [mm/s]
  kSlack,          // by which the relative twist was relaxed: linear [mm/s]
  kSlackRotation,  // [deg/s]
  kStored,         // energy of the virtual world since the start [J]
  kTick,           // computing time of a tick [µs]
  kGuidance,       // distance of the object from the guidance [mm]
  kObjectX,        // from its start, in W [mm]
  kObjectY,
  kObjectZ,
  kCobotJoint,  // kMaxCobotJoints of them [deg]
};
inline constexpr std::size_t kRunChannels =
    static_cast<std::size_t>(RunChannel::kCobotJoint) + kMaxCobotJoints;
inline constexpr std::size_t kChannels = kHands * kHandChannels + kRunChannels;

constexpr std::size_t ChannelOf(int hand, HandChannel channel, int joint = 0) {
  return static_cast<std::size_t>(hand) * kHandChannels + static_cast<std::size_t>(channel) +
         static_cast<std::size_t>(joint);
}
constexpr std::size_t ChannelOf(RunChannel channel, int joint = 0) {
  return kHands * kHandChannels + static_cast<std::size_t>(channel) +
         static_cast<std::size_t>(joint);
}

// A stop and what it took.
struct ReportedStop {
  std::uint64_t tick = 0;       // of the decision
  StopSummary summary;          // time: of the report's axis
  std::uint64_t power_off = 0;  // tick that told summary.harder; 0: none did
};

struct ReportedEvent {
  std::uint64_t tick = 0;
  std::string text;
  bool marker = false;  // of a person; else of the run
};

// Part of the run that is not RUN.
struct ReportedPart {
  std::uint64_t from = 0, to = 0;  // ticks
  RunState state = RunState::kInit;
};

// Energy through a port, in one direction and the other.
struct PortEnergy {
  double sum = 0;          // [J]
  double lowest = 0;       // of the sum so far [J]
  double returned = 0;     // what came back out of the device, as a positive number [J]
  double peak_return = 0;  // its largest power [W]
  int episodes = 0;        // in which the sum was below kEpisode
  bool below = false;
  static constexpr double kEpisode = -0.05;  // [J]
  void Add(double power, double dt);
};

// Of one page: from a tick's start to its reception and to the screen [ms].
struct PageLatency {
  Histogram received, rendered;
};

struct RunData {
  RunInfo info;
  double dt = 0.001;         // of a tick [s]
  std::uint64_t first = 0;   // tick
  std::uint64_t last = 0;    // "
  std::uint64_t origin = 0;  // tick at which the report's time is 0: the first of RUN
  std::uint64_t records = 0;
  std::uint64_t lost = 0, gaps = 0;  // ticks that are missing, in so many places
  std::uint64_t disordered = 0;  // records left out: their tick was not later than the one before
  bool real_time = false;        // ticks have a time on the clock
  Summary summary;
  Trace trace{kChannels, 0.001, 120};
  std::array<int, kHands> arm_dof = {};
  int cobot_dof = 0;
  std::array<double, 3> object_start = {};        // in W [m]
  std::vector<float> path_times;                  // every 50 ms of RUN [s]
  std::array<std::vector<float>, 3> object_path;  // in W [m]
  std::array<std::array<std::vector<float>, 3>, kHands> handle_paths;
  std::vector<ReportedStop> stops;
  std::vector<ReportedEvent> events;  // in their order
  std::uint64_t more_events = 0;      // that were not kept
  std::vector<ReportedPart> parts;
  std::array<double, kParameters> parameters = {};  // at the end
  bool has_parameters = false;

  Histogram jitter, sensor_age, arm_age;       // [µs]
  std::vector<std::uint64_t> tick_counts;      // computing time: kTickBins of a decade, from 1 µs
  std::uint64_t late = 0, most_late = 0;       // ticks after a missed deadline; missed in a row
  std::map<std::uint32_t, PageLatency> pages;  // by the viewer's number
  std::array<PortEnergy, kHands> hand_port, virtual_port, coupling_port;
  PortEnergy all_hands;
  double dissipated = 0;  // by the virtual world: what was put in less what it stores [J]
  double stored = 0;      // change of the virtual world's energy [J]
  std::vector<OscillationIndex> oscillation;  // a hand each
  Statistics qp_iterations;
  // Ticks in which a joint's bound, any joint's bound, or a row of the limits was active.
  std::array<std::array<std::uint64_t, kMaxArmJoints>, kHands> bound_ticks = {};
  std::uint64_t bounded_ticks = 0, row_ticks = 0;
  double slack_max = 0, slack_rotation_max = 0, elbow_slack_max = 0;  // [m/s], [rad/s], [m/s]
  double kkt_max = 0;
  Statistics guidance;  // distance of the object from it [m]

  static constexpr int kTickBins = 20;
  // [s] on the report's axis.
  double TimeOf(std::uint64_t tick) const {
    return (static_cast<double>(tick) - static_cast<double>(origin)) * dt;
  }
  bool Present(int hand) const { return summary.present[static_cast<std::size_t>(hand)]; }
};

struct ReadOptions {
  double detail = 120;                                  // kept with every tick at most [s]
  std::function<void(std::uint64_t records)> progress;  // now and then
};

// Gathers while the records come.
class RunCollector {
 public:
  explicit RunCollector(RunInfo info, const ReadOptions& options = {});
  ~RunCollector();
  RunCollector(const RunCollector&) = delete;
  RunCollector& operator=(const RunCollector&) = delete;
  // The next record.
  void Add(const TickRecord& record);
  // What was gathered, once.
  RunData Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The same where records are fetched: `next` gives them in their order, and false behind the last.
RunData ReadRun(RunInfo info, const std::function<bool(TickRecord*)>& next,
                const ReadOptions& options = {});

}  // namespace predictor
