#include "assessment/safety/hand_exposure.h"

#include <algorithm>
#include <cmath>

#include "assessment/hand_samples.h"
#include "core/format.h"
#include "evaluation/metrics/registry.h"
#include "evaluation/statistics_samples.h"

namespace predictor::assessment {
namespace {

constexpr Unit kForceUnit = {"N", "N", 1, 1}, kForceRateUnit = {"N/s", "N/s", 1, 0},
               kImpulseUnit = {"N·s", "N·s", 1, 1}, kTorqueUnit = {"N·m", "N·m", 1, 2},
               kTimeUnit = {"s", "s", 1, 2}, kEnergyUnit = {"J", "J", 1, 2},
               kPowerUnit = {"W", "W", 1, 2}, kNumberUnit = {"", "", 1, 0};

Vector3 ForceOf(const HandRecord& hand) { return {hand.wrench[0], hand.wrench[1], hand.wrench[2]}; }

}  // namespace

HandExposure::HandExposure(const Scenario& scenario)
    : dt_(1 / scenario.rate),
      high_(kHighShare * scenario.safety.force),
      ticks_a_mean_(TicksPerSample(scenario.rate)) {
  for (Hand& hand : hands_) {
    hand.low_pass = LowPass<Vector3>(kCutoff, dt_, Vector3::Zero());
    hand.growing = OscillationDetector(scenario.safety.oscillation, dt_);
  }
  for (const MetricKind* kind : {&metrics::kOscillation, &metrics::kLinkDistance})
    metrics_.push_back(kind->make(scenario));
}

void HandExposure::AddForce(const HandRecord& record, Hand* hand) const {
  const Vector3 force = ForceOf(record);
  const Vector3 before = hand->low_pass.value();
  if (!hand->started) {
    hand->low_pass.Reset(force);
    hand->growing.Reset();
  } else {
    hand->rate = std::max(hand->rate, (hand->low_pass.Update(force) - before).norm() / dt_);
  }
  hand->started = true;
  const double magnitude = force.norm();
  hand->peak = std::max(hand->peak, magnitude);
  hand->smooth_peak = std::max(hand->smooth_peak, hand->low_pass.value().norm());
  hand->peak_torque = std::max(
      hand->peak_torque, Vector3(record.wrench[3], record.wrench[4], record.wrench[5]).norm());
  hand->impulse += magnitude * dt_;
  if (magnitude > high_) hand->high_time += dt_;
  if (const double amplitude = hand->growing.Update(force); amplitude > 0) {
    ++hand->growing_cycles;
    hand->growing_amplitude = std::max(hand->growing_amplitude, amplitude);
  }
  hand->sum += force;
  if (++hand->count < ticks_a_mean_) return;
  hand->means.push_back(hand->sum.norm() / static_cast<double>(hand->count));
  hand->sum.setZero();
  hand->count = 0;
}

void HandExposure::Add(const TickRecord& record) {
  for (const auto& metric : metrics_) metric->Add(record);
  ran_ = ran_ || record.ran != 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& now = record.hands[i];
    Hand& hand = hands_[i];
    hand.present = hand.present || now.present != 0;
    if (!now.present || !ran_) continue;
    if (record.ran) {
      AddForce(now, &hand);
      hand.scene.Add(
          Power(now.wrench, now.virtual_.twist) + Power(now.coupling, now.virtual_.twist), dt_);
    } else {
      hand.started = false;
    }
    if (record.ran || record.state == RunState::kStopping)
      hand.device.Add(Power(now.wrench, now.real.twist), dt_);
  }
}

void HandExposure::AppendHand(std::size_t i, std::vector<Result>* results) const {
  const Hand& hand = hands_[i];
  const std::string name = kHandNames[i];
  const auto add = [&](const char* key, const char* label, const Unit& unit,
                       const std::string& meaning, double value) {
    results->push_back({.path = "hands." + name + "." + key,
                        .group = name + " hand",
                        .label = label,
                        .unit = unit,
                        .meaning = meaning,
                        .value = value});
  };
  double squares = 0;
  for (const double mean : hand.means) squares += mean * mean;
  const double rms =
      hand.means.empty() ? NAN : std::sqrt(squares / static_cast<double>(hand.means.size()));
  const std::string tick = Formatted("%.0f Hz", 1 / dt_),
                    mean = Formatted("means over %.0f ms", 1e3 / kSampleRate),
                    smooth = Formatted("low-passed at %.0f Hz", kCutoff);
  add("peak_force_n", "peak force", kForceUnit,
      "estimated at " + tick + ", without further filtering", hand.peak);
  add("smooth_peak_force_n", "peak force, low-passed", kForceUnit, "estimated force, " + smooth,
      hand.smooth_peak);
  add("force_p95_n", "force, 95 %", kForceUnit, "95th percentile of " + mean,
      Quantile(hand.means, 0.95));
  add("force_rms_n", "force, rms", kForceUnit, "root mean square of " + mean, rms);
  add("impulse_ns", "impulse", kImpulseUnit, "integral of the force's magnitude", hand.impulse);
  add("force_rate_n_per_s", "rate of force", kForceRateUnit,
      "largest rate of change of the force " + smooth, hand.rate);
  add("high_force_s", "time with a high force", kTimeUnit,
      Formatted("time with a force above %.0f N, which is %.0f %% of the threshold of the stop",
                high_, 100 * kHighShare),
      hand.high_time);
  add("peak_torque_nm", "peak torque", kTorqueUnit, "estimated at " + tick, hand.peak_torque);
  add("growing_cycles", "growing cycles", kNumberUnit,
      "cycles of the force that ended a series of growing ones (the criterion of the stop)",
      hand.growing_cycles);
  add("growing_amplitude_n", "largest growing cycle", kForceUnit,
      "amplitude of the largest growing cycle", hand.growing_amplitude);
  add("supplied_j", "energy supplied", kEnergyUnit,
      "energy from the hand to the real handle, minus the energy in the other direction",
      hand.device.sum);
  add("returned_j", "energy received", kEnergyUnit, "energy from the real handle to the hand",
      hand.device.returned);
  add("peak_return_w", "peak power received", kPowerUnit, "power from the real handle to the hand",
      hand.device.peak_return);
  add("lowest_j", "lowest energy", kEnergyUnit,
      "lowest energy balance at the real handle; a passive device keeps it above the negative of "
      "the energy stored at the start",
      hand.device.lowest);
  add("active_episodes", "active episodes", kNumberUnit,
      "how often the energy balance fell below −0.05 J: the handle gave more than it had received",
      hand.device.episodes);
  add("scene_supplied_j", "energy into the scene", kEnergyUnit,
      "energy from the hand's wrench and the coupling to the virtual handle, minus the energy "
      "that returned",
      hand.scene.sum);
  add("scene_lowest_j", "lowest energy of the scene", kEnergyUnit,
      "lowest energy balance at the virtual handle", hand.scene.lowest);
}

std::vector<Result> HandExposure::results() const {
  std::vector<Result> results;
  for (std::size_t i = 0; i < kHands; ++i)
    if (hands_[i].present) AppendHand(i, &results);
  for (const auto& metric : metrics_) metric->AppendTo(&results);
  std::erase_if(results, [](const Result& result) { return IsMissing(result.value); });
  return results;
}

}  // namespace predictor::assessment
