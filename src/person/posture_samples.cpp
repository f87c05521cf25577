#include "person/posture_samples.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/random.h"

namespace predictor::person {
namespace {

// The standard normal numbers of one person, for the prior, the body and the back muscle.
constexpr int kDraws = kPriorVariations + kBodyVariations + 1;

// Draws antithetic pairs. Every second person has the negated numbers of the previous person. The
// mean of each varied parameter is therefore its nominal value.
std::vector<std::array<double, kDraws>> DrawPersons() {
  std::vector<std::array<double, kDraws>> z(kPostureSamples);
  RandomStream random(1, "posture");
  for (std::size_t i = 0; i < z.size(); i += 2) {
    for (std::size_t d = 0; d < kDraws; ++d) {
      z[i][d] = random.Normal();
      z[i + 1][d] = -z[i][d];
    }
  }
  return z;
}

}  // namespace

Interval IntervalOf(std::span<double> values) {
  if (values.empty()) throw std::invalid_argument("The interval needs at least one value.");
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const std::size_t outside = n >= 20 ? n / 20 - 1 : 0;
  return {(values[(n - 1) / 2] + values[n / 2]) / 2, values[outside], values[n - 1 - outside]};
}

PosturePrior VariedPrior(const PosturePrior& prior, std::span<const double> z,
                         const PostureSpread& spread) {
  PosturePrior p = prior;
  auto next = z.begin();
  const double common = *next++;
  for (double& swivel : p.swivel) swivel += spread.swivel * std::sqrt(0.5) * (common + *next++);
  p.comfort[kPelvisX] += spread.pelvis_forward * *next++;
  p.comfort[kPelvisY] += spread.pelvis_sideways * *next++;
  p.comfort[kPelvisTilt] += spread.pelvis_tilt * *next++;
  p.comfort[kTorsoFlexion] += spread.pelvis_tilt * *next++;
  for (const int joint : {kPelvisX, kPelvisTilt, kTorsoFlexion})
    p.weight[joint] *= std::exp(spread.spine_share * *next++);
  p.lowering *= std::exp(spread.spine_share * *next++);
  for (const int joint : {kNeckFlexion, kNeckTwist}) p.comfort[joint] += spread.neck * *next++;
  for (int i = 0; i < kHands * kArmJoints; ++i) p.comfort[kLeftArm + i] += spread.comfort * *next++;
  return p;
}

Anthropometry VariedBody(const BodySpec& spec, std::span<const double> z, double length,
                         double mass) {
  const auto factor = [&](std::size_t i, double spread) {
    return 1 + spread * std::clamp(z[i], -3.0, 3.0);
  };
  Anthropometry a = AnthropometryOf(spec);
  const auto stretch = [&](Segment* s, double f) {
    s->length *= f;
    s->com *= f;
    s->inertia *= f * f;
  };
  if (!spec.upper_arm) stretch(&a.upper_arm, factor(0, length));
  if (!spec.forearm) stretch(&a.forearm, factor(1, length));
  if (!spec.hand) stretch(&a.hand, factor(2, length));
  if (!spec.shoulder_distance) a.half_shoulder_width *= factor(3, length);
  if (!spec.trunk) {
    stretch(&a.pelvis, factor(4, length));
    stretch(&a.torso, factor(4, length));
    a.shoulder_height *= factor(4, length);
  }
  const auto weigh = [&](Segment* s, double f, int count) {
    a.pelvis.mass -= count * s->mass * (f - 1);
    s->mass *= f;
    s->inertia *= f;
  };
  weigh(&a.torso, factor(5, mass), 1);
  weigh(&a.upper_arm, factor(6, mass), 2);
  weigh(&a.forearm, factor(7, mass), 2);
  weigh(&a.hand, factor(8, mass), 2);
  return a;
}

PostureSampler::PostureSampler(const BodySpec& spec, const Stance& stance,
                               const std::array<Grip, kHands>& grips) {
  const PosturePrior prior = DefaultPrior();
  const PostureSpread spread;
  for (const auto& numbers : DrawPersons()) {
    const std::span<const double> z = numbers;
    const PosturePrior varied = VariedPrior(prior, z.first(kPriorVariations), spread);
    const BodyModel model(VariedBody(spec, z.subspan(kPriorVariations, kBodyVariations),
                                     spread.length, spread.segment_mass));
    const double arm = kBackMuscleArm + spread.back_muscle_arm * std::clamp(z.back(), -3.0, 3.0);
    persons_.push_back(
        {PostureSolver(model, stance, grips, varied), BodyDynamics(model, stance, arm)});
  }
}

SampledPosture PostureSampler::EvaluatePerson(std::size_t i, const BodySample& sample,
                                              const BodyMotion& nominal) const {
  const Person& person = persons_[i];
  const Posture posture = person.solver.Solve(sample, nominal.q);
  SampledPosture one;
  one.q = posture.q;
  one.reached = posture.reached;
  one.miss = posture.miss();
  one.angles = AnglesOf(person.solver.model(), posture.q, person.solver.stance().width);
  one.loads = person.dynamics.Evaluate({posture.q, nominal.v, nominal.a}, sample);
  return one;
}

std::vector<SampledPosture> PostureSampler::Evaluate(const BodySample& sample,
                                                     const BodyMotion& nominal) const {
  std::vector<SampledPosture> samples;
  samples.reserve(persons_.size());
  for (std::size_t i = 0; i < persons_.size(); ++i)
    samples.push_back(EvaluatePerson(i, sample, nominal));
  return samples;
}

}  // namespace predictor::person
