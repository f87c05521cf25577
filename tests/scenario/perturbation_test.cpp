// Tests what a scenario may request with `perturbation`, which moves the handles of a person.
#include "scenario/perturbation.h"

#include <gtest/gtest.h>

#include <string>

#include "fixture.h"

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
  for (const char* beyond : {"amplitude: 0.0081", "ramp: 0.11", "force: 15.1", "margin: 1.4",
                             "pause: 0.1", "speed: 0.11", "directions: 2", "normal: [0, 0, 0]"})
    EXPECT_NE(ErrorOf(FixtureText(), {std::string("perturbation={consent: true, ") + beyond + "}"}),
              "")
        << beyond;
}

// A minimum-jerk motion has the peak speed 1.875 L/T and the peak acceleration 10/√3 L/T² (Flash &
// Hogan 1985).
TEST(Perturbation, ForceIsThatOfAMassAndOfASpringWithReflex) {
  PerturbationSpec p;
  p.amplitude = 0.008;
  p.ramp = 0.1;
  HandSpec mass;
  mass.mass = 2;
  mass.stiffness.setZero();
  EXPECT_NEAR(PerturbationForce(p, mass), 2 * 10 / std::sqrt(3.0) * 0.008 / 0.01, 2e-3);
  HandSpec spring;
  spring.mass = 1e-9;
  spring.damping_ratio = 0;
  spring.stiffness = {50, 400, 100};
  spring.reflex_gain = 0.5;
  EXPECT_NEAR(PerturbationForce(p, spring), 400 * 1.5 * 0.008, 1e-6);
  spring.damping_ratio = 1e4;  // 2 ζ √(m K) = 12.6 N·s/m
  spring.reflex_delay = 0.3;   // after the motion
  spring.reflex_gain = 0;
  spring.stiffness = {1e-3, 0, 0};
  EXPECT_NEAR(PerturbationForce(p, spring), 2e4 * 1e-6 * 1.875 * 0.08, 1e-4);
}

TEST(Perturbation, IsRefusedIfTheScenariosHandWouldResistTooMuch) {
  const std::string error =
      ErrorOf(FixtureText(), {"operator.hand.mass=3", "operator.hand.stiffness=[1500, 600, 600]",
                              "perturbation={consent: true, amplitude: 0.008}"});
  EXPECT_NE(error.find("would resist with up to"), std::string::npos) << error;
}

}  // namespace
}  // namespace predictor
