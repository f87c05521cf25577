#include "assessment/person_chain.h"

#include "person/body_model.h"
#include "person/posture_solver.h"

namespace predictor::assessment {
namespace {

std::vector<person::Posture> PosturesOf(const PersonSetup& setup,
                                        std::span<const PersonSample> samples,
                                        const std::function<void(double)>& progress) {
  const person::PostureSolver solver(person::BodyModel(setup.body), setup.stance, setup.grips);
  std::vector<person::Posture> postures;
  postures.reserve(samples.size());
  for (const PersonSample& sample : samples) {
    postures.push_back(postures.empty() ? solver.Solve(sample.body)
                                        : solver.Solve(sample.body, postures.back().q));
    progress(static_cast<double>(postures.size()) / static_cast<double>(samples.size()));
  }
  return postures;
}

// Smooths each part without interruption by itself. Trunk and head count as at rest at each time:
// that they follow the hands at once is an assumption of the posture, and the acceleration that it
// would cause was not observed.
std::vector<person::BodyMotion> MotionsOf(const std::vector<person::Posture>& postures,
                                          std::span<const PersonSample> samples) {
  std::vector<person::BodyMotion> motions;
  for (std::size_t begin = 0, end = 0; begin < postures.size(); begin = end) {
    end = begin + 1;
    while (end < postures.size() && samples[end].continues) ++end;
    std::vector<person::BodyVector> q;
    for (std::size_t i = begin; i < end; ++i) q.push_back(postures[i].q);
    auto part = person::SmoothMotion(q, 1 / kSampleRate);
    for (person::BodyMotion& motion : part) {
      motion.v.head<person::kLeftArm>().setZero();
      motion.a.head<person::kLeftArm>().setZero();
    }
    motions.insert(motions.end(), part.begin(), part.end());
  }
  return motions;
}

// Over 0.1 s, so that noise and tremor do not count.
std::array<double, kHands> ForceRates(std::span<const PersonSample> samples, std::size_t i) {
  constexpr std::size_t kWindow = 10;  // samples
  std::array<double, kHands> rates = {};
  for (std::size_t k = 0; k < kWindow; ++k)
    if (i < kWindow || !samples[i - k].continues) return rates;
  for (std::size_t h = 0; h < kHands; ++h) {
    const auto& now = samples[i].body.hands[h];
    const auto& before = samples[i - kWindow].body.hands[h];
    if (now.present && before.present)
      rates[h] = (now.F_D_W - before.F_D_W).head<3>().norm() * kSampleRate / kWindow;
  }
  return rates;
}

std::vector<Frame> FramesOf(const PersonSetup& setup, std::span<const PersonSample> samples,
                            std::size_t i, const WorkPattern& work,
                            const person::SampledBody& body) {
  std::vector<Frame> frames;
  frames.reserve(body.samples.size());
  for (const person::SampledPosture& one : body.samples)
    frames.push_back(FrameOf({samples[i].body, ForceRates(samples, i)}, one.angles, one.loads,
                             one.reached, setup.body.sex, work));
  return frames;
}

}  // namespace

NominalChain RunNominal(const PersonSetup& setup, std::span<const PersonSample> samples,
                        const WorkPattern& work, const std::function<void(double)>& progress) {
  NominalChain chain;
  chain.postures = PosturesOf(setup, samples, progress);
  chain.motions = MotionsOf(chain.postures, samples);
  const person::BodyModel model(setup.body);
  const person::BodyDynamics dynamics(model, setup.stance);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const person::BodySample& sample = samples[i].body;
    const person::BodyMotion& motion = chain.motions[i];
    chain.frames.push_back(FrameOf(
        {sample, ForceRates(samples, i)}, person::AnglesOf(model, motion.q, setup.stance.width),
        dynamics.Evaluate(motion, sample), chain.postures[i].reached, setup.body.sex, work));
  }
  return chain;
}

SampledChain RunSampled(const PersonSetup& setup, std::span<const PersonSample> samples,
                        const NominalChain& nominal, std::size_t stride, const WorkPattern& work,
                        const std::function<void(double)>& progress) {
  const person::PostureSampler sampler(setup.body, setup.stance, setup.grips);
  SampledChain chain;
  for (std::size_t i = 0; i < samples.size(); i += stride) {
    const person::SampledBody body = sampler.Evaluate(samples[i].body, nominal.motions[i]);
    chain.at.push_back(i);
    chain.frames.push_back(FramesOf(setup, samples, i, work, body));
    progress(static_cast<double>(i + 1) / static_cast<double>(samples.size()));
  }
  return chain;
}

PossiblePersons PossibleAt(const PersonSetup& setup, std::span<const PersonSample> samples,
                           const NominalChain& nominal, std::size_t i) {
  const person::PostureSampler sampler(setup.body, setup.stance, setup.grips);
  const person::SampledBody body = sampler.Evaluate(samples[i].body, nominal.motions[i]);
  PossiblePersons persons;
  persons.frames = FramesOf(setup, samples, i, {}, body);
  for (std::size_t k = 0; k < body.samples.size(); ++k)
    persons.skeletons.push_back(
        person::SkeletonOf(sampler.model(k), body.samples[k].q, setup.stance.width));
  return persons;
}

}  // namespace predictor::assessment
