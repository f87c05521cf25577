#include "analysis/population/people.h"

#include <algorithm>
#include <cmath>

#include "ergonomics/strength.h"

namespace predictor::population {
namespace {

class Draws {
 public:
  explicit Draws(RandomStream* random) : random_(*random) {}

  double Normal(double mean, double deviation, double low, double high) {
    return std::clamp(mean + deviation * random_.Normal(), low, high);
  }
  // `deviation` is the standard deviation of the logarithm.
  double LogNormal(double median, double deviation, double low, double high) {
    return std::clamp(median * std::exp(deviation * random_.Normal()), low, high);
  }

 private:
  RandomStream& random_;
};

BodySpec SampleBody(Sex sex, RandomStream* random) {
  Draws draw(random);
  BodySpec body;
  body.sex = sex;
  const double mean = sex == Sex::kMale ? 1.75 : 1.62;        // [m]
  const double deviation = sex == Sex::kMale ? 0.07 : 0.065;  // [m]
  body.height = draw.Normal(mean, deviation, mean - 3 * deviation, mean + 3 * deviation);
  body.mass = draw.LogNormal(25, 0.15, 17, 40) * body.height * body.height;
  body.strength = ergonomics::SampleStrength(random);
  body.stiffness = draw.LogNormal(1, 0.25, 0.5, 2);
  return body;
}

HandSpec SampleHand(const BodySpec& body, RandomStream* random) {
  Draws draw(random);
  HandSpec hand;
  hand.mass = std::clamp(hand.mass * body.mass / 75, 0.8, 3.0);
  hand.damping_ratio = draw.LogNormal(hand.damping_ratio, 0.25, 0.1, 0.6);
  hand.reflex_gain = draw.Normal(hand.reflex_gain, 0.1, 0, 0.6);
  hand.reflex_delay = draw.Normal(hand.reflex_delay, 0.01, 0.05, 0.1);
  hand.visual_delay = draw.Normal(hand.visual_delay, 0.02, 0.18, 0.25);
  hand.tremor_force = draw.LogNormal(hand.tremor_force, 0.35, 0.05, 0.3);
  hand.tremor_frequency = draw.Normal(hand.tremor_frequency, 1, 8, 12);
  hand.force_noise = draw.Normal(hand.force_noise, 0.006, 0.02, 0.05);
  hand.speed_drift = draw.LogNormal(hand.speed_drift, 0.3, 0.03, 0.12);
  return hand;
}

}  // namespace

std::vector<SampledPerson> SamplePopulation(int count, std::uint64_t seed) {
  std::vector<SampledPerson> people;
  for (int number = 1; number <= count; ++number) {
    RandomStream random(seed, "person." + std::to_string(number));
    SampledPerson person;
    person.number = number;
    person.seed = random.Next() % 1'000'000'000;
    person.body = SampleBody(number % 2 == 1 ? Sex::kFemale : Sex::kMale, &random);
    person.hand = SampleHand(person.body, &random);
    people.push_back(person);
  }
  return people;
}

void WritePerson(const SampledPerson& person, Scenario* scenario) {
  OperatorSpec* to = &scenario->operator_;
  scenario->seed = person.seed;
  to->embodied = true;
  to->body = person.body;
  const HandSpec& from = person.hand;
  to->hand.mass = from.mass;
  to->hand.damping_ratio = from.damping_ratio;
  to->hand.reflex_gain = from.reflex_gain;
  to->hand.reflex_delay = from.reflex_delay;
  to->hand.visual_delay = from.visual_delay;
  to->hand.tremor_force = from.tremor_force;
  to->hand.tremor_frequency = from.tremor_frequency;
  to->hand.force_noise = from.force_noise;
  to->hand.speed_drift = from.speed_drift;
}

}  // namespace predictor::population
