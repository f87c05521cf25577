// Computes the state of the person at 100 Hz from successive ticks of a run in progress.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "assessment/hand_samples.h"
#include "assessment/live_chain.h"
#include "assessment/live_exposure.h"
#include "assessment/live_streams.h"
#include "assessment/live_values.h"
#include "assessment/measured_head.h"
#include "core/person_state.h"

namespace predictor::assessment {

class LivePerson {
 public:
  // Throws InputError if something is missing (MissingForPosture) or no adult has such a body.
  // Also throws InputError if a stream cannot be used (LiveStreams).
  LivePerson(const Scenario& scenario, const WorkPattern& work,
             std::span<const tracks::StreamDescription> streams = {});

  // Takes the next tick of a run or of a replay. Returns whether state() has changed. A repeated
  // tick is ignored. If an earlier tick follows, damage and fatigue start again. Throws InputError
  // if place, grips and handles contradict one another.
  bool Add(const TickRecord& record);
  // The measured head. Before you add a tick, add the heads that arrived, and wait while a head of
  // this tick is awaited (LiveHead::IsAwaited).
  LiveHead& head() { return head_; }
  // What other systems measure. The same applies as for the head.
  LiveStreams& streams() { return streams_; }
  const PersonState& state() const { return state_; }

 private:
  void BeginAgain();
  void Begin();
  bool Wait(const TickRecord& record);
  double ClockOf(const PersonSample& sample) const;
  void Take(PersonSample sample);
  void TakeHeld(PersonSample sample);
  void Judge(bool all);
  void Rest(PersonStatus status);

  Scenario scenario_;
  WorkPattern work_;
  std::uint64_t last_tick_ = 0;
  std::optional<PersonSetup> setup_;  // set in the first tick in RUN
  SampleBuilder builder_;
  HeldFilter held_;
  LiveHead head_;
  LiveStreams streams_;
  std::optional<LiveChain> chain_;
  std::optional<LiveIntervals> intervals_;
  LiveExposure exposure_;
  WarningKeeper warnings_;
  PersonState state_;
};

}  // namespace predictor::assessment
