#include "assessment/picture.h"

#include <algorithm>
#include <cmath>

namespace predictor::assessment {
namespace {

constexpr PartKind kKinds[kBodyParts] = {{"lower back", -1},
                                         {"left shoulder", 0},
                                         {"right shoulder", 1},
                                         {"left elbow", 0},
                                         {"right elbow", 1}};

}  // namespace

const PartKind& KindOf(BodyPart part) { return kKinds[static_cast<std::size_t>(part)]; }

PartLoads LoadsOf(const Frame& frame) {
  return {frame.loads.l5s1.compression / kCompressionLimit, frame.shoulder_use[0],
          frame.shoulder_use[1], frame.elbow_use[0], frame.elbow_use[1]};
}

std::size_t WorstSample(const NominalChain& nominal) {
  const auto highest = [](const Frame& frame) {
    double most = -1;  // below every known load
    for (const double load : LoadsOf(frame)) most = std::fmax(most, load);
    return most;
  };
  const auto worst = std::ranges::max_element(nominal.frames, {}, highest);
  return static_cast<std::size_t>(worst - nominal.frames.begin());
}

BodyPicture PictureAt(const PersonSetup& setup, std::span<const PersonSample> samples,
                      const NominalChain& nominal, std::size_t i, bool possible) {
  BodyPicture picture;
  const person::BodySample& sample = samples[i].body;
  picture.time = sample.time;
  picture.body =
      person::SkeletonOf(person::BodyModel(setup.body), nominal.motions[i].q, setup.stance.width);
  picture.loads = LoadsOf(nominal.frames[i]);
  for (std::size_t h = 0; h < kHands; ++h)
    picture.force[h] =
        sample.hands[h].present
            ? Vector3(setup.stance.X_WS.q.conjugate() * sample.hands[h].F_D_W.head<3>())
            : Vector3::Zero();
  if (!possible) return picture;
  const PossiblePersons persons = PossibleAt(setup, samples, nominal, i);
  picture.possible = persons.skeletons;
  for (std::size_t part = 0; part < kBodyParts; ++part) {
    std::vector<double> loads;
    for (const Frame& frame : persons.frames) loads.push_back(LoadsOf(frame)[part]);
    picture.intervals[part] = IntervalOfKnown(loads);
  }
  return picture;
}

}  // namespace predictor::assessment
