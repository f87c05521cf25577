// The rig behind the fakes: arms, sensors, handles, the scenario's simulated operator, and places
// for the fakes of its controllers.
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
  // Parks the arms so that their handles are close to the virtual ones. `start` may change the
  // joints. Throws InputError.
  using Start = std::function<void(std::array<JointVector, kHands>*)>;
  explicit FarRig(const Scenario& scenario, const Start& start = nullptr);

  // Adds a place for a controller or a sensor on the arm of a hand. The place is valid as long as
  // this object exists.
  Mechanics* Hang(int hand);

  // Lets one millisecond pass. The arms follow the commands in the places. The places then receive
  // new samples.
  void Step();

  // From now on, adds errors to the readings of a controller and a sensor. One error is added to
  // the joint angles [rad]; if it is empty, the angles have no error. The other error is a wrench
  // about S [N], [N·m].
  void Disturb(int hand, const JointVector& q, const Wrench& F_S);
  // From now on, adds a drift to the wrench [N/s], [N·m/s].
  void Drift(int hand, const Wrench& rate);

  // From now on, delays the commands to this arm by this number of milliseconds, at most kMaxLate.
  static constexpr std::size_t kMaxLate = 64;
  void Hinder(int hand, std::size_t milliseconds);
  // A person guides an arm to these joints [rad], whatever its controller commands. If the joints
  // are empty, the person lets go.
  void Lead(int hand, const JointVector& q);
  // Returns whether the arm that a person guides has arrived.
  bool Led(int hand) const;
  // From now on, a person pushes the handle with this force at H [N], in the axes of W.
  void Press(int hand, const Vector3& F_W);
  // Connects the sensor's axes incorrectly, so that a reading is `axes` times the correct one.
  void Wire(int hand, const Matrix3& axes);
  JointVector joints(int hand) const;  // [rad]

  // Reports to the simulated operator whether the run is active.
  void SetRunning(bool running);

  // A multiple of every controller's cycle [ms]. The longest cycle is that of a CB3.
  static constexpr std::size_t kWindow = 8;
  // Motion of the true handles since Mark().
  struct Motion {
    double rest_after = 0;  // last time at which a handle moved or rotated faster than 1 mm/s [s]
    double fastest = 0;     // [m/s]
    double moving = 0;      // including the rotation, as in HandleSpeed [m/s]
    double hardest = 0;     // largest acceleration of a handle over a millisecond [m/s²]
    double distance = 0;    // distance of the handle that moved farther [m]
    double joint = 0;       // fastest joint [rad/s]
    double braking = 0;     // largest deceleration that a controller commanded to a joint, over
                            // kWindow [rad/s²]
  };
  void Mark();
  const Motion& motion() const { return motion_; }

  const Rig& rig() const { return *rig_; }
  // Returns the last command of a controller to its arm [rad/s].
  const JointVector& commanded(int hand) const {
    return commanded_[static_cast<std::size_t>(hand)].front();
  }
  // Returns the joints and their velocities as text.
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
  // What a person does to an arm, and the wiring of its sensor.
  struct ByHand {
    JointVector lead;
    Vector3 press = Vector3::Zero();
    Matrix3 axes = Matrix3::Identity();
    Pose X_HS;  // pose of the sensor in the handle
  };
  void Fill();
  Wrench Pressed(std::size_t hand) const;
  void Watch();

  std::unique_ptr<Rig> rig_;
  std::vector<Place> places_;
  std::array<std::deque<JointVector>, kHands> commanded_;  // the latest commands, newest first
  std::array<std::size_t, kHands> late_ = {};
  std::array<Disturbance, kHands> disturbances_;
  std::array<ByHand, kHands> by_hand_;
  DeviceSample sample_;  // the latest sample
  Motion motion_;
  double since_mark_ = 0;  // [s]
  std::array<Vector3, kHands> v_ = {Vector3::Zero(), Vector3::Zero()};
  std::array<double, kHands> way_ = {};
  bool running_ = false;
  double run_time_ = 0;  // [s]
};

}  // namespace predictor
