// The program that runs on the robot's controller while the driver is connected. This program is
// the last stage before the arm, and stops the arm if all other stages have failed.
#pragma once

#include <cstdint>
#include <string>

namespace predictor {

// The state of the program, which the second output register contains.
enum class UrScriptState : std::int32_t {
  kReady = 1,     // the program runs but has received nothing from the tick; the arm stands still
  kFollows = 2,   // the program receives the counter; the arm stands still or follows
  kStopping = 3,  // the program brakes as commanded and then follows again
  kEnded = 4,     // the counter stopped or never changed: the program brakes and ends
};

struct UrScriptOptions {
  double cycle = 0.002;      // cycle of the controller [s]
  double acceleration = 20;  // acceleration of the leading joint in speedj [rad/s²]
  double deceleration = 10;  // deceleration of the leading joint in stopj [rad/s²]
  int first_register = 24;   // first register used; see below
};

// With r the first register:
//   input_double_register_r … r+5   joint velocities [rad/s]
//   input_int_register_r            counter: a different number each time
//   input_int_register_r+1          1: follow the velocities, 0: stand still
//   output_int_register_r           the counter that was last seen
//   output_int_register_r+1         UrScriptState
// The program waits for the counter to change (for half a minute). From then on, the program brakes
// and ends if the counter is constant for SilentCycles. The arm moves again only after the program
// has been sent again.
std::string UrScript(const UrScriptOptions& options);

// Number of cycles without a new counter after which the program brakes.
int UrSilentCycles(double cycle);

// Returns the largest time from the arrival of the last counter to the first braking cycle [s].
double UrWatchdog(double cycle);

}  // namespace predictor
