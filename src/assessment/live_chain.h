// The nominal chain for a run in progress, which processes sample by sample with a fixed delay.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "assessment/muscle_use.h"
#include "assessment/person_chain.h"

namespace predictor::assessment {

// Accelerations need later postures, so loads and scores are judged this many samples late. The
// design choice of 0.1 s is five time constants of the smoothing filter, so later samples would
// hardly change its result.
inline constexpr std::size_t kLiveDelay = 10;
// Number of earlier postures that the filter uses. After 0.5 s, the initial state of the filter has
// no more influence.
inline constexpr std::size_t kLiveHistory = 60;

// Activations from electromyograms need later values of the electromyogram (kEmgSettling, less the
// muscle's delay of at least 0.01 s), so loads are then judged this many samples late.
inline constexpr std::size_t kLiveDelayWithEmg = 17;

struct JudgedSample {
  PersonSample sample;
  std::array<double, kHands> force_rate = {};  // see FrameInput
  person::BodyMotion motion;
  Frame frame;
};

// Postures, measured forces and force rates are the same as in RunNominal. Motions are exactly the
// same as in RunNominal if the whole uninterrupted part is known and has at most kLiveHistory
// samples. Otherwise, the motions are approximately the same.
class LiveChain {
 public:
  // Returns the activations that were measured at a sample.
  using Activations = std::function<std::array<MeasuredActivations, kHands>(const PersonSample&)>;

  // `delay` is kLiveDelay or, with electromyograms, kLiveDelayWithEmg. `measured` may be null.
  LiveChain(const PersonSetup& setup, const WorkPattern& work, std::size_t delay = kLiveDelay,
            Activations measured = {})
      : person_(setup, work), muscles_(setup), delay_(delay), measured_(std::move(measured)) {}

  // Takes the next sample in which a hand holds a handle.
  void Add(const PersonSample& sample);
  // Returns the posture of the newest sample.
  const person::Posture& newest() const { return postures_.back(); }
  // Gets the next sample that can be judged. Set `all` if no later sample continues the known
  // samples. All known samples can then be judged. Returns false if no sample can be judged yet.
  bool Next(bool all, JudgedSample* judged);

  const person::BodyModel& model() const { return person_.model(); }
  const PersonSetup& setup() const { return person_.setup(); }

 private:
  void Forget();

  NominalPerson person_;
  ArmMuscles muscles_;
  std::size_t delay_;
  Activations measured_;
  std::vector<PersonSample> samples_;  // same indices as postures_
  std::vector<person::Posture> postures_;
  std::size_t next_ = 0;  // the next sample to be judged
};

}  // namespace predictor::assessment
