#include "analysis/hazard_study/hazard_runs.h"

#include <algorithm>
#include <array>

#include "analysis/hazard_study/run_measures.h"
#include "core/error.h"
#include "core/norm.h"
#include "emulator/run_loop.h"
#include "evaluation/events.h"
#include "evaluation/stops.h"

namespace predictor {
namespace {

ClearCrossing CrossingOf(const Scenario& scenario) {
  std::array<double, kHands> resolved = {};
  for (const int i : scenario.hands())
    resolved[static_cast<std::size_t>(i)] = ResolvedForce(scenario.arm(i).sensor);
  return {scenario.safety.force, resolved};
}

}  // namespace

// Measures a run from its records. A copy continues the measurement independently.
class HazardObserver {
 public:
  explicit HazardObserver(const Scenario& scenario)
      : threshold_(scenario.safety.force),
        events_(scenario),
        stops_(scenario),
        crossing_(CrossingOf(scenario)),
        commanded_(scenario) {}

  // Adds the next record, in order.
  void Add(const TickRecord& record) {
    events_.Add(record);
    stops_.Add(record);
    crossing_.Add(record);
    commanded_.Add(record);
    if (run_.excess < 0 && record.cause == StopCause::kForce && record.cause_hand >= 0) {
      // How far the true force of the hand that caused the stop exceeds the threshold.
      const HandRecord& hand = record.hands[static_cast<std::size_t>(record.cause_hand)];
      run_.excess = std::max(0.0, Norm(hand.true_wrench.data()) - threshold_);
      run_.clear_detection = crossing_.duration(record.cause_hand);
    }
    if (record.ran == 0 || record.latest_event != 0) return;
    for (const HandRecord& hand : record.hands)
      if (hand.present != 0) run_.before = std::max(run_.before, Norm(hand.wrench.data()));
  }

  HazardRun RunOf(std::uint64_t seed) const {
    HazardRun run = run_;
    run.seed = seed;
    const EventSummary& event = events_.events().front();
    run.begin = event.begin.value_or(-1);
    run.commanded = commanded_.share();
    run.after = *std::ranges::max_element(event.force);
    run.torque = *std::ranges::max_element(event.torque);
    run.speed = *std::ranges::max_element(event.speed);
    run.until_stop = event.until_stop.value_or(-1);
    if (events_.cobot_stop()) run.cobot_stop = events_.cobot_stop()->reason;
    if (stops_.stops().empty()) return run;
    const StopSummary& stop = stops_.stops().front();
    run.cause = stop.cause;
    run.detection = stop.cause == StopCause::kForce ? stop.detection.value_or(-1) : -1;
    run.travel = stop.distance;
    return run;
  }

 private:
  double threshold_;  // [N]
  EventLog events_;
  StopLog stops_;
  ClearCrossing crossing_;
  CommandedSpeeds commanded_;
  HazardRun run_;  // its fields `before`, `excess` and `clear_detection`
};

HazardRuns::HazardRuns(const Scenario& scenario) : emulator_(scenario), state_(kStateBytes) {
  HazardObserver observer(scenario);
  const double earliest = scenario.events.front().trigger.after;
  Simulate(&emulator_, std::min(earliest, scenario.duration) - emulator_.dt(),
           [&](const TickRecord& record) { observer.Add(record); });
  state_.resize(emulator_.SaveState(state_));
  if (state_.empty()) throw InputError("The state of this scenario is too large to be saved.");
  beginning_ = std::make_unique<const HazardObserver>(std::move(observer));
}

HazardRuns::~HazardRuns() = default;

HazardRun HazardRuns::Run(std::uint64_t seed) {
  HazardObserver observer = *beginning_;
  emulator_.LoadState(state_, seed);
  Simulate(&emulator_, emulator_.scenario().duration,
           [&](const TickRecord& record) { observer.Add(record); });
  return observer.RunOf(seed);
}

}  // namespace predictor
