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

// The input of an enabling device, if there is one.
struct EnablingContact {
  const Station* station = nullptr;  // read in each step; null: a key is held instead
  int digital_input = 0;
};

// A held key lets the arm move. If there is an enabling device, the held device lets the arm move
// once the key has been pressed. Any other key revokes consent. A device that is pressed from the
// beginning, or that is still pressed after another key, may be jammed. Such a device counts only
// after it has been released.
class Consent {
 public:
  Consent(char key, const EnablingContact& contact) : key_(key), held_(key), contact_(contact) {}
  // Call this in each step. `key` is a newly received key, or 0. `now` is in [s].
  bool Update(char key, double now);
  // From `now` [s] on, there is no consent until the key has been silent and the device has been
  // released.
  void Revoke(double now);
  // Returns the action by which the person consents, according to the last Update, such as "hold
  // s".
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

// Thrown if the arm must stop because readings or ticks are late. Such a delay may end immediately.
class HeldUp : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

class MotionWatch {
 public:
  // Above these limits, or above the machine's limits if they are lower, the watch assumes that a
  // hand is on the handle.
  static constexpr double kTouch = 15, kTouchTorque = 3;  // [N], [N·m]
  // If the wrench is above these limits, the motion does not start.
  static constexpr double kFree = 5, kFreeTorque = 1;  // [N], [N·m]

  // Throws InputError if the arm's limits do not fit its model, and DeviceError if the payload in
  // its controller differs from the file.
  MotionWatch(const Station& station, const MachineLimits& limits);

  // Asks the person to take the hands off.
  void Tare(Session* session) { feeler_.Tare(session); }
  // Call this at rest. Throws InputError if something presses on the handle.
  void Begin();
  // Call this in each step after reading the arm. `due` [s] is the scheduled time of the session.
  // If a condition would stop a run, throws an error with a sentence for the person: InputError for
  // people's actions, DeviceError for devices, or HeldUp for delays.
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
