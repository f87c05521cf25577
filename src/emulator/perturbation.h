// Displaces the real handles by a few millimetres while a person holds them. The impedance of the
// person's arm can then be identified from the recording (docs/how-to/identify-arm.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/archive.h"
#include "core/messages.h"
#include "core/random.h"
#include "scenario/scenario.h"

namespace predictor {

// A motion along a line that ends at rest, with continuous position, velocity and acceleration. The
// motion is a polynomial of fifth order, which has minimum jerk if it starts from rest (Flash &
// Hogan 1985).
class QuinticMotion {
 public:
  struct Point {
    double position = 0, velocity = 0, acceleration = 0;  // [m], [m/s], [m/s²]
    void Archive(StateArchive& a) noexcept { a(position, velocity, acceleration); }
  };
  QuinticMotion() = default;
  // Reaches `goal` [m] after `duration` [s].
  QuinticMotion(const Point& from, double goal, double duration) noexcept
      : from_(from), goal_(goal), duration_(duration) {}

  Point At(double time) const noexcept;                   // time since its start [s]
  double duration() const noexcept { return duration_; }  // [s]
  void Archive(StateArchive& a) noexcept { a(from_, goal_, duration_); }

 private:
  Point from_;
  double goal_ = 0, duration_ = 1;
};

// The conditions that decide whether a displacement may begin or must be reversed.
struct PerturbationInput {
  double run_time = 0;  // [s]
  Hands present;
  std::array<HandWrench, kHands> wrench;
  std::array<FrameMotion, kHands> virtual_;
  bool limited = false;  // a limit of rendering acts
};

class Perturbation {
 public:
  // `margin` is the predicted stability margin of the run. `dt` is the duration of a tick [s].
  // Throws InputError if the margin is smaller than the scenario requires.
  Perturbation(const Scenario& scenario, double margin, double dt);

  // Advances the displacement by one tick of RUN. The function uses neither the heap nor a lock,
  // and does not throw.
  void Step(const PerturbationInput& input) noexcept;
  // Sets the displacement to zero. Directions and times are drawn again, because a person may
  // remember the directions and times of the last run.
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept;

  // Returns the displacement of the real handles relative to the virtual handles in W [m], and the
  // derivatives of this displacement.
  Vector3 displacement() const noexcept { return now_.position * direction_; }
  Vector3 velocity() const noexcept { return now_.velocity * direction_; }
  Vector3 acceleration() const noexcept { return now_.acceleration * direction_; }

 private:
  enum class Phase : std::uint8_t { kWait, kOut, kHold, kBack };
  bool MayBegin(const PerturbationInput& input) const noexcept;
  void Begin() noexcept;
  void TakeBack() noexcept;
  void Wait(double run_time) noexcept;

  std::optional<PerturbationSpec> spec_;  // absent: there are no displacements
  double dt_ = 0.001;                     // [s]
  double expected_force_ = 0;             // force of a displacement on a hand [N]
  std::array<Vector3, 2> plane_ = {Vector3::UnitX(), Vector3::UnitY()};  // axes of the plane

  RandomStream random_;
  // The numbers of the directions. The last `left_` numbers in this list have not been used in this
  // round.
  std::array<std::uint8_t, 16> order_{};
  int left_ = 0;
  Phase phase_ = Phase::kWait;
  double phase_time_ = 0;                 // time since the phase began [s]
  double earliest_ = 0;                   // start of the next displacement, run time [s]
  std::array<double, kHands> load_ = {};  // smoothed force of the hands [N]
  Vector3 direction_ = Vector3::UnitX();  // direction of the present displacement
  QuinticMotion motion_;                  // along direction_
  QuinticMotion::Point now_;
};

}  // namespace predictor
