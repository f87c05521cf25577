#include "assessment/person_chain.h"

#include <cmath>

#include "person/body_model.h"

namespace predictor::assessment {
namespace {

// Smooths each uninterrupted part separately.
std::vector<person::BodyMotion> MotionsOf(const std::vector<person::Posture>& postures,
                                          std::span<const PersonSample> samples) {
  std::vector<person::BodyMotion> motions;
  for (std::size_t begin = 0, end = 0; begin < postures.size(); begin = end) {
    end = begin + 1;
    while (end < postures.size() && samples[end].continues) ++end;
    std::vector<person::BodyVector> q;
    for (std::size_t i = begin; i < end; ++i) q.push_back(postures[i].q);
    const auto part = MotionsOfPart(q);
    motions.insert(motions.end(), part.begin(), part.end());
  }
  return motions;
}

std::vector<Frame> FramesOf(const PersonSetup& setup, std::span<const PersonSample> samples,
                            std::size_t i, const WorkPattern& work,
                            const std::vector<person::SampledPosture>& persons) {
  std::vector<Frame> frames;
  frames.reserve(persons.size());
  for (const person::SampledPosture& one : persons)
    frames.push_back(
        FrameOfPerson(one, {samples[i].body, ForceRates(samples, i)}, setup.body.sex, work));
  return frames;
}

}  // namespace

NominalPerson::NominalPerson(const PersonSetup& setup, const WorkPattern& work)
    : setup_(setup),
      work_(work),
      solver_(person::BodyModel(setup.body), setup.stance, setup.grips),
      dynamics_(solver_.model(), setup.stance) {}

person::Posture NominalPerson::Solve(const PersonSample& sample) {
  const person::Posture posture =
      last_ ? solver_.Solve(sample.body, *last_) : solver_.Solve(sample.body);
  last_ = posture.q;
  return posture;
}

Frame NominalPerson::Judge(const FrameInput& input, const person::BodyMotion& motion,
                           const person::Posture& posture) const {
  return FrameOf(input, person::AnglesOf(model(), motion.q, setup_.stance.width),
                 dynamics_.Evaluate(motion, input.sample), {posture.reached, posture.miss()},
                 setup_.body.sex, work_);
}

std::vector<person::BodyMotion> MotionsOfPart(std::span<const person::BodyVector> postures) {
  auto motions = person::SmoothMotion(postures, 1 / kSampleRate);
  for (person::BodyMotion& motion : motions) {
    motion.v.head<person::kLeftArm>().setZero();
    motion.a.head<person::kLeftArm>().setZero();
  }
  return motions;
}

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

NominalChain RunNominal(const PersonSetup& setup, std::span<const PersonSample> samples,
                        const WorkPattern& work, const std::function<void(double)>& progress) {
  NominalPerson person(setup, work);
  NominalChain chain;
  chain.postures.reserve(samples.size());
  for (const PersonSample& sample : samples) {
    chain.postures.push_back(person.Solve(sample));
    progress(static_cast<double>(chain.postures.size()) / static_cast<double>(samples.size()));
  }
  chain.motions = MotionsOf(chain.postures, samples);
  for (std::size_t i = 0; i < samples.size(); ++i)
    chain.frames.push_back(person.Judge({samples[i].body, ForceRates(samples, i)}, chain.motions[i],
                                        chain.postures[i]));
  return chain;
}

Frame FrameOfPerson(const person::SampledPosture& person, const FrameInput& input, Sex sex,
                    const WorkPattern& work) {
  return FrameOf(input, person.angles, person.loads, {person.reached, person.miss}, sex, work);
}

SampledChain RunSampled(const PersonSetup& setup, std::span<const PersonSample> samples,
                        const NominalChain& nominal, std::size_t stride, const WorkPattern& work,
                        const std::function<void(double)>& progress) {
  const person::PostureSampler sampler(setup.body, setup.stance, setup.grips);
  SampledChain chain;
  for (std::size_t i = 0; i < samples.size(); i += stride) {
    chain.at.push_back(i);
    chain.frames.push_back(
        FramesOf(setup, samples, i, work, sampler.Evaluate(samples[i].body, nominal.motions[i])));
    progress(static_cast<double>(i + 1) / static_cast<double>(samples.size()));
  }
  return chain;
}

std::optional<person::Interval> IntervalOfKnown(std::vector<double> values) {
  const std::size_t all = values.size();
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  if (values.empty() || 2 * values.size() < all) return {};
  return person::IntervalOf(values);
}

PossiblePersons PossibleAt(const PersonSetup& setup, std::span<const PersonSample> samples,
                           const NominalChain& nominal, std::size_t i) {
  const person::PostureSampler sampler(setup.body, setup.stance, setup.grips);
  const auto drawn = sampler.Evaluate(samples[i].body, nominal.motions[i]);
  PossiblePersons persons;
  persons.frames = FramesOf(setup, samples, i, {}, drawn);
  for (std::size_t k = 0; k < drawn.size(); ++k)
    persons.skeletons.push_back(
        person::SkeletonOf(sampler.model(k), drawn[k].q, setup.stance.width));
  return persons;
}

}  // namespace predictor::assessment
