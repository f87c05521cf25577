// The chain from the samples of a run to frames: posture, motion, loads, scores.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "assessment/frame.h"
#include "assessment/hand_samples.h"
#include "assessment/person_setup.h"
#include "person/posture_samples.h"
#include "person/skeleton.h"

namespace predictor::assessment {

// The nominal person at each sample.
struct NominalChain {
  std::vector<person::Posture> postures;
  std::vector<person::BodyMotion> motions;
  std::vector<Frame> frames;
};
NominalChain RunNominal(const PersonSetup& setup, std::span<const PersonSample> samples,
                        const WorkPattern& work, const std::function<void(double)>& progress);

// All possible persons at every `stride`-th sample: frames[time][person].
struct SampledChain {
  std::vector<std::size_t> at;  // samples
  std::vector<std::vector<Frame>> frames;
};
SampledChain RunSampled(const PersonSetup& setup, std::span<const PersonSample> samples,
                        const NominalChain& nominal, std::size_t stride, const WorkPattern& work,
                        const std::function<void(double)>& progress);

// All possible persons at sample `i` alone, with their joints in S.
struct PossiblePersons {
  std::vector<Frame> frames;
  std::vector<person::Skeleton> skeletons;
};
PossiblePersons PossibleAt(const PersonSetup& setup, std::span<const PersonSample> samples,
                           const NominalChain& nominal, std::size_t i);

}  // namespace predictor::assessment
