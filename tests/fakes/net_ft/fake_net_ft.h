// A force/torque sensor that uses RDT, as the sensors of ATI and OnRobot do.
#pragma once

#include <memory>

#include "fakes/far_end.h"
#include "fakes/kinds.h"

namespace predictor {

// The options are "onrobot" (default: ATI), "rate=HZ" (at most 7000, default 1000), "counts=N" per
// newton and newton metre (1e6; OnRobot: 1e4 and 1e5), and "first=N" for the first sequence number.
//
// Do accepts "saturate", "status HEX", "freeze" (the sequence continues, but the payload stays),
// "silent", "short" and "long" (datagrams one byte too short or too long), "repeat" (sends the last
// number permanently), "back" (by 50 numbers), "skip" (three numbers), and "well" (ends all lasting
// faults).
std::unique_ptr<FakeDevice> MakeFakeNetFt(const FakeOptions& options);

}  // namespace predictor
