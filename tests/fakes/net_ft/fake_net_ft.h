// A force/torque sensor that answers RDT, as ATI's and OnRobot's do.
#pragma once

#include <memory>

#include "fakes/far_end.h"
#include "fakes/kinds.h"

namespace predictor {

// Options: "onrobot" (else ATI), "rate=HZ" (7000 at most, 1000 by default), "counts=N" a newton and
// a newton metre (1e6; OnRobot: 1e4 and 1e5), "first=N" the first sequence number.
//
// Do: "saturate", "status HEX", "freeze" (the sequence goes on, the payload stays), "silent",
// "short" and "long" (datagrams a byte short, or long), "repeat" (the last number for ever), "back"
// (by 50 numbers), "skip" (three of them), "well" (all that lasts over).
std::unique_ptr<FakeDevice> MakeFakeNetFt(const FakeOptions& options);

}  // namespace predictor
