// The measured head of the person. The evaluation of a recording and the live evaluation use the
// same rules.
#pragma once

#include <cstddef>
#include <cstdint>

#include "assessment/hand_samples.h"
#include "assessment/person_setup.h"
#include "core/head_record.h"
#include "core/person_state.h"
#include "tracks/body_track.h"

namespace predictor::assessment {

inline double Seconds(std::uint64_t ns) { return 1e-9 * static_cast<double>(ns); }

// Appends a head that was measured at `time` [s]. Leaves out a head that is not later than the
// previous one.
void AppendMeasured(const HeadRecord& head, double time, tracks::PartTrack* track);

// Returns whether a head or an elbow of this person can be at `p_W` [m]. Wrong units, frames and
// markers give impossible positions.
bool IsPossible(const PersonSetup& setup, const Vector3& p_W);

// A share of the person's height (design choice). An elbow that is farther from its handle shows a
// wrong frame, or that left and right are exchanged.
inline constexpr double kElbowToHandle = 0.4;

// Counts the positions of a measured part of the body.
struct PositionCount {
  std::size_t measured = 0, impossible = 0;
  // If most positions are impossible, the others are probably wrong too, so none may be used.
  bool MostlyImpossible() const { return 2 * impossible > measured; }
};

// Adds the head at `time` of the track's clock to the sample and counts it. If the head was not
// measured then or is impossible, the sample remains unchanged.
HeadSource AddHeadAt(double time, const tracks::PartTrack& head, const PersonSetup& setup,
                     PersonSample* sample, PositionCount* count);

// The measured head during a run.
class LiveHead {
 public:
  // Takes the next head. `newest_ns` is the monotonic clock at the newest tick. Another process
  // measured the head, so a head that is not credible is left out.
  void Take(const HeadRecord& head, std::uint64_t newest_ns);

  // Returns whether a head that may still arrive could belong to the tick with the monotonic clock
  // `tick_ns`. The wait ends as soon as no arriving head can be usable: kMaxGap after the previous
  // head, and kLongestHeadDelay for its way.
  bool IsAwaited(std::uint64_t tick_ns, std::uint64_t newest_ns) const;

  // Adds the head to the sample. `clock` is the monotonic clock at the sample [s]. If most heads
  // since the last registration were impossible, no head is added.
  HeadSource AddTo(PersonSample* sample, double clock, const PersonSetup& setup);

 private:
  tracks::PartTrack track_;  // times: monotonic clock
  HeadRegistration registration_;
  PositionCount count_;
};

}  // namespace predictor::assessment
