// The summary of a run, computed only from its TickRecords.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/handle_odometer.h"
#include "core/histogram.h"
#include "core/predicted_loop.h"
#include "core/record.h"
#include "evaluation/statistics.h"
#include "scenario/scenario.h"

namespace predictor {

struct PairStatistics {
  Statistics translation;  // [m]
  Statistics rotation;     // [rad]
};

// Errors of the real handles relative to the virtual ones.
struct TrackingStatistics {
  std::array<PairStatistics, kHands> hands;
  // Error of the distance between the handles, | |p| − |p^d| |, and angle between their relative
  // rotations.
  PairStatistics relative;
  // Position of the right handle in the frame of the left one: vector error |p − p^d| [m].
  Statistics right_from_left;
};

struct StopSummary {
  StopCause cause = StopCause::kNone;
  int hand = -1;                        // −1: neither
  double value = 0, limit = 0;          // SI
  Quantity quantity = Quantity::kNone;  // quantity of value and limit
  double time = 0;      // emulated time until the stop, including the time before resets [s]
  double duration = 0;  // from the decision to rest [s]
  double distance = 0;  // path of the faster handle from the decision to rest [m]
  // Simulated rig only: time from the true force (torque) crossing its threshold to the decision.
  std::optional<double> detection;  // [s]
  StatusRecord harder = {};  // the fault that removed the power at the end of a stop that would
                             // otherwise have held
};

// True if the arms did not come to rest although they were commanded to. The stop's final fault
// shows this; if the run had ended without a cause, its cause does. Duration and distance are then
// only the values observed so far.
bool DidNotRest(const StopSummary& stop);

struct Summary {
  std::string scenario;
  std::uint64_t seed = 0;
  double duration = 0;      // simulated [s]
  std::uint64_t ticks = 0;  // number of ticks in RUN
  double real_time_factor = 0;
  bool by_the_clock = false;  // the run was paced by the clock, so its real-time factor does not
                              // show the computer's speed
  std::optional<PredictedLoop> loop;  // empty in mode `direct` or if the recording does not contain
                                      // it
  std::array<bool, kHands> present = {};
  TrackingStatistics gripping, released;  // while all hands grip, and the remaining time
  TrackingStatistics whole_run;           // both
  std::uint64_t released_ticks = 0;
  std::array<PairStatistics, kHands> wrench;  // |force| [N], |torque| [N·m]
  double link_distance_min = 0;               // [m]; +inf without link pairs
  double height_initial = 0, height_min = 0, height_max = 0, height_final = 0;  // of the object [m]
  // Stops with a cause, in order; only the first kMostStops are kept. stop_count counts all of
  // them.
  static constexpr std::size_t kMostStops = 100;
  std::vector<StopSummary> stops;
  std::uint64_t stop_count = 0;
  std::uint64_t qp_solved = 0, qp_relaxed = 0, qp_failed = 0;
  std::array<Histogram, kStages> timing;  // [µs]
  std::uint64_t overruns = 0, records_dropped = 0;
};

// Builds a summary from records, in order. Statistics include every tick in which simulated time
// passed, also the tick in which a stop was decided and the value that caused it.
class SummaryBuilder {
 public:
  explicit SummaryBuilder(const Scenario& scenario);
  void Add(const TickRecord& record);
  // The caller fills in the values that it measures itself.
  Summary& summary() { return summary_; }

 private:
  void AddTracking(const TickRecord& record);
  void FollowTime(const TickRecord& record);
  void FollowThresholds(const TickRecord& record);
  void FollowStops(const TickRecord& record);
  void FollowEnd(const TickRecord& record);
  StopSummary StopOf(const TickRecord& record) const;

  // Path and time of the handles from a stop's decision to rest, measured as the stop itself does.
  class StopMeter {
   public:
    void Begin(const TickRecord& record);
    void Add(const TickRecord& record);
    double distance() const { return distance_; }   // path of the handle that moved further [m]
    std::uint64_t ticks() const { return moved_; }  // ticks until no handle moved

   private:
    HandleOdometer odometer_;
    RestDetector rest_;
    std::uint64_t ticks_ = 0, moved_ = 0;
    double distance_ = 0;
  };

  Summary summary_;
  double force_, torque_;  // thresholds [N], [N·m], for the time since the true value exceeded them
  double dt_;              // [s]
  std::array<double, kHands> force_crossed_,
      torque_crossed_;  // time of the last upward crossing [s]
  bool first_ = true;
  double before_ = 0, run_time_ = 0;  // emulated time before the last reset, and since then [s]
  StopCause cause_ = StopCause::kNone;
  bool stopping_ = false;  // for the last stop
  StopMeter meter_;
};

// JSON for scripts; scripts depend on its format. `timing`: include the values that depend on the
// computer's speed.
std::string SummaryJson(const Summary& summary, bool timing = true);

// The same for people: a table in mm, degrees and N.
std::string SummaryTable(const Summary& summary);

// Lead, margin and prediction as a sentence.
std::string LoopWords(const PredictedLoop& loop);

}  // namespace predictor
