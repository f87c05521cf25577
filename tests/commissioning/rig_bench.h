// An arm of the rig that serves as the station of a session in virtual time, and the people at this
// arm.
#pragma once

#include <memory>
#include <string>

#include "commissioning/calibrate.h"
#include "commissioning/rig_station.h"

namespace predictor::commissioning {

// An arm, its station and the time that they share.
struct Bench {
  explicit Bench(const Scenario& s = ArmScenario(1), double rate = 1000)
      : scenario(s),
        hand(scenario, &time, ArmStart(1)[0], rate),
        station(0, MachineArmOf(scenario), std::make_unique<RigDriver>(&hand), nullptr) {}

  const JointVector& q() const { return hand.sample().q; }

  VirtualTime time;
  Scenario scenario;
  RigHand hand;
  Station station;
};

// A person who guides the arm to given joint angles. Lead returns true once the arm rests at these
// angles.
class Leader {
 public:
  explicit Leader(RigHand* hand) : hand_(hand) {}
  bool Lead(const JointVector& goal) {
    const JointVector way = goal - hand_->sample().q;
    if (way.norm() > 2e-4) {
      steps_ = 0;
      hand_->Lead((4 * way).cwiseMax(-1.5).cwiseMin(1.5));
      return false;
    }
    hand_->Lead(JointVector::Zero(way.size()));
    return ++steps_ > 300;
  }

 private:
  RigHand* hand_;
  int steps_ = 0;
};

// A person who holds the key. The terminal reports this as 30 letters a second after an initial
// pause.
class Holder {
 public:
  explicit Holder(const VirtualTime* time) : time_(time) {}
  bool holds = false;
  // `last` is the latest message, as ScriptedPerson passes it.
  char Key(const std::string& last) {
    if (last.find("then press Enter") != std::string::npos) return kEnter;
    const double now = 1e-9 * static_cast<double>(time_->Now());
    if (!holds) {
      begin_ = -1;
      return 0;
    }
    if (begin_ < 0) {
      begin_ = now;
      next_ = now + 0.5;
      return kSwingKey;
    }
    if (now < next_) return 0;
    next_ += 0.033;
    return kSwingKey;
  }

 private:
  const VirtualTime* time_;
  double begin_ = -1, next_ = 0;
};

// Returns a chirp that is short enough for a test.
inline SwingOptions Short() {
  SwingOptions options;
  options.chirp.time = 2.5;
  return options;
}

}  // namespace predictor::commissioning
