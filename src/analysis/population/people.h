// A population of simulated operators. The operators are different people, not one person whose
// posture is unknown.
//
// person::PostureSampler draws 64 people who could have given the same measurements, and its
// spread expresses ignorance about one person. The spread in this population therefore shows how
// people with known bodies differ from one another.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor::population {

// One person of the population, with the seed for the person's noise, tremor and pace.
struct SampledPerson {
  int number = 1;  // starts at 1
  std::uint64_t seed = 1;
  BodySpec body;
  HandSpec hand;  // with the sampled members, see WritePerson
};

// The first `count` people of a population. The properties of a person do not depend on `count`.
// People with odd numbers are women, and people with even numbers are men. Marks: R, recalled from
// the literature; D, our choice.
// - height: women 1.62 ± 0.065 m, men 1.75 ± 0.07 m (R), within 3 standard deviations;
// - mass: body-mass index lognormal, median 25 kg/m², 15 % (D), 17 to 40 kg/m²;
// - strength: ergonomics::SampleStrength, 30 % and correlated by 0.7 between directions (R);
// - stiffness of the joints: lognormal, 25 % (D), because reported stiffnesses of hands range
//   from 200 to 600 N/m;
// - reaction: visual 0.2 ± 0.02 s, reflex 60 ± 10 ms, reflex gain 0.4 ± 0.1 (R; spread D);
// - hand: mass in proportion to the body's, damping ratio, tremor, noise and drift of pace about
//   the defaults of HandSpec (spread D), all within the ranges of docs/concepts/operator.md.
std::vector<SampledPerson> SamplePopulation(int count, std::uint64_t seed);

// Gives the operator of a scenario the body of a person.
void WritePerson(const SampledPerson& person, Scenario* scenario);

}  // namespace predictor::population
