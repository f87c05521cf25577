#include "analysis/stability_map/growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/format.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"

namespace predictor {
namespace {

constexpr double kGripTime = 0.3;    // time in which the hands close [s]
constexpr double kTapStart = 0.4;    // [s]
constexpr double kTapRise = 0.02;    // rise and fall time; the plateau has the same duration [s]
constexpr double kTapForce = 1.5;    // force of a hand along the axis of its largest component [N]
constexpr double kSettle = 1.0;      // time at which the measurement of the difference starts [s]
constexpr double kBin = 0.5;         // time over which the difference is averaged [s]
constexpr double kMeanTime = 0.005;  // time over which the spectrum's samples are averaged [s]
// range of the spectrum [Hz]; ratio of successive frequencies
constexpr double kLowest = 0.3, kHighest = 80, kSpacing = 1.015;
constexpr double kPi = std::numbers::pi;
constexpr double kFaded = 0.02;  // as a share of the initial difference; below it only quantisation
                                 // of the sensors remains
// Fast modes are examined separately. The filter reveals a fast mode that grows from a sensor's
// quantisation. Otherwise, a decaying slow mode would hide the fast mode until limits stop its
// growth. The filter has this cut-off frequency [Hz] and this number of first-order stages.
constexpr double kFast = 15;
constexpr int kFastOrder = 4;
// A fast mode counts as growing if it rises above its minimum by these factors. The factors are
// larger than the effect of quantisation.
constexpr double kRisen = 5;
constexpr double kLimitedBin = 0.2;  // largest share of limited ticks in a bin that counts
constexpr double kNear = 0.95;       // share of a limit that counts as reaching it
// drift of the object from its start [m], [rad]
constexpr double kDrift = 0.02, kDriftRotation = 0.1;

ActionSpec Tap(const char* hand, const Vector3& direction) {
  const Vector3 force = kTapForce * direction;
  return MakeActionSpec(
      "push", kTapStart,
      {Formatted("duration=%.17g", kTapRise), Formatted("rise_time=%.17g", kTapRise),
       std::string("hand=") + hand,
       Formatted("force=[%.17g, %.17g, %.17g]", force.x(), force.y(), force.z())});
}

// Sets each threshold to the highest value that a scenario may have, so that nothing stops the run.
void SwitchStopsOff(SafetySpec* safety) {
  safety->force = 1000;
  safety->torque = 100;
  safety->tracking = 10;
  safety->tracking_rotation = 3.2;
  safety->relative_slack = 10;
  safety->relative_slack_rotation = 100;
  safety->relative_slack_time = 10;
  safety->coupling = safety->coupling_torque = 1e4;
  safety->frozen_samples = 100000;
  safety->oscillation.enabled = false;
}

Eigen::Map<const Vector6> Of(const std::array<double, 6>& x) {
  return Eigen::Map<const Vector6>(x.data());
}

// Detects the limits that act in a run.
class LimitWatch {
 public:
  explicit LimitWatch(const Scenario& s) : s_(s) {}

  // Returns the limits that act in this tick.
  std::array<bool, kLimitings> Of(const TickRecord& r) {
    std::array<bool, kLimitings> acts = {};
    const auto set = [&](Limiting limiting, bool on) {
      bool& is_on = acts[static_cast<std::size_t>(limiting)];
      is_on = is_on || on;
    };
    for (int i = 0; i < kHands; ++i) {
      const HandRecord& h = r.hands[static_cast<std::size_t>(i)];
      if (!h.present) continue;
      const Vector6 v = predictor::Of(h.virtual_.twist), F = predictor::Of(h.true_wrench);
      set(Limiting::kCoupling, !predictor::Of(h.coupling).isZero(0));
      set(Limiting::kSpeed, v.head<3>().norm() > kNear * s_.safety.handle_speed ||
                                v.tail<3>().norm() > kNear * s_.safety.handle_rotation_speed);
      set(Limiting::kGrip, F.head<3>().norm() > kNear * s_.operator_.hand.max_force ||
                               F.tail<3>().norm() > kNear * s_.operator_.hand.max_torque);
      set(Limiting::kAcceleration, IsAccelerating(i, h));
      set(Limiting::kSensor, h.sensor_saturated != 0);
    }
    set(Limiting::kRendering, r.qp_relaxed != 0 || r.qp_failed != 0 || r.guard_altered != 0);
    const Pose X_WO = FromRecord(r.object.pose);
    if (!start_) start_ = X_WO;
    set(Limiting::kPosture, (X_WO.p - start_->p).norm() > kDrift ||
                                RotationError(X_WO.q, start_->q).norm() > kDriftRotation);
    return acts;
  }

 private:
  // Returns whether a joint's command changed by the maximum that its limit allows per tick.
  bool IsAccelerating(int hand, const HandRecord& h) {
    auto& last = last_[static_cast<std::size_t>(hand)];
    bool accelerating = false;
    for (std::size_t j = 0; j < h.arm_dof; ++j) {
      const double limit = OneOrEach(s_.arm(hand).acceleration_limit, static_cast<int>(j));
      accelerating |= std::abs(h.command[j] - last[j]) > kNear * limit / s_.rate;
    }
    last = h.command;
    return accelerating;
  }

  const Scenario& s_;
  std::optional<Pose> start_;
  std::array<std::array<double, kMaxArmJoints>, kHands> last_ = {};
};

// The difference of the two runs: the linear velocities of both handles, and the angular velocities
// multiplied by a length [m/s].
using Difference = Eigen::Matrix<double, 6 * kHands, 1>;

// A high-pass filter of kFastOrder identical stages.
class FastPart {
 public:
  explicit FastPart(double dt) : keep_(1 / (1 + 2 * kPi * kFast * dt)) {
    for (auto* memory : {&in_, &out_}) memory->fill(Difference::Zero());
  }
  Difference Step(Difference x) {
    for (std::size_t k = 0; k < kFastOrder; ++k) {
      const Difference y = keep_ * (out_[k] + x - in_[k]);
      in_[k] = x;
      out_[k] = y;
      x = y;
    }
    return x;
  }

 private:
  double keep_;
  std::array<Difference, kFastOrder> in_, out_;
};

// The sums over one bin.
struct Bin {
  double squares = 0;  // sum over ticks
  double fast = 0;     // the same for the fast part
  int ticks = 0, limited = 0;
  std::vector<Difference> series;  // means over kMeanTime
};

// Returns the frequency of the strongest line in the spectrum of a series sampled every dt [s].
double StrongestFrequency(const std::vector<Difference>& series, double dt, double lowest) {
  double best = 0, strongest = 0;
  for (double f = lowest; f < std::min(kHighest, 0.45 / dt); f *= kSpacing) {
    const std::complex<double> turn = std::polar(1.0, 2 * kPi * f * dt);
    std::complex<double> phase = 1;
    Eigen::Matrix<std::complex<double>, 6 * kHands, 1> sum;
    sum.setZero();
    for (const Difference& x : series) {
      sum += phase * x;
      phase *= turn;
    }
    if (sum.squaredNorm() <= strongest) continue;
    strongest = sum.squaredNorm();
    best = f;
  }
  return best;
}

// The two runs, which are executed in step.
class Twins {
 public:
  explicit Twins(const Scenario& s, double lead)
      : plain_(HoldScenario(s, lead, false)),
        tapped_(HoldScenario(s, lead, true)),
        limits_plain_(plain_.scenario()),
        limits_tapped_(tapped_.scenario()),
        length_(s.rendering.characteristic_length),
        fast_(plain_.dt()),
        decimation_(std::max(1, static_cast<int>(std::lround(kMeanTime / plain_.dt())))) {}

  Growth Run(double time) {
    while (plain_.run_time() < kSettle + time && Step()) {
    }
    Growth growth = Judge(time);
    growth.time = std::max(0.0, plain_.run_time() - kTapStart);
    for (std::size_t k = 0; k < kLimitings; ++k)
      growth.limited[k] = ticks_ > 0 ? double(counts_[k]) / double(ticks_) : 0;
    for (const Emulator* e : {&plain_, &tapped_})
      if (e->record().cause != StopCause::kNone) growth.stopped = Name(e->record().cause);
    return growth;
  }

 private:
  static constexpr int kLongestStart = 20000;  // maximum number of ticks until RUN

  // Returns false when no further measurement is possible.
  bool Step() {
    for (Emulator* e : {&plain_, &tapped_}) {
      e->Tick();
      AutoStart(e);
    }
    if (plain_.state() != tapped_.state()) return false;
    if (plain_.state() != RunState::kRun)
      return plain_.run_time() == 0 && ++waited_ < kLongestStart;
    const auto acts = limits_plain_.Of(plain_.record());
    const auto acts_tapped = limits_tapped_.Of(tapped_.record());
    if (plain_.run_time() >= kSettle) Add(acts, acts_tapped);
    return !limited_out_;
  }

  Difference Now() const {
    Difference difference = Difference::Zero();
    for (int i = 0; i < kHands; ++i) {
      const auto hand = static_cast<std::size_t>(i);
      if (!plain_.record().hands[hand].present) continue;
      Vector6 v = Of(tapped_.record().hands[hand].virtual_.twist) -
                  Of(plain_.record().hands[hand].virtual_.twist);
      v.tail<3>() *= length_;
      difference.segment<6>(6 * i) = v;
    }
    return difference;
  }

  void Add(const std::array<bool, kLimitings>& acts,
           const std::array<bool, kLimitings>& acts_tapped) {
    const auto any = [](const auto& flags) {
      return std::any_of(flags.begin(), flags.end(), [](bool on) { return on; });
    };
    ++ticks_;
    for (std::size_t k = 0; k < kLimitings; ++k) counts_[k] += acts[k];
    if (bins_.empty() || bins_.back().ticks * plain_.dt() >= kBin - 1e-9) {
      if (!bins_.empty() && bins_.back().limited > kLimitedBin * bins_.back().ticks) {
        bins_.pop_back();
        limited_out_ = true;
        return;
      }
      bins_.emplace_back();
    }
    Bin& bin = bins_.back();
    ++bin.ticks;
    bin.limited += any(acts) || any(acts_tapped);
    const Difference now = Now();
    bin.squares += now.squaredNorm();
    bin.fast += fast_.Step(now).squaredNorm();
    if ((bin.ticks - 1) % decimation_ == 0) bin.series.emplace_back(Difference::Zero());
    bin.series.back() += now / decimation_;
  }

  // Returns the sign and the rate of the growth, from a straight line through the logarithm of the
  // difference. The first third of the run is ignored, because it still contains modes that decay
  // quickly.
  Growth Judge(double time) {
    if (!bins_.empty() && bins_.back().ticks * plain_.dt() < kBin - 1e-9) bins_.pop_back();
    const int n = static_cast<int>(bins_.size());
    const bool complete = n * kBin > time - 1.5 * kBin;
    Growth growth;
    growth.grows = true;
    if (n < 3) return growth;
    std::vector<double> level;
    for (const Bin& bin : bins_) level.push_back(std::log(std::sqrt(bin.squares) + 1e-300));
    int end = 1;
    while (end < n && level[static_cast<std::size_t>(end)] > level[0] + std::log(kFaded)) ++end;
    const int begin = std::min(end / 3, std::max(0, end - 3));
    const bool faded = end < n && level.back() < level[0] + std::log(2 * kFaded);
    growth.rate = SlopeOf(level, begin, std::max(end, begin + 2));
    growth.frequency = FrequencyOf(begin, std::max(end, begin + 2), kLowest);
    growth.grows = !faded && (*growth.rate > 0 || (complete && level.back() > level[0]));
    if (!growth.grows) JudgeFast(&growth);
    return growth;
  }

  // A fast mode counts as growing if it rises from its minimum until the end.
  void JudgeFast(Growth* growth) const {
    std::vector<double> level;
    for (const Bin& bin : bins_) level.push_back(std::log(std::sqrt(bin.fast) + 1e-300));
    const auto n = static_cast<int>(level.size());
    const auto lowest =
        static_cast<int>(std::min_element(level.begin(), level.end()) - level.begin());
    if (n - lowest < 4) return;
    const double rate = SlopeOf(level, lowest, n);
    if (rate * (n - lowest) * kBin < std::log(kRisen)) return;
    growth->grows = true;
    growth->rate = rate;
    growth->frequency = FrequencyOf(lowest, n, kFast);
  }

  static double SlopeOf(const std::vector<double>& level, int begin, int end) {
    double n = 0, t = 0, y = 0, tt = 0, ty = 0;
    for (int k = begin; k < end; ++k) {
      const double at = k * kBin, value = level[static_cast<std::size_t>(k)];
      n += 1, t += at, y += value, tt += at * at, ty += at * value;
    }
    return (n * ty - t * y) / (n * tt - t * t);
  }

  double FrequencyOf(int begin, int end, double lowest) const {
    std::vector<Difference> series;
    for (int k = begin; k < end; ++k) {
      const auto& part = bins_[static_cast<std::size_t>(k)].series;
      series.insert(series.end(), part.begin(), part.end());
    }
    return StrongestFrequency(series, decimation_ * plain_.dt(), lowest);
  }

  Emulator plain_, tapped_;
  LimitWatch limits_plain_, limits_tapped_;
  double length_;  // [m]
  FastPart fast_;
  int decimation_;  // ticks in kMeanTime
  std::vector<Bin> bins_;
  std::array<long, kLimitings> counts_ = {};
  long ticks_ = 0;
  int waited_ = 0;
  bool limited_out_ = false;  // limits act permanently, so the difference can no longer be used
};

}  // namespace

const char* Name(Limiting limiting) {
  constexpr std::array<const char*, kLimitings> kNames = {"the coupling",
                                                          "a handle's speed cap",
                                                          "a joint's acceleration limit",
                                                          "the hand's strength",
                                                          "a limit of the QP",
                                                          "the sensor's range",
                                                          "the object's displacement"};
  return kNames[static_cast<std::size_t>(limiting)];
}

Scenario HoldScenario(const Scenario& scenario, double lead, bool tap) {
  Scenario s = scenario;
  s.mode = Mode::kEmulate;
  s.device.type = "simulated";
  s.operator_.type = "virtual";
  std::erase_if(s.cobot.controller.parameters.items,
                [](const YamlNode& parameter) { return parameter.key == "trajectory"; });
  s.rendering.lead = lead;
  s.rig.start_offset = 0;
  SwitchStopsOff(&s.safety);
  s.operator_.script = {MakeActionSpec("grip", 0, {Formatted("duration=%.17g", kGripTime)})};
  // The taps of the two hands differ, so that the object both rotates and moves.
  if (tap && s.Has(0)) s.operator_.script.push_back(Tap("left", {1, 0.7, 0.9}));
  if (tap && s.Has(1)) s.operator_.script.push_back(Tap("right", {-0.4, 0.6, 0.3}));
  s.duration = 86400;
  return s;
}

Growth MeasureGrowth(const Scenario& scenario, double lead, double time) {
  return Twins(scenario, lead).Run(time);
}

}  // namespace predictor
