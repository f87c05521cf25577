// What a scenario may ask of `perturbation`, which moves the handles of a person.
#include <gtest/gtest.h>

#include <string>

#include "fixture.h"
#include "scenario/perturbation_force.h"

namespace predictor {
namespace {

TEST(Perturbation, NeedsThePersonsConsent) {
  EXPECT_FALSE(Fixture().perturbation);
  EXPECT_TRUE(Fixture({"perturbation={consent: true}"}).perturbation);
  EXPECT_NE(ErrorOf(FixtureText(), {"perturbation={consent: false}"}).find("perturbation.consent"),
            std::string::npos);
  EXPECT_NE(ErrorOf(FixtureText(), {"perturbation={amplitude: 0.006}"}).find("consent"),
            std::string::npos);
}

TEST(Perturbation, IsOnlyForHapticArms) {
  EXPECT_NE(ErrorOf(FixtureText(), {"mode=direct", "perturbation={consent: true}"})
                .find("mode: direct has none"),
            std::string::npos);
}

TEST(Perturbation, HasBoundsThatAScenarioCannotWiden) {
  for (const char* beyond : {"amplitude: 0.0081", "ramp: 0.09", "force: 15.1", "margin: 1.4",
                             "pause: 0.1", "speed: 0.11", "directions: 2", "normal: [0, 0, 0]"})
    EXPECT_NE(ErrorOf(FixtureText(), {std::string("perturbation={consent: true, ") + beyond + "}"}),
              "")
        << beyond;
}

// The bound against the largest force of the exact motion, sampled finely: never below it, and at
// most twice it for the hands that occur.
TEST(Perturbation, ForceIsBoundedByThatOfTheExactMotion) {
  PerturbationSpec p;
  p.amplitude = 0.008;
  p.ramp = 0.12;
  for (const double mass : {0.5, 1.5, 3.0}) {
    HandSpec hand;
    hand.mass = mass;
    hand.stiffness = {400, 100, 100};
    const double damping = 2 * hand.damping_ratio * std::sqrt(mass * 400);
    const auto at = [&](double t, int derivative) {
      const double s = std::clamp(t / p.ramp, 0.0, 1.0);
      if (derivative == 0) return p.amplitude * s * s * s * (10 - 15 * s + 6 * s * s);
      if (derivative == 1) return p.amplitude / p.ramp * 30 * s * s * (1 - s) * (1 - s);
      return p.amplitude / (p.ramp * p.ramp) * 60 * s * (1 - s) * (1 - 2 * s);
    };
    double largest = 0;
    for (double t = 0; t < 0.4; t += 1e-4) {
      const double late = t - hand.reflex_delay;
      const double force = mass * at(t, 2) + damping * at(t, 1) + 400 * at(t, 0) +
                           hand.reflex_gain * (damping * at(late, 1) + 400 * at(late, 0));
      largest = std::max(largest, std::abs(force));
    }
    const double bound = PerturbationForce(p, hand);
    EXPECT_GE(bound, largest);
    EXPECT_LE(bound, 2 * largest);
  }
}

TEST(Perturbation, IsRefusedIfTheScenariosHandWouldResistTooMuch) {
  const std::string error =
      ErrorOf(FixtureText(), {"operator.hand.mass=3", "operator.hand.stiffness=[600, 600, 600]",
                              "perturbation={consent: true, amplitude: 0.008, ramp: 0.12}"});
  EXPECT_NE(error.find("would resist with up to"), std::string::npos) << error;
}

}  // namespace
}  // namespace predictor
