// Runs of simulated people that the emulator stops. The tests of the continuation use them.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/continuation/continuation.h"
#include "core/format.h"
#include "core/random.h"
#include "devices/simulated/simulated_device.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "scenarios.h"

namespace predictor {

// A person whose arm becomes stiffer as its force increases. The continuation does not assume this
// behaviour. The person's force is the simulated operator's force multiplied by 1 + |F| / F0, so an
// infinite F0 makes no difference.
class StiffeningOperator final : public Operator {
 public:
  StiffeningOperator(std::unique_ptr<Operator> person, double force)
      : person_(std::move(person)), force_(force) {}
  void Step(const OperatorInput& input, OperatorOutput* output) noexcept override {
    person_->Step(input, output);
    for (Wrench& F : output->F_H_W) F *= 1 + F.head<3>().norm() / force_;
  }
  void Reset() noexcept override { person_->Reset(); }
  void Archive(StateArchive& a) noexcept override { person_->Archive(a); }

 private:
  std::unique_ptr<Operator> person_;
  double force_;  // F0 [N]
};

// A simulated person and the disturbance that acts on the person.
struct StoppedPerson {
  Scenario scenario;
  std::string what;
  double stiffening = HUGE_VAL;

  OperatorMaker Maker() const {
    return [force = stiffening](const Scenario& s) {
      return std::make_unique<StiffeningOperator>(MakeOperator(s, HandInertia::kInWrench), force);
    };
  }
};

inline double Between(RandomStream* random, double low, double high) {
  return low + (high - low) * random->Uniform();
}

// Perturbs the parameters of the hand, beyond the ranges of the prior if `outside` is true.
inline void PerturbHand(RandomStream* random, bool outside, HandSpec* hand) {
  const double spread = outside ? 2 : 1;
  const double common = std::exp(0.3 * spread * random->Normal());
  for (int i = 0; i < 3; ++i) hand->stiffness[i] *= common * std::exp(0.15 * random->Normal());
  hand->damping_ratio *= std::exp(0.3 * spread * random->Normal());
  hand->mass *= std::exp(0.25 * spread * random->Normal());
  hand->reflex_gain = outside ? Between(random, 0.6, 0.9) : Between(random, 0.1, 0.7);
  hand->reflex_delay = outside ? Between(random, 0.1, 0.16) : Between(random, 0.045, 0.085);
  hand->max_force = 150;
}

// Draws a disturbance, which is either a push by the person or a hazard of the cobot.
inline std::vector<std::string> DisturbanceOf(RandomStream* random, std::string* what) {
  const double at = Between(random, 2, 4);
  const auto event = [&](const std::string& name, const std::string& parameters) {
    *what = name;
    return std::vector<std::string>{Formatted("events=[{event: %s, trigger: {after: %.4f}%s}]",
                                              name.c_str(), at, parameters.c_str())};
  };
  switch (static_cast<int>(6 * random->Uniform())) {
    case 0:
    case 1: {
      *what = "push";
      const double force = Between(random, 40, 75), angle = Between(random, 0, 6.2832);
      return {Formatted(
          "operator.script=[{action: grip, start: 0, duration: 0.5}, {action: move, "
          "start: 1, duration: 4, by: [0, 0.1, 0.1]}, {action: push, start: %.4f, "
          "duration: 0.6, force: [%.3f, %.3f, 0], rise_time: %.4f}]",
          at, force * std::cos(angle), force * std::sin(angle), Between(random, 0.06, 0.3))};
    }
    case 2:
      return event("set_point_jump",
                   Formatted(", xyz: [%.4f, %.4f, %.4f]", Between(random, -0.12, 0.12),
                             Between(random, -0.12, 0.12), Between(random, -0.25, 0.25)));
    case 3:
      return event("control_freeze", "");
    case 4:
      return event("object_slips", Formatted(", slip_force: %.3f", Between(random, 30, 60)));
    default:
      return event("brakes_close", "");
  }
}

inline StoppedPerson DrawPerson(std::uint64_t seed, bool outside) {
  RandomStream random(seed, outside ? "people.outside" : "people.inside");
  StoppedPerson person;
  const char* file = random.Uniform() < 0.6 ? "box_9kg.yaml" : "box_18kg.yaml";
  std::vector<std::string> set = DisturbanceOf(&random, &person.what);
  set.emplace_back("duration=8");
  person.scenario = Load(file, set);
  person.scenario.seed = seed;
  PerturbHand(&random, outside, &person.scenario.operator_.hand);
  person.stiffening = Between(&random, 60, 200);
  return person;
}

// Returns an emulator of this person whose arms begin at their places. `scenario` is the person's
// scenario, perhaps with other limits.
inline std::unique_ptr<Emulator> EmulatorOf(const StoppedPerson& person, const Scenario& scenario) {
  return std::make_unique<Emulator>(
      scenario, std::make_unique<SimulatedDevice>(scenario, Emulator(scenario).setup().start,
                                                  person.Maker()(scenario)));
}

// Simulates until a limit stops the run for the first time. Returns no value if no limit stops the
// run.
inline std::optional<StoppedRun> RunToStop(const StoppedPerson& person) {
  const Scenario& scenario = person.scenario;
  const std::unique_ptr<Emulator> emulator = EmulatorOf(person, scenario);
  StopFinder finder(scenario.rate);
  std::vector<std::byte> now(kStateBytes);
  std::size_t size = 0;  // of the state before the next tick
  Simulate(emulator.get(), scenario.duration, [&](const TickRecord& record) {
    if (finder.found() || finder.Add(record)) return;
    size = emulator->SaveState(now);
  });
  if (!finder.found()) return {};
  StoppedRun run;
  run.scenario = scenario;
  run.state.assign(now.begin(), now.begin() + static_cast<long>(size));
  run.past = finder.past();
  run.peak_before = finder.peak_before();
  run.first = finder.first();
  return run;
}

}  // namespace predictor
