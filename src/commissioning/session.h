// Conducts the dialogue with a person at a terminal next to the arms, and controls the timing of a
// session.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "commissioning/station.h"
#include "devices/wire/network.h"

namespace predictor::commissioning {

// The interface for messages to the person and for the keys that the person presses.
class Person {
 public:
  virtual ~Person() = default;
  virtual void Show(const std::string& line) = 0;
  // Returns a key that was pressed since the last call, or 0 if no key was pressed. It never waits.
  // If several keys are buffered, the session returns one per step, which is too fast for a
  // HeldKey.
  virtual char Key() = 0;
};

inline constexpr char kEnter = '\n';
inline constexpr char kGiveUp = 'q';

class Session {
 public:
  static constexpr double kStep = 0.001;  // [s]

  // All arguments must outlive the session.
  Session(Network* network, Person* person, std::vector<Station*> stations)
      : network_(network), person_(person), stations_(std::move(stations)) {}

  // Sets a function for a watchdog, which is called in each step before the arms are read. `moves`
  // is true if one of the arms moves. The function returns the reason why no arm may continue to
  // move, or "" if the arms may move.
  void OnStep(std::function<std::string(bool moves)> step) { on_step_ = std::move(step); }

  double Now() const { return 1e-9 * static_cast<double>(network_->Now()); }
  // Returns the scheduled time of the last step [s]. Even if the step was late, this time is a
  // whole number of step durations.
  double due() const { return 1e-9 * static_cast<double>(due_); }
  void Show(const std::string& line) { person_->Show(line); }

  // Waits for the next millisecond of the clock, reads all arms and commands the arms to rest. This
  // function and the functions below throw DeviceError for a fault of a device, and InputError if
  // the person gives up.
  void Step();
  // Does the same as Step(), except that one arm receives the joint velocities [rad/s] that
  // `command` computes from the latest reading. If `command` throws an exception, this function
  // passes the exception on. A caller that moves an arm must always bring this arm to rest with
  // BringToRest.
  void Step(Station* moving, const std::function<JointVector()>& command);
  // Brings the arm to rest from its last commanded velocities. The fastest joint decelerates by
  // `deceleration` [rad/s²], and the others in proportion. Waits until the joints are at rest, and
  // ends the motion. This function does not ask the person anything and does not throw. Returns the
  // outcome as text for the person.
  std::string BringToRest(Station* moving, double deceleration);
  // Returns the key that was pressed in the last step, or 0 if no key was pressed.
  char key() const { return key_; }

  // Waits until the person presses one of the keys.
  char Ask(const std::string& prompt, const std::string& keys);

 private:
  std::string Wait(bool moves);

  Network* network_;
  Person* person_;
  std::function<std::string(bool moves)> on_step_;
  enum class Rest { kRests, kMoves, kSilent };  // at rest; still moving; not accepting commands
  Rest SlowDown(Station* moving, double deceleration, double* time);
  Rest AwaitRest(Station* moving);

  std::vector<Station*> stations_;
  JointVector commanded_;  // last command to the moving arm [rad/s]
  std::uint64_t due_ = 0;  // scheduled start of the current step [ns]
  char key_ = 0;
};

}  // namespace predictor::commissioning
