// Monitors an arm that commissioning moves with hands off. MotionWatch uses the guard and the
// monitor of a run, and the consent of a person.
#pragma once

#include <string>

#include "commissioning/feeler.h"
#include "core/held_key.h"
#include "safety/guard.h"
#include "safety/monitor.h"
#include "scenario/machine.h"

namespace predictor::commissioning {

// The input of the enabling device, if the machine has such a device.
struct EnablingContact {
  const Station* station = nullptr;  // read in each step; null: a key is held instead
  int digital_input = 0;
};

// The arm may move while the key is held. If there is an enabling device, the key must be pressed
// once, and the arm may then move while the device is held. Any other key revokes consent. A device
// that is pressed from the beginning, or that is still pressed after another key, may be jammed.
// Such a device counts as held only after a release.
class Consent {
 public:
  Consent(char key, const EnablingContact& contact) : key_(key), held_(key), contact_(contact) {}
  // Call this function in each step. `key` is a newly received key, or 0. `now` is in [s].
  bool Update(char key, double now);
  // Revokes the consent at the time `now` [s]. The person cannot consent again until no key has
  // arrived for some time and the device has been released.
  void Revoke(double now);
  // Returns the action with which the person can consent, such as "hold s". The action depends on
  // the last call of Update.
  std::string Wanted() const;

 private:
  bool Held(char key, double now);

  char key_;
  HeldKey held_;
  EnablingContact contact_;
  bool was_released_ = false, pressed_ = false, granted_ = false, revoked_ = false;
  bool repeats_ = false;     // the key was received recently: another letter only repeats it
  double letter_ = -1e9;     // time at which the key was last received [s]
  double silent_since_ = 0;  // while consent is revoked: start of the silence [s]
};

// The error that is thrown if the arm must stop because readings or ticks are late. Such a delay
// may end immediately.
class HeldUp : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

class MotionWatch {
 public:
  // If a reading exceeds these limits, or the machine's limits where the machine's limits are
  // lower, the watch assumes that a hand is on the handle.
  static constexpr double kTouch = 15, kTouchTorque = 3;  // [N], [N·m]
  // If the wrench is above these limits, the motion does not start.
  static constexpr double kFree = 5, kFreeTorque = 1;  // [N], [N·m]

  // Throws InputError if the arm's limits do not fit its model, and DeviceError if the payload in
  // its controller differs from the file.
  MotionWatch(const Station& station, const MachineLimits& limits);

  // Asks the person to take the hands off the handle.
  void Tare(Session* session) { feeler_.Tare(session); }
  // Call this at rest. Throws InputError if something presses on the handle.
  void Begin();
  // Call this in each step after reading the arm. `due` [s] is the scheduled time of the session's
  // current step. If a condition would stop a run, the function throws an error with a sentence for
  // the person. The error is InputError if a person caused the condition, DeviceError if a device
  // caused it, and HeldUp if a delay caused it.
  void Check(double due);
  // Returns the permitted part of a command [rad/s].
  JointVector Bounded(const JointVector& v);

 private:
  MonitorInput Input() const;

  const Station& station_;
  std::size_t hand_;
  Feeler feeler_;
  Monitor monitor_;
  Guard guard_;
  std::array<JointVector, kHands> lower_, upper_, velocity_;
  DeviceSample sample_;
  HandWrench wrench_;
  Status sensing_;
  double last_ = 0;  // scheduled time of the last Check [s]; 0: none yet
};

}  // namespace predictor::commissioning
