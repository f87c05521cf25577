// Measures how long the parts of the person's evaluation take: posture, loads, muscles, 64 possible
// people, and the complete evaluation during a run.
#include <cmath>

#include "assessment/live_person.h"
#include "muscles/stiffness.h"
#include "person/posture_samples.h"
#include "samples.h"
#include "sections.h"

namespace predictor::bench {
namespace {

constexpr double kRate = 100;  // [Hz]

// Returns the poses of handles that move on a circle of 0.1 m once every 4 s. Each carries 40 N.
person::BodySample HandlesAt(const person::Stance& stance, double time) {
  person::BodySample sample;
  sample.time = time;
  const double phase = 1.5 * time;
  for (int hand = 0; hand < kHands; ++hand) {
    Pose X_SD = person::GripOn({0.2, 0, 1}, {-1, 0, 0});
    X_SD.p = {0.4 + 0.1 * std::cos(phase), hand == 0 ? 0.2 : -0.2, 1.05 + 0.1 * std::sin(phase)};
    person::HandSample& measured = sample.hands[static_cast<std::size_t>(hand)];
    measured.present = true;
    measured.X_WD = stance.X_WS * X_SD;
    measured.F_D_W[2] = 40;
  }
  return sample;
}

// Computes activations and stiffness of both arms. Returns the sum of all results, so that the
// compiler does not remove the computation.
double MusclesAt(const std::array<muscles::ArmModel, kHands>& arms,
                 const person::BodyMotion& motion, const person::BodyLoads& loads) {
  double sum = 0;
  for (const muscles::ArmModel& arm : arms) {
    const muscles::ArmVector q = muscles::ArmOf(motion.q, arm.hand());
    const muscles::MuscleLines lines = arm.LinesAt(q);
    const muscles::MuscleForces forces = arm.ForcesAt(lines, muscles::ArmOf(motion.v, arm.hand()));
    muscles::ActivationProblem problem;
    problem.torque = lines.moment_arm * forces.active.asDiagonal();
    problem.target = muscles::ArmOf(loads.torque, arm.hand()) - lines.moment_arm * forces.passive;
    const muscles::MuscleVector active =
        muscles::Activate(problem).activation.cwiseProduct(forces.active);
    sum += muscles::JointStiffness(arm, q, active, active + forces.passive).trace();
  }
  return sum;
}

// Returns a tick of a run in which the hands follow HandlesAt.
TickRecord TickAt(const person::Stance& stance, std::uint64_t tick) {
  TickRecord record{};
  record.tick = tick;
  record.run_time = 1e-3 * static_cast<double>(tick);
  record.ran = 1;
  const person::BodySample sample = HandlesAt(stance, record.run_time);
  for (std::size_t h = 0; h < kHands; ++h) {
    record.hands[h].present = record.hands[h].gripping = 1;
    record.hands[h].real.pose = ToRecord(sample.hands[h].X_WD);
    record.hands[h].wrench[2] = 40;
  }
  return record;
}

// Measures the share of a core that the evaluator needs for the nominal person at 100 Hz and for 64
// people at 5 Hz.
void TimeLive(bool quick) {
  Scenario scenario;
  scenario.left_handle = scenario.right_handle = HandleSpec{};
  scenario.operator_.body = BodySpec{};
  scenario.operator_.stance = StanceSpec{};
  const person::Stance stance = person::StanceAt({0, 0, 0}, {1, 0, 0});
  assessment::LivePerson live(scenario, {});
  const std::uint64_t ticks = quick ? 2000 : 20000;
  std::vector<double> states;
  double all = 0;
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    const TickRecord record = TickAt(stance, tick);
    bool judged = false;
    const double us = Microseconds([&] { judged = live.Add(record); });
    all += us;
    if (judged) states.push_back(us);
  }
  std::printf("live: %.0f us (p50), %.0f us (p99) per state; %.1f %% of a core in total\n",
              Median(states), Quantile(states, 0.99),
              all / (1e3 * static_cast<double>(ticks)) * 100);
}

}  // namespace

void TimePerson(bool quick) {
  const int count = quick ? 200 : 2000;
  const BodySpec spec;
  const person::Stance stance = person::StanceAt({0, 0, 0}, {1, 0, 0});
  const std::array<person::Grip, kHands> grips;
  const person::BodyModel model(spec);
  const person::PostureSolver solver(model, stance, grips);
  const person::BodyDynamics dynamics(model, stance);
  const person::PostureSampler sampler(spec, stance, grips);
  person::BodyMotion motion;
  motion.q = solver.prior().comfort;
  const std::array<muscles::ArmModel, kHands> arms = {muscles::ArmModel(spec, 0),
                                                      muscles::ArmModel(spec, 1)};
  std::vector<double> next, cold, loads, muscle, persons;
  double check = 0;  // so that nothing is optimised away
  for (int i = 0; i < count; ++i) {
    const person::BodySample sample = HandlesAt(stance, i / kRate);
    next.push_back(Microseconds([&] { motion.q = solver.Solve(sample, motion.q).q; }));
    cold.push_back(Microseconds([&] { check += solver.Solve(sample).q[0]; }));
    loads.push_back(Microseconds([&] {
      check += dynamics.Evaluate(motion, sample).l5s1.compression;
      check += person::AnglesOf(model, motion.q, stance.width).trunk_flexion;
    }));
    const person::BodyLoads now = dynamics.Evaluate(motion, sample);
    muscle.push_back(Microseconds([&] { check += MusclesAt(arms, motion, now); }));
    if (i % 50 == 0)
      persons.push_back(
          Microseconds([&] { check += sampler.Evaluate(sample, motion).back().miss; }));
  }
  Heading("Evaluation of the person (wall-clock time of one core)");
  std::printf("%-42s %9s %9s\n", "part", "p50 us", "p99 us");
  const auto row = [](const char* name, const std::vector<double>& us) {
    std::printf("%-42s %9.1f %9.1f\n", name, Median(us), Quantile(us, 0.99));
  };
  row("posture, from the previous posture", next);
  row("posture, from the comfortable posture", cold);
  row("inverse dynamics, loads and angles", loads);
  row("muscles and stiffness of both arms", muscle);
  row("64 possible people", persons);
  std::printf("nominal chain: %.0f Hz%s\n", 1e6 / (Median(next) + Median(loads) + Median(muscle)),
              std::isfinite(check) ? "" : " (not finite)");
  TimeLive(quick);
}

}  // namespace predictor::bench
