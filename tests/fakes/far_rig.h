// The rig at the far end: its arms, sensors, handles and the scenario's virtual operator, with
// places for the fakes that stand for its controllers.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fakes/far_end.h"
#include "rig/rig.h"
#include "scenario/scenario.h"

namespace predictor {

class FarRig {
 public:
  // The arms are parked so that their handles are a little beside the virtual ones, or as `start`
  // changes that. Throws InputError.
  using Start = std::function<void(std::array<JointVector, kHands>*)>;
  explicit FarRig(const Scenario& scenario, const Start& start = nullptr);

  // A place on the arm of a hand, for a controller or a sensor; lives as long as this.
  Mechanics* Hang(int hand);

  // One millisecond: the arms obey what was left in the places, then these are filled in anew.
  void Step();

  // What a controller and a sensor read beside the truth, from now on: joints [rad] (empty: none),
  // and a wrench about S [N], [N·m].
  void Disturb(int hand, const JointVector& q, const Wrench& F_S);
  // What is more and more added to the wrench, from now on [N/s], [N·m/s].
  void Drift(int hand, const Wrench& rate);

  // From now on this arm obeys later by so many milliseconds, at most kMostLate.
  static constexpr std::size_t kMostLate = 64;
  void Hinder(int hand, std::size_t milliseconds);
  // A person who leads an arm by hand to these joints [rad], whatever its controller wants; empty:
  // nobody does any more.
  void Lead(int hand, const JointVector& q);
  // The arm that is led is there, and rests.
  bool Led(int hand) const;
  // A person who presses on the handle, from now on: force at H, axes of W [N].
  void Press(int hand, const Vector3& F_W);
  // The sensor's axes as they are wired: a reading is `axes` times what it should be.
  void Wire(int hand, const Matrix3& axes);
  JointVector joints(int hand) const;  // [rad]

  // What the person at the handles sees: whether the run is on.
  void SetRunning(bool running);

  // Whole cycles of every controller, the slowest's of a CB3 [ms].
  static constexpr std::size_t kWindow = 8;
  // What the true handles did since Mark().
  struct Motion {
    double rest_after = 0;  // when the last of them fell below 1 mm/s, its turning too [s]
    double fastest = 0;     // [m/s]
    double moving = 0;      // the same with its turning, as HandleSpeed [m/s]
    double hardest = 0;     // largest change of a velocity over a millisecond, over it [m/s²]
    double distance = 0;    // way of the one that went further [m]
    double joint = 0;       // fastest joint [rad/s]
    double braking = 0;  // largest change of what a controller told a joint, over kWindow [rad/s²]
  };
  void Mark();
  const Motion& motion() const { return motion_; }

  const Rig& rig() const { return *rig_; }
  // What a controller has told its arm last [rad/s].
  const JointVector& told(int hand) const { return told_[static_cast<std::size_t>(hand)].front(); }
  // Joints and their velocities, for a person.
  std::string ToString();

 private:
  struct Place {
    int hand;
    std::unique_ptr<Mechanics> mechanics;
  };
  struct Disturbance {
    JointVector q;
    Wrench F_S = Wrench::Zero();
    Wrench drifted = Wrench::Zero(), drift = Wrench::Zero();
  };
  // What a person does to an arm, and how its sensor is wired.
  struct ByHand {
    JointVector lead;
    Vector3 press = Vector3::Zero();
    Matrix3 axes = Matrix3::Identity();
    Pose X_HS;  // of the sensor in the handle
  };
  void Fill();
  Wrench Pressed(std::size_t hand) const;
  void Watch();

  std::unique_ptr<Rig> rig_;
  std::vector<Place> places_;
  std::array<std::deque<JointVector>, kHands> told_;  // the last commands, the newest first
  std::array<std::size_t, kHands> late_ = {};
  std::array<Disturbance, kHands> disturbances_;
  std::array<ByHand, kHands> by_hand_;
  DeviceSample sample_;  // the last
  Motion motion_;
  double since_mark_ = 0;  // [s]
  std::array<Vector3, kHands> v_ = {Vector3::Zero(), Vector3::Zero()};
  std::array<double, kHands> way_ = {};
  bool running_ = false;
  double run_time_ = 0;  // [s]
};

}  // namespace predictor
