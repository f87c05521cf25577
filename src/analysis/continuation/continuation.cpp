#include "analysis/continuation/continuation.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <utility>

#include "analysis/continuation/joint_loads.h"
#include "analysis/parallel.h"
#include "core/norm.h"
#include "devices/simulated/simulated_device.h"
#include "emulator/emulator.h"
#include "evaluation/port_energy.h"

namespace predictor {
namespace {

constexpr double kUnlimited = 1e6;  // replaces a limit of force, torque, distance or speed

// Returns the same scenario without the limits that would stop the run.
Scenario WithoutLimits(Scenario scenario) {
  SafetySpec& s = scenario.safety;
  for (double* limit :
       {&s.force, &s.torque, &s.coupling, &s.coupling_torque, &s.tracking, &s.tracking_rotation,
        &s.relative_slack, &s.relative_slack_rotation, &s.handle_speed, &s.handle_rotation_speed})
    *limit = kUnlimited;
  return scenario;
}

// Collects a continued run from its records.
class RunObserver {
 public:
  RunObserver(const Continuation& c, double dt)
      : force_limit_(c.force_limit), torque_limit_(c.torque_limit), horizon_(c.horizon), dt_(dt) {}

  void Add(const TickRecord& record) {
    time_ += dt_;
    const bool late = time_ > horizon_ * 2 / 3;
    double force = 0;
    for (std::size_t i = 0; i < kHands; ++i) {
      const HandRecord& hand = record.hands[i];
      if (hand.present == 0) continue;
      const double f = Norm(hand.wrench.data()), torque = Norm(hand.wrench.data() + 3);
      force = std::max(force, f);
      run_.peak_torque = std::max(run_.peak_torque, torque);
      run_.peak_speed = std::max(run_.peak_speed, Norm(hand.real.twist.data()));
      if (late) late_torque_ = std::max(late_torque_, torque);
      ports_[i].Add(Power(hand.wrench, hand.real.twist), dt_);
    }
    if (force > run_.peak_force) {
      run_.peak_force = force;
      run_.at_peak = record;
    }
    (late ? late_force_ : early_force_) = std::max(late ? late_force_ : early_force_, force);
    const auto piece = static_cast<std::size_t>((time_ - dt_ / 2) / kCurveStep);
    if (run_.force.size() <= piece) run_.force.resize(piece + 1, 0.0);
    run_.force[piece] = std::max(run_.force[piece], force);
    if (record.cobot_stop != 0) run_.cobot_stop = static_cast<CobotStop>(record.cobot_stop);
    run_.fault = record.cause;
  }

  ContinuedRun Finish(bool cobot_had_stopped) {
    run_.duration = time_;
    for (const PortEnergy& port : ports_) {
      run_.energy += port.returned;
      run_.peak_power = std::max(run_.peak_power, port.peak_return);
    }
    const bool above = late_force_ > force_limit_ || late_torque_ > torque_limit_;
    if (run_.fault != StopCause::kNone)
      run_.ending = Ending::kFault;
    else if (run_.cobot_stop != CobotStop::kNone && !cobot_had_stopped)
      run_.ending = Ending::kCobotStopped;
    else if (above && late_force_ > early_force_)
      run_.ending = Ending::kDiverges;
    else
      run_.ending = above ? Ending::kStaysAbove : Ending::kSettles;
    return std::move(run_);
  }

 private:
  double force_limit_, torque_limit_, horizon_, dt_;
  double time_ = 0, early_force_ = 0, late_force_ = 0, late_torque_ = 0;
  std::array<PortEnergy, kHands> ports_;
  ContinuedRun run_;
};

// Returns the measured joints of the arms [rad]. Absent arms are empty.
std::array<JointVector, kHands> JointsIn(const TickRecord& record) {
  std::array<JointVector, kHands> q;
  for (std::size_t i = 0; i < kHands; ++i)
    q[i] = Eigen::Map<const Eigen::VectorXd>(
        record.hands[i].q.data(), std::min<Eigen::Index>(record.hands[i].arm_dof, kMaxArmJoints));
  return q;
}

// An emulator without the limits, which a single thread uses.
class Continuer {
 public:
  Continuer(const StoppedRun& run, const OperatorMaker& recorded) : run_(run) {
    const Scenario scenario = WithoutLimits(run.scenario);
    auto person = std::make_unique<EstimatedOperator>(recorded(scenario));
    person_ = person.get();
    emulator_ = std::make_unique<Emulator>(
        scenario,
        std::make_unique<SimulatedDevice>(scenario, JointsIn(run.stop()), std::move(person)));
    emulator_->Tick();  // shows the operator its step
  }

  // If `draw` is null, the recorded operator continues.
  ContinuedRun Run(const Continuation& c, const IntentModel& intent, const OperatorDraw* draw) {
    emulator_->LoadState(run_.state);
    LiftThresholds();
    if (draw)
      person_->Begin(run_.past, emulator_->dt(), intent, *draw);
    else
      person_->UseRecorded();
    const bool cobot_had_stopped = run_.stop().cobot_stop != 0;
    RunObserver observer(c, emulator_->dt());
    const long ticks = std::lround(c.horizon / emulator_->dt());
    for (long i = 0; i < ticks; ++i) {
      emulator_->Tick();
      observer.Add(emulator_->record());
      if (emulator_->record().cause != StopCause::kNone) break;
    }
    ContinuedRun result = observer.Finish(cobot_had_stopped);
    if (draw) result.person = *draw;
    return result;
  }

 private:
  // The saved state contains the thresholds. Without an upper limit, the thresholds rise so fast
  // that they have no effect in the next tick.
  void LiftThresholds() {
    for (const Parameter parameter : {Parameter::kForceThreshold, Parameter::kTorqueThreshold}) {
      RunInput input;
      input.kind = InputKind::kParameter;
      input.parameter = parameter;
      input.value = kUnlimited;
      emulator_->Submit(input);
    }
  }

  const StoppedRun& run_;
  EstimatedOperator* person_ = nullptr;
  std::unique_ptr<Emulator> emulator_;
};

// Lends each thread its own Continuer, which the thread returns after each piece.
class ContinuerPool {
 public:
  ContinuerPool(const StoppedRun& run, OperatorMaker recorded)
      : run_(run), recorded_(std::move(recorded)) {}
  std::unique_ptr<Continuer> Take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        auto continuer = std::move(idle_.back());
        idle_.pop_back();
        return continuer;
      }
    }
    return std::make_unique<Continuer>(run_, recorded_);
  }
  void Return(std::unique_ptr<Continuer> continuer) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(continuer));
  }

 private:
  const StoppedRun& run_;
  OperatorMaker recorded_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Continuer>> idle_;
};

Continuation Describe(const StoppedRun& run, const ArmDistribution& arms,
                      const ContinueOptions& options) {
  const TickRecord& stop = run.stop();
  Continuation c;
  c.scenario = run.scenario.name;
  c.operator_type = run.scenario.operator_.type;
  c.cause = {stop.cause, stop.cause_hand, stop.cause_value, stop.cause_limit, stop.cause_quantity};
  c.time = stop.run_time;
  c.horizon = options.horizon;
  c.force_limit = run.scenario.safety.force;
  c.torque_limit = run.scenario.safety.torque;
  c.arm_source = arms.source();
  c.peak_before = run.peak_before;
  for (const TickRecord& record : run.past) {
    double force = 0;
    for (const HandRecord& hand : record.hands)
      if (hand.present != 0) force = std::max(force, Norm(hand.wrench.data()));
    c.past_times.push_back(record.run_time - stop.run_time);
    c.past_force.push_back(force);
  }
  c.peak_before = std::max(c.peak_before, c.past_force.back());
  return c;
}

}  // namespace

const char* Name(Ending ending) {
  constexpr std::array<const char*, kEndings> kNames = {"settles", "stays_above", "diverges",
                                                        "cobot_stops", "fault"};
  return kNames[static_cast<std::size_t>(ending)];
}

Interval90 Continuation::IntervalOf(double ContinuedRun::*value) const {
  std::vector<CensoredValue> values;
  for (const ContinuedRun& run : runs)
    if (std::isfinite(run.*value)) values.push_back({run.*value, run.ending == Ending::kFault});
  // With these two probabilities, a further draw lies in the interval with a probability of 90 %,
  // for any number n of draws. The ranks of the order statistics are p (n + 1), but Quantile counts
  // them as 1 + p' (n - 1).
  const auto n = static_cast<double>(values.size());
  const auto probability = [n](double p) {
    return n < 2 ? p : std::clamp((p * (n + 1) - 1) / (n - 1), 0.0, 1.0);
  };
  return {CensoredQuantile(values, probability(0.05)), CensoredQuantile(values, 0.5),
          CensoredQuantile(values, probability(0.95))};
}

int Continuation::CountOf(Ending ending) const {
  return static_cast<int>(std::ranges::count(runs, ending, &ContinuedRun::ending));
}

Continuation Continue(const StoppedRun& run, const ArmDistribution& arms,
                      const ContinueOptions& options) {
  CheckContinuable(run.scenario);
  Continuation c = Describe(run, arms, options);
  const auto draws = static_cast<std::size_t>(options.draws);
  std::atomic<std::size_t> done = 0;
  std::vector<ContinuedRun> runs(draws + (options.reference ? 1 : 0));
  ContinuerPool pool(run, options.recorded_operator);
  DoInParallel(
      runs.size(), options.workers,
      [&](std::size_t i) {
        auto continuer = pool.Take();
        if (i < draws) {
          const OperatorDraw draw = DrawOperator(arms, run.scenario.operator_.hand, options.intent,
                                                 options.seed, static_cast<int>(i));
          runs[i] = continuer->Run(c, options.intent, &draw);
        } else {
          runs[i] = continuer->Run(c, options.intent, nullptr);
        }
        pool.Return(std::move(continuer));
        ++done;
      },
      [&] { options.progress(static_cast<double>(done) / static_cast<double>(runs.size())); });
  if (options.reference) {
    c.reference = std::move(runs.back());
    runs.pop_back();
  }
  c.runs = std::move(runs);
  if (options.joint_loads)
    AddJointLoads(run, options.workers, &c);
  else
    c.no_joint_use = "it was not requested";
  return c;
}

}  // namespace predictor
