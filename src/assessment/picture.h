// The data for a picture of the body at one time of a run: the joints of the body, and the loads on
// its parts.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "assessment/person_chain.h"
#include "core/person_state.h"
#include "person/skeleton.h"

namespace predictor::assessment {

// A part of the body that has a load.
struct PartKind {
  const char* name;  // "left shoulder"
  int hand;          // the hand that the part belongs to; -1: neither
};
const PartKind& KindOf(BodyPart part);

// The loads as shares of a reference. For the compression of the lower back, the reference is
// kCompressionLimit. For the torques of shoulder and elbow, the reference is the mean strength for
// the person's sex.
using PartLoads = std::array<double, kBodyParts>;
PartLoads LoadsOf(const Frame& frame);

struct BodyPicture {
  double time = 0;  // [s]
  person::Skeleton body;
  PartLoads loads = {};
  std::array<Vector3, kHands> force;  // force of each hand on its handle, in S [N]
  // The possible people at this time, if they were computed.
  std::vector<person::Skeleton> possible;
  std::array<std::optional<person::Interval>, kBodyParts> intervals;
};

// Returns the index of the sample with the highest load of any body part.
std::size_t WorstSample(const NominalChain& nominal);

// Returns the data of the picture at one sample. `possible` states whether to include all possible
// people.
BodyPicture PictureAt(const PersonSetup& setup, std::span<const PersonSample> samples,
                      const NominalChain& nominal, std::size_t i, bool possible);

}  // namespace predictor::assessment
