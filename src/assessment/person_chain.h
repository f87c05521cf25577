// The chain that computes frames from the samples of a run: posture, motion, loads, scores. The
// evaluation of a recording and the live evaluation use the same steps.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "assessment/frame.h"
#include "assessment/hand_samples.h"
#include "assessment/person_setup.h"
#include "person/posture_samples.h"
#include "person/posture_solver.h"
#include "person/skeleton.h"

namespace predictor::assessment {

// The steps of the chain for the nominal person.
class NominalPerson {
 public:
  NominalPerson(const PersonSetup& setup, const WorkPattern& work);
  // Returns the posture of the next sample. The solver starts from the previous posture.
  person::Posture Solve(const PersonSample& sample);
  // `posture` is the posture of this sample, and `motion` its smoothed motion.
  Frame Judge(const FrameInput& input, const person::BodyMotion& motion,
              const person::Posture& posture) const;
  const person::BodyModel& model() const { return solver_.model(); }
  const PersonSetup& setup() const { return setup_; }

 private:
  PersonSetup setup_;
  WorkPattern work_;
  person::PostureSolver solver_;
  person::BodyDynamics dynamics_;
  std::optional<person::BodyVector> last_;
};

// Returns the motions of the postures of an uninterrupted part. Trunk and head are treated as being
// at rest at each time. The posture model assumes that trunk and head follow the hands immediately,
// but the resulting acceleration was not observed.
std::vector<person::BodyMotion> MotionsOfPart(std::span<const person::BodyVector> postures);

// Returns the rate [N/s] at which each hand's force changed before sample i. The rate is averaged
// over 0.1 s to suppress noise and tremor. The rate is 0 if the samples are interrupted in these
// 0.1 s.
std::array<double, kHands> ForceRates(std::span<const PersonSample> samples, std::size_t i);

// The nominal person at each sample.
struct NominalChain {
  std::vector<person::Posture> postures;
  std::vector<person::BodyMotion> motions;
  std::vector<Frame> frames;
};
NominalChain RunNominal(const PersonSetup& setup, std::span<const PersonSample> samples,
                        const WorkPattern& work, const std::function<void(double)>& progress);

// Returns the frame of one possible person.
Frame FrameOfPerson(const person::SampledPosture& person, const FrameInput& input, Sex sex,
                    const WorkPattern& work);

// The number of samples from one evaluation of all possible people to the next evaluation, which
// gives a rate of 5 Hz.
inline constexpr std::size_t kSampledStride = 20;

// All possible people at every `stride`-th sample: frames[time][person].
struct SampledChain {
  std::vector<std::size_t> at;  // samples
  std::vector<std::vector<Frame>> frames;
};
SampledChain RunSampled(const PersonSetup& setup, std::span<const PersonSample> samples,
                        const NominalChain& nominal, std::size_t stride, const WorkPattern& work,
                        const std::function<void(double)>& progress);

// Returns the interval of the values that are known (see Frame), or no interval if fewer than half
// of the values are known. An interval of fewer people would describe the people who reach the
// handles, rather than the uncertainty.
std::optional<person::Interval> IntervalOfKnown(std::vector<double> values);

// All possible people at a single sample `i`, with their joints in S.
struct PossiblePersons {
  std::vector<Frame> frames;
  std::vector<person::Skeleton> skeletons;
};
PossiblePersons PossibleAt(const PersonSetup& setup, std::span<const PersonSample> samples,
                           const NominalChain& nominal, std::size_t i);

}  // namespace predictor::assessment
