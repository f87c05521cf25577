// A force/torque sensor that speaks RDT, as the sensors of ATI and OnRobot do.
#pragma once

#include <memory>

#include "fakes/far_end.h"
#include "fakes/kinds.h"

namespace predictor {

// Options: "onrobot" (default: ATI), "rate=HZ" (at most 7000, default 1000), "counts=N" per newton
// and newton metre (1e6; OnRobot: 1e4 and 1e5), "first=N": the first sequence number.
//
// Do: "saturate", "status HEX", "freeze" (the sequence continues, the payload stays), "silent",
// "short" and "long" (datagrams one byte too short or too long), "repeat" (the last number
// permanently), "back" (by 50 numbers), "skip" (three numbers), "well" (ends all lasting faults).
std::unique_ptr<FakeDevice> MakeFakeNetFt(const FakeOptions& options);

}  // namespace predictor
