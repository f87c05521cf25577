// An operator of whom only the recorded motion and forces are known. This model of the operator is
// used to continue a run after a stop.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "analysis/continuation/arm_distribution.h"
#include "core/filters.h"
#include "core/record.h"
#include "rig/operator.h"
#include "rig/random_process.h"

namespace predictor {

// The assumptions about the operator after the stop, apart from the arm (design choices). The
// duration of a change of intention is unknown. Each draw assumes that the intention continues to
// change at its present rate until the change is about as large as the hand's present force.
struct IntentModel {
  // The present rate is taken over a time before the stop. The distribution of this time is
  // log-uniform in this range [s].
  double shortest_trend = 0.04, longest_trend = 0.2;
  // The change after the stop as a multiple of the present force: its median, and the standard
  // deviation of its logarithm. The rate decays with a time constant of at most `longest_change`
  // [s].
  double change = 1.8, change_spread = 0.6, longest_change = 1;
  // With this probability, the change (for example, a push) ends after a time that is log-uniform
  // in this range [s]. The drive then returns to its mean over the first kBaselineTime of the past,
  // with a time constant of `end_time` [s].
  double chance_of_end = 0.5, earliest_end = 0.15, latest_end = 1.5, end_time = 0.08;
  // New intentions are modelled by an intended position that moves at a random speed. The speed has
  // this rms along each axis [m/s] and is correlated over `wander_time` [s].
  double wander = 0.08, wander_time = 0.5;
  // The rms of the noise vectors of force and torque, relative to the present magnitudes of force
  // and torque. The noise is correlated over `noise_time` [s]. The noise represents everything that
  // the model omits.
  double noise = 0.1, noise_time = 0.3;
  // The arm stiffens with its force: K (1 + c |F| / kStiffeningForce), with c uniform from 0 to
  // this value.
  double max_stiffening = 1;
  // The visual correction is drawn from a uniform distribution up to this multiple of the
  // scenario's stiffness. The delay of the visual correction is drawn with this spread.
  double max_sight = 1.5, sight_delay_spread = 0.15;
};
inline constexpr double kStiffeningForce = 30;  // [N]
inline constexpr double kBaselineTime = 0.2;    // [s]

// One possible operator.
struct OperatorDraw {
  ArmImpedance arm;
  double trend_time = 0;            // time over which the trend is taken, before the stop [s]
  double change = 0;                // as in IntentModel
  double end = 0;                   // time after which the change ends [s]
  double stiffening = 0;            // c
  Vector3 sight = Vector3::Zero();  // stiffness of the visual correction [N/m]
  double sight_delay = 0;           // [s]
  RandomStream noise{0, ""};
};
// Returns the draw with the given number. For every run, the same number gives the same operator
// (common random numbers), so that two runs are compared for the same operators.
OperatorDraw DrawOperator(const ArmDistribution& arms, const HandSpec& hand,
                          const IntentModel& intent, std::uint64_t seed, int number);

// F = u − z − g z(t − δ) − Kv x(t − δv) − M a, where z integrates K (1 + c |F| / 30 N) dx and
// contains the damping D √(1 + c |F| / 30 N) v, and x is the displacement of the handle. The drive
// u is the operator's intention, expressed as a force: the sum of K xr, D vr, the reflex to the
// intended motion, and the feed-forward. Before the stop, u follows from the measured force and
// motion. After the stop, the trend of u over the last `trend_time` continues and decays with a
// time constant (IntentModel). Afterwards, u is constant apart from noise. The stiffness grows with
// the force as in Perreault, Kirsch & Crago 2002 (quoted from memory).
class EstimatedHand {
 public:
  // `past` contains consecutive records up to the tick in which the stop was decided. `record_step`
  // is the interval between two records [s]. `dt` is the step of the operator [s].
  void Begin(std::span<const TickRecord> past, std::size_t hand, double record_step, double dt,
             const IntentModel& intent, const OperatorDraw& draw);
  // Advances by dt and returns the wrench F_H_W on the handle.
  Wrench Step(const FrameMotion& handle) noexcept;
  bool holds() const { return holds_; }

  // These functions return the estimated drive and its trend at the stop.
  const Vector6& drive() const { return drive_; }
  const Vector6& trend() const { return trend_; }  // [N/s], [N·m/s]

 private:
  void Prepare(const HandRecord& first, double dt, const OperatorDraw& draw);
  Vector6 Resist(const Pose& X_W, const Twist& V_W, double force) noexcept;
  std::vector<Vector6> DriveBefore(std::span<const TickRecord> past, std::size_t hand,
                                   double record_step);
  void FitTrend(const std::vector<Vector6>& drive, double record_step, const IntentModel& intent);

  OperatorDraw draw_;
  Vector6 stiffness_, damping_;
  Pose origin_;                                                   // pose at the beginning of `past`
  Vector6 stretch_ = Vector6::Zero(), spring_ = Vector6::Zero();  // displacement, and the force due
                                                                  // to it
  double dt_ = 0, time_ = 0;
  double persistence_ = 1, end_time_ = 1;  // decay of the trend; its end [s]
  double force_ = 0, torque_ = 0;          // magnitudes in the last step [N], [N·m]
  bool holds_ = false;
  Vector6 drive_ = Vector6::Zero(), trend_ = Vector6::Zero();
  Vector6 baseline_ = Vector6::Zero();  // the drive returns to it
  Vector6 rest_ = Vector6::Zero();      // part of the drive at the stop that the trend does not
                                        // explain
  Vector6 noise_ = Vector6::Zero();     // as a share of the present force and torque
  double keep_ = 0, kick_ = 0;          // coefficients of the noise
  Vector3 speed_ = Vector3::Zero(), moved_ = Vector3::Zero();  // speed and displacement of the
                                                               // intended position
  double speed_keep_ = 0, speed_kick_ = 0;
  FractionalDelay<Vector6, 1024> reflex_;
  FractionalDelay<Vector3, 1024> sight_;
};

// Behaves like the recorded operator until Begin, so that a saved state can be loaded. After Begin,
// this class behaves like the estimate of the recorded operator. The estimate never uses the
// recorded operator's state.
class EstimatedOperator final : public Operator {
 public:
  // `recorded` is the operator whose state the saved states contain, or null if they contain no
  // state of an operator.
  explicit EstimatedOperator(std::unique_ptr<Operator> recorded) : recorded_(std::move(recorded)) {}

  // From the next step on, the estimate replaces the recorded operator.
  void Begin(std::span<const TickRecord> past, double record_step, const IntentModel& intent,
             const OperatorDraw& draw);
  // From the next step on, the recorded operator acts again.
  void UseRecorded() noexcept { estimated_ = false; }

  void Step(const OperatorInput& input, OperatorOutput* output) noexcept override;
  void Reset() noexcept override;
  void Archive(StateArchive& a) noexcept override;
  const EstimatedHand& hand(std::size_t i) const { return hands_[i]; }

 private:
  std::unique_ptr<Operator> recorded_;
  std::array<EstimatedHand, kHands> hands_;
  double mass_ = 0, step_ = 0.001;
  bool estimated_ = false;
};

}  // namespace predictor
