// The data of one run for a report, collected in one pass over its records.
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
#include "evaluation/oscillation_index.h"
#include "evaluation/port_energy.h"
#include "evaluation/summary.h"
#include "report/trace.h"
#include "scenario/scenario.h"

namespace predictor {

// Everything about a recording except its ticks.
struct RunInfo {
  std::string name;           // file name, or another name that distinguishes the run
  std::string file;           // full file name, if `name` is shortened
  Scenario scenario;          // with all values resolved
  std::string scenario_yaml;  // with all values resolved
  std::string program_version;
  std::map<std::string, std::string> labels;
  std::vector<bool> prismatic;  // which joints of the cobot are; those beyond its end are not
  std::optional<PredictedLoop> loop;
  std::string date;     // start of the recording as text; empty: unknown
  std::string problem;  // problem with the file as text, for example that it was truncated
  struct Event {
    std::uint64_t tick = 0;
    std::string text;
  };
  std::vector<Event> events;  // markers
};

// The channels of a hand in the trace.
enum class HandChannel : std::size_t {
  kError,  // distance of the real from the virtual handle [mm]; like the following ones, only while
           // simulated time passes
  kErrorRotation,  // [deg]
  kForceX,         // of the hand, axes of W [N]
  kForceY,
  kForceZ,
  kForce,           // [N]
  kTorque,          // [N·m]
  kSpeed,           // of the real handle [mm/s]
  kCouplingForce,   // [N]
  kCouplingTorque,  // [N·m]
  kEnergy,          // energy that the hand has supplied at the real handle [J]
  kEnergyVirtual,   // the same, with the motion of the virtual handle [J]
  kEnergyCoupling,  // energy that the coupling has supplied to the virtual world [J]
  kJoint,           // of the arm, kMaxArmJoints of them [deg]
};
inline constexpr std::size_t kHandChannels =
    static_cast<std::size_t>(HandChannel::kJoint) + kMaxArmJoints;

enum class RunChannel : std::size_t {
  kDistance,       // error of the distance between the handles [mm]
  kAngle,          // error of the handles' relative rotation [deg]
  kLinkDistance,   // distance of the nearest link pair [m]
  kLimitSlack,     // [mm/s]
  kSlack,          // relaxation of the relative twist: linear part [mm/s]
  kSlackRotation,  // [deg/s]
  kStored,         // energy of the virtual world since the start [J]
  kTick,           // computing time of a tick [µs]
  kGuidance,       // distance of the object from the guidance path [mm]
  kObjectX,        // displacement from the start, in W [mm]
  kObjectY,
  kObjectZ,
  kCobotJoint,  // kMaxCobotJoints of them [deg], prismatic ones [mm]
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

// A stop of the run, with its time and distance.
struct ReportedStop {
  std::uint64_t tick = 0;       // tick of the decision
  StopSummary summary;          // its time is on the report's time axis
  std::uint64_t power_off = 0;  // tick at which summary.harder occurred; 0: it did not occur
};

struct ReportedEvent {
  std::uint64_t tick = 0;
  std::string text;
  bool marker = false;  // set by a person; otherwise caused by the run
};

// A part of the run in which the state is not RUN.
struct ReportedPart {
  std::uint64_t from = 0, to = 0;  // ticks
  RunState state = RunState::kInit;
};

// The latencies of one page, from a tick's start to its reception and to its display [ms].
struct PageLatency {
  Histogram received, rendered;
};

struct RunData {
  RunInfo info;
  double dt = 0.001;         // of a tick [s]
  std::uint64_t first = 0;   // tick
  std::uint64_t last = 0;    // "
  std::uint64_t origin = 0;  // tick at which the report's time is 0: the first tick of RUN
  std::uint64_t records = 0;
  std::uint64_t lost = 0, gaps = 0;  // number of missing ticks, and of the gaps they form
  std::uint64_t disordered = 0;      // records omitted because their tick was not later than the
                                     // previous one
  bool real_time = false;            // ticks have a wall-clock time
  Summary summary;
  Trace trace{kChannels, 0.001, 120};
  Hands present;  // hands that exist, once simulated time has passed
  std::array<int, kHands> arm_dof = {};
  int cobot_dof = 0;
  bool IsPrismatic(int joint) const {
    const auto j = static_cast<std::size_t>(joint);
    return j < info.prismatic.size() && info.prismatic[j];
  }
  std::array<double, 3> object_start = {};        // in W [m]
  std::array<std::vector<float>, 3> object_path;  // every 50 ms of RUN, in W [m]
  std::array<std::array<std::vector<float>, 3>, kHands> handle_paths;
  std::vector<ReportedStop> stops;
  std::vector<ReportedEvent> events;  // in chronological order
  std::uint64_t more_events = 0;      // number of events that were not kept
  std::vector<ReportedPart> parts;
  std::array<double, kParameters> parameters = {};  // at the end
  bool has_parameters = false;

  Histogram jitter, sensor_age, arm_age;   // [µs]
  std::vector<std::uint64_t> tick_counts;  // computing time: kTickBins per decade, starting at 1 µs
  std::map<std::uint32_t, PageLatency> pages;  // by the viewer's number
  std::array<PortEnergy, kHands> hand_port, virtual_port, coupling_port;
  double dissipated = 0;  // energy dissipated by the virtual world: input minus stored [J]
  double stored = 0;      // change of the virtual world's energy [J]
  std::array<std::vector<OscillationIndex::Window>, kHands> oscillation;
  // The numbers of ticks in which a bound of each joint, a bound of any joint, or a row of the
  // limits was active.
  std::array<std::array<std::uint64_t, kMaxArmJoints>, kHands> bound_ticks = {};
  std::uint64_t bounded_ticks = 0, row_ticks = 0;
  double slack_max = 0, slack_rotation_max = 0, limit_slack_max = 0;  // [m/s], [rad/s], [m/s]
  double kkt_max = 0;

  static constexpr int kTickBins = 20;
  // Returns the time on the report's time axis [s].
  double TimeOf(std::uint64_t tick) const {
    return (static_cast<double>(tick) - static_cast<double>(origin)) * dt;
  }
  bool Present(int hand) const { return present.Has(hand); }
};

struct ReadOptions {
  double detail = 120;  // longest time for which every tick is kept [s]
};

// Collects the data while records arrive.
class RunCollector {
 public:
  explicit RunCollector(RunInfo info, const ReadOptions& options = {});
  ~RunCollector();
  RunCollector(const RunCollector&) = delete;
  RunCollector& operator=(const RunCollector&) = delete;
  // Adds the next record.
  void Add(const TickRecord& record);
  // Returns the collected data. Call this only once.
  RunData Finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
