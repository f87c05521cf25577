// What watches over an arm that commissioning moves, hands off: the guard and the monitor of a run,
// and the consent of a person.
#pragma once

#include <string>

#include "commissioning/feeler.h"
#include "core/held_key.h"
#include "safety/guard.h"
#include "safety/monitor.h"
#include "scenario/machine.h"

namespace predictor {

// Where an enabling device is wired to, if there is one.
struct EnablingContact {
  const Station* station = nullptr;  // read each step; null: a key is held instead
  int digital_input = 0;
};

// A key that is held lets the arm move; where there is an enabling device, the device that is held,
// once the key was touched. Any other key takes it back. A device that is pressed already when it
// is first seen, or still after another key, counts once it has been let go: it may be jammed.
class Consent {
 public:
  Consent(char key, const EnablingContact& contact) : key_(key), held_(key), contact_(contact) {}
  // Each step: a key that came now, or 0; now [s].
  bool Update(char key, double now);
  // From now on [s] it is none until the key has been silent, and the device was let go.
  void Revoke(double now);
  // What the person has to do for it, as of the last Update: "hold s".
  std::string Wanted() const;

 private:
  bool Held(char key, double now);

  char key_;
  HeldKey held_;
  EnablingContact contact_;
  bool was_released_ = false, pressed_ = false, granted_ = false, revoked_ = false;
  bool repeats_ = false;     // the key came, and it is not long ago: another letter is no touch
  double letter_ = -1e9;     // its last [s]
  double silent_since_ = 0;  // while it is revoked [s]
};

// The arm must stop for what may be over at once: readings or ticks that came late.
class HeldUp : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

class MotionWatch {
 public:
  // A hand on the handle is seen by so much, or by the machine's limits where they are less.
  static constexpr double kTouch = 15, kTouchTorque = 3;  // [N], [N·m]
  // Before it moves nothing may press on the handle by more.
  static constexpr double kFree = 5, kFreeTorque = 1;  // [N], [N·m]

  // Throws InputError: the arm's limits do not fit its model; DeviceError: its controller was told
  // of another payload than the file.
  MotionWatch(const Station& station, const MachineLimits& limits);

  // Asks for hands off.
  void Tare(Session* session) { feeler_.Tare(session); }
  // From rest. Throws InputError: something presses on the handle.
  void Begin();
  // Each step, after the arm was read; due [s]: of the session. Throws what a run would stop for,
  // as a sentence for a person: InputError what people do, DeviceError what devices do, HeldUp.
  void Check(double due);
  // What of a command [rad/s] may be sent.
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
  double last_ = 0;  // Check, when it was due [s]; 0: none yet
};

}  // namespace predictor
