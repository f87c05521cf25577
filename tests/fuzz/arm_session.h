// The requirements that a driver must meet for any data from its arm.
#pragma once

#include <cmath>
#include <cstdlib>

#include "devices/arm.h"
#include "fuzz/any_peer.h"

namespace predictor {

inline constexpr int kFuzzTicks = 60;

// Runs a number of ticks. A reported fault must persist with a description, and angles and ages
// must be finite.
inline void RunArm(Arm* arm, bool moves, AnyPeer* network) {
  ArmReading reading;
  bool failed = false;
  const JointVector v = JointVector::Constant(arm->facts().joints, 0.01);
  const JointVector zero = JointVector::Zero(arm->facts().joints);
  for (int tick = 0; tick < kFuzzTicks; ++tick) {
    network->Wait(0.001);
    const bool read = arm->Read(&reading).ok();
    const bool motion = moves && tick % 20 < 15;
    const bool written = arm->Write(motion ? v : zero, motion).ok();
    if (failed && (read || written)) std::abort();
    failed = failed || !read || !written;
    if (!reading.q.allFinite() || !reading.v.allFinite() || !(reading.age >= 0)) std::abort();
    if (failed && arm->Trouble().empty()) std::abort();
  }
  arm->PowerOff(true);
}

}  // namespace predictor
