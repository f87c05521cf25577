#include "ergonomics/fatigue.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace predictor::ergonomics {
namespace {

constexpr double kForEver = std::numeric_limits<double>::infinity();
constexpr double kDevelopment = 10;       // LD = LR [1/s]
constexpr double kMaxFatigueStep = 0.05;  // [s]
constexpr double kMinRohmertLoad = 0.15;

struct JointFatigue {
  std::string_view name;
  FatigueRates rates;
  double b0, b1;  // parameters of the power law [s]
};
constexpr JointFatigue kJointFatigue[kFatigueJoints] = {
    {"ankle", {0.00589, 0.00058, 15}, 34.71, -2.06},
    {"knee", {0.01500, 0.00149, 15}, 19.38, -1.88},
    {"trunk", {0.00755, 0.00075, 15}, 22.69, -2.27},
    {"shoulder", {0.01820, 0.00168, 15}, 14.86, -1.83},
    {"elbow", {0.00912, 0.00094, 15}, 17.98, -2.21},
    {"grip", {0.00980, 0.00064, 30}, 33.55, -1.61},
    {"general", {0.00970, 0.00091, 15}, 21.92, -1.98}};

const JointFatigue& Of(FatigueJoint joint) { return kJointFatigue[static_cast<int>(joint)]; }

// Returns the flow from the resting share to the active share of the muscle [1/s].
double Recruitment(const Compartments& m, double load) {
  if (m.active >= load) return kDevelopment * (load - m.active);
  return kDevelopment * std::min(load - m.active, m.resting);
}

struct Flows {
  double active, resting, fatigued;
};
Flows FlowsOf(const Compartments& m, double load, const FatigueRates& rates) {
  const double recruited = Recruitment(m, load);
  const double fatigued = rates.fatigue * m.active;
  const double recovered = rates.recovery * (load > 0 ? 1 : rates.rest_multiplier) * m.fatigued;
  return {recruited - fatigued, recovered - recruited, fatigued - recovered};
}

Compartments After(const Compartments& m, const Flows& f, double dt) {
  return {m.active + dt * f.active, m.resting + dt * f.resting, m.fatigued + dt * f.fatigued};
}

Compartments RungeKutta(const Compartments& m, double load, double dt, const FatigueRates& rates) {
  const Flows a = FlowsOf(m, load, rates);
  const Flows b = FlowsOf(After(m, a, dt / 2), load, rates);
  const Flows c = FlowsOf(After(m, b, dt / 2), load, rates);
  const Flows d = FlowsOf(After(m, c, dt), load, rates);
  return After(m,
               {(a.active + 2 * b.active + 2 * c.active + d.active) / 6,
                (a.resting + 2 * b.resting + 2 * c.resting + d.resting) / 6,
                (a.fatigued + 2 * b.fatigued + 2 * c.fatigued + d.fatigued) / 6},
               dt);
}

}  // namespace

std::string_view NameOf(FatigueJoint joint) { return Of(joint).name; }

FatigueRates FatigueRatesOf(FatigueJoint joint) { return Of(joint).rates; }

Compartments Fatigued(const Compartments& state, double load, double dt,
                      const FatigueRates& rates) {
  const double target = std::clamp(load, 0.0, 1.0);
  const double steps = std::max(1.0, std::ceil(dt / kMaxFatigueStep));
  Compartments m = state;
  for (double i = 0; i < steps; ++i) m = RungeKutta(m, target, dt / steps, rates);
  return m;
}

double FatiguedShareUnderConstantLoad(double load, double time, const FatigueRates& rates) {
  return -rates.fatigue * load / rates.recovery * std::expm1(-rates.recovery * time);
}

double EnduranceTime(double load, const FatigueRates& rates) {
  if (load <= 0) return kForEver;
  const double left = 1 - rates.recovery * (1 - load) / (rates.fatigue * load);
  return left > 0 ? -std::log(left) / rates.recovery : kForEver;
}

double MeasuredEnduranceTime(double load, FatigueJoint joint) {
  if (load <= 0) return kForEver;
  return Of(joint).b0 * std::pow(load, Of(joint).b1);
}

double RohmertEnduranceTime(double load) {
  if (load <= kMinRohmertLoad) return kForEver;
  const double x = 1 / load;
  return 60 * (-1.5 + 2.1 * x - 0.6 * x * x + 0.1 * x * x * x);
}

double Capacity(double capacity, double load, double dt, const CapacityRates& rates) {
  if (load > 0) return capacity * std::exp(-rates.fatigue * load * dt);
  return 1 - (1 - capacity) * std::exp(-rates.recovery * dt);
}

double CapacityEnduranceTime(double load, const CapacityRates& rates) {
  return load > 0 ? -std::log(load) / (rates.fatigue * load) : kForEver;
}

double TrialFatigue::Effort() const {
  return -reference_load * reference_time / std::log(1 - kTrialExhaustion);
}

double TrialFatigueAfter(double fatigue, double load, double dt, const TrialFatigue& trial) {
  if (load >= trial.threshold) return 1 - (1 - fatigue) * std::exp(-load * dt / trial.Effort());
  return fatigue * std::exp(-trial.recovery * dt / trial.Effort());
}

}  // namespace predictor::ergonomics
