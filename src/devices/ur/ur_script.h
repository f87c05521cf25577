// The program that runs on the robot's controller while the driver has it: the last link of the
// chain, and the one that stops the arm when all before it are dead.
#pragma once

#include <cstdint>
#include <string>

namespace predictor {

// What the program does, by the second output register.
enum class UrScriptState : std::int32_t {
  kReady = 1,     // it runs and has heard nothing of the tick; the arm stands
  kFollows = 2,   // it hears the counter; the arm stands or follows
  kStopping = 3,  // it brakes as told, then follows again
  kEnded = 4,     // the counter stood still, or never began to move: it brakes, and is over
};

struct UrScriptOptions {
  double cycle = 0.002;      // of the controller [s]
  double acceleration = 20;  // of the leading joint, in speedj [rad/s²]
  double deceleration = 10;  // of the leading joint, in stopj [rad/s²]
  int first_register = 24;   // of those that it uses; see below
};

// With r the first register:
//   input_double_register_r … r+5   joint velocities [rad/s]
//   input_int_register_r            counter: anything, but another number each time
//   input_int_register_r+1          1: follow the velocities, 0: stand
//   output_int_register_r           the counter as it was last seen
//   output_int_register_r+1         UrScriptState
// The program waits for the counter to move (for half a minute). From then on a counter that stands
// still for SilentCycles ends it: it brakes, and nothing but sending it anew moves the arm again.
std::string UrScript(const UrScriptOptions& options);

// Cycles without a new counter after which the program brakes.
int UrSilentCycles(double cycle);

// From the last counter that arrives to the first cycle that brakes, at most [s].
double UrWatchdog(double cycle);

}  // namespace predictor
