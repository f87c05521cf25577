// A person at a terminal beside the arms, and time that passes meanwhile.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "commissioning/station.h"
#include "devices/wire/network.h"

namespace predictor {

// What is told to the person, and the keys that the person presses.
class Person {
 public:
  virtual ~Person() = default;
  virtual void Tell(const std::string& line) = 0;
  // A key that was pressed since the last call; 0: none. Never waits. Keys that stood in line come
  // one a step, which is too quick for a HeldKey.
  virtual char Key() = 0;
};

inline constexpr char kEnter = '\n';
inline constexpr char kGiveUp = 'q';

class Session {
 public:
  static constexpr double kStep = 0.001;  // [s]

  // All outlive the session.
  Session(Network* network, Person* person, std::vector<Station*> stations)
      : network_(network), person_(person), stations_(std::move(stations)) {}

  // Called each step, before the arms are read: whether one of them moves. For a watchdog.
  void OnStep(std::function<void(bool moves)> step) { on_step_ = std::move(step); }

  double Now() const { return 1e-9 * static_cast<double>(network_->Now()); }
  // When the last step was due: whole steps apart, however late it came [s].
  double due() const { return 1e-9 * static_cast<double>(due_); }
  void Tell(const std::string& line) { person_->Tell(line); }

  // The next millisecond by the clock, in which all arms stand and are read. Throws DeviceError, as
  // the next ones; InputError if the person gives up.
  void Step();
  // The same, in which one arm is told the joint velocities [rad/s] that `command` makes of what
  // was just read; what that throws is passed on. Whoever moves an arm brings it to rest, whatever
  // happens: by BringToRest.
  void Step(Station* moving, const std::function<JointVector()>& command);
  // Takes the arm from the velocities that it was told last to rest: each joint as much slower
  // every step as the fastest one is by `deceleration` [rad/s²]. Waits until its joints stand, and
  // lets it leave its motion. Asks the person nothing, and does not throw; returns how it went, for
  // the person.
  std::string BringToRest(Station* moving, double deceleration);
  // The key of the last step; 0: none.
  char key() const { return key_; }

  // Waits for one of the keys.
  char Ask(const std::string& prompt, const std::string& keys);

 private:
  void Wait(bool moves);

  Network* network_;
  Person* person_;
  std::function<void(bool moves)> on_step_;
  enum class Rest { kRests, kMoves, kSilent };  // it stands; it does not; it takes no commands
  Rest SlowDown(Station* moving, double deceleration, double* time);
  Rest AwaitRest(Station* moving);

  std::vector<Station*> stations_;
  JointVector told_;       // to the arm that moves, last [rad/s]
  std::uint64_t due_ = 0;  // when the step under way began, or should have [ns]
  char key_ = 0;
};

}  // namespace predictor
