// The body at one time of a run, for pictures: its joints, and how loaded its parts are.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "assessment/person_chain.h"
#include "core/person_state.h"
#include "person/skeleton.h"

namespace predictor::assessment {

// Of a part of the body that has a load.
struct PartKind {
  const char* name;  // "left shoulder"
  int hand;          // whose part it is; -1: of no single hand
};
const PartKind& KindOf(BodyPart part);

// Loads as shares of a reference: compression of the lower back of kCompressionLimit, torques of
// shoulder and elbow of the mean strength of the person's sex.
using PartLoads = std::array<double, kBodyParts>;
PartLoads LoadsOf(const Frame& frame);

struct BodyPicture {
  double time = 0;  // [s]
  person::Skeleton body;
  PartLoads loads = {};
  std::array<Vector3, kHands> force;  // of the hands on the handles, in S [N]
  // Only where they were computed: of the possible persons at this time.
  std::vector<person::Skeleton> possible;
  std::array<std::optional<person::Interval>, kBodyParts> intervals;
};

// The sample with the highest load of any of these parts.
std::size_t WorstSample(const NominalChain& nominal);

// The picture at one sample. `possible`: with all possible persons.
BodyPicture PictureAt(const PersonSetup& setup, std::span<const PersonSample> samples,
                      const NominalChain& nominal, std::size_t i, bool possible);

}  // namespace predictor::assessment
