// The summary of a run: out of its TickRecords alone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/histogram.h"
#include "core/record.h"
#include "evaluation/statistics.h"
#include "scenario/scenario.h"

namespace predictor {

struct PairStatistics {
  Statistics translation;  // [m]; of the relative pose: distance
  Statistics rotation;     // [rad]; of the relative pose: angle
};

// Errors of the real handles against the virtual ones.
struct TrackingStatistics {
  std::array<PairStatistics, kHands> hands;
  PairStatistics relative;  // | |p| − |p^d| | and the angle between the relative rotations
};

struct StopSummary {
  StopCause cause = StopCause::kNone;
  int hand = -1;                        // −1 neither
  double value = 0, limit = 0;          // SI
  Quantity quantity = Quantity::kNone;  // of both
  double time = 0;                      // [s] emulated until then, whatever was reset meanwhile
  double duration = 0;                  // from the decision to rest [s]
  double distance = 0;                  // travelled by the faster handle meanwhile [m]
  // Simulated rig only: between the true force (torque) crossing its threshold and the decision.
  std::optional<double> detection;  // [s]
  StatusRecord harder = {};  // what took the power off at its end, where the cause would have held
};

// The arms did not rest though they were told to: its end, or its cause where a run had ended
// without one, says so. Then its duration and distance are only what was seen until then.
bool DidNotRest(const StopSummary& stop);

struct Summary {
  std::string scenario;
  std::uint64_t seed = 0;
  double duration = 0;      // simulated [s]
  std::uint64_t ticks = 0;  // in RUN
  double real_time_factor = 0;
  bool by_the_clock = false;  // it waited for each tick: the factor tells nothing of the computer
  std::array<bool, kHands> present = {};
  TrackingStatistics gripping, released;
  std::uint64_t released_ticks = 0;
  std::array<PairStatistics, kHands> wrench;  // |force| [N], |torque| [N·m]
  double elbow_distance_min = 0;              // [m]; +inf without link pairs
  double height_initial = 0, height_min = 0, height_max = 0, height_final = 0;  // of the object [m]
  // Those with a cause, in order; of more than kMostStops the first ones. stop_count: of all.
  static constexpr std::size_t kMostStops = 100;
  std::vector<StopSummary> stops;
  std::uint64_t stop_count = 0;
  std::uint64_t qp_solved = 0, qp_relaxed = 0, qp_failed = 0;
  std::array<Histogram, kStages> timing;  // [µs]
  std::uint64_t overruns = 0, records_dropped = 0;
};

// Builds a summary from records, in order. Ticks in which simulated time passed count for
// statistics: also the one in which a stop was decided, with the value that decided it.
class SummaryBuilder {
 public:
  explicit SummaryBuilder(const Scenario& scenario);
  void Add(const TickRecord& record);
  // What is measured by whoever ran it is left to be filled in.
  Summary& summary() { return summary_; }

 private:
  void AddTracking(const TickRecord& record);
  void FollowTime(const TickRecord& record);
  void FollowThresholds(const TickRecord& record);
  void FollowStops(const TickRecord& record);
  void FollowEnd(const TickRecord& record);
  StopSummary StopOf(const TickRecord& record) const;

  // The way and time of the handles from a stop's decision to rest, as the stop itself measures
  // them (StopController::Observe): by position and angle, and by what the arms' drivers tell.
  class Way {
   public:
    void Begin(const TickRecord& record);
    void Add(const TickRecord& record);
    double distance() const { return distance_; }   // of the handle that went farther [m]
    std::uint64_t ticks() const { return moved_; }  // until it moved no more

   private:
    std::array<std::array<double, 3>, kHands> corner_{};  // of the path, last [m]
    std::array<Pose, kHands> still_;                      // where rest is judged
    std::array<double, kHands> path_{};                   // [m]
    std::uint64_t ticks_ = 0, moved_ = 0;
    double distance_ = 0;
  };

  Summary summary_;
  double force_, torque_;  // thresholds [N], [N·m], for the time since the true value crossed them
  double dt_;              // [s]
  std::array<double, kHands> force_crossed_,
      torque_crossed_;  // time of the last upward crossing [s]
  bool first_ = true;
  double before_ = 0, run_time_ = 0;  // emulated before the last reset; since then [s]
  StopCause cause_ = StopCause::kNone;
  bool stopping_ = false;  // for the last of the stops
  Way way_;
};

// The contract of scripts: DESIGN's JSON. `timing`: with what depends on the machine's speed.
std::string SummaryJson(const Summary& summary, bool timing = true);

// The same for a person: a table in mm, degrees and N.
std::string SummaryTable(const Summary& summary);

}  // namespace predictor
