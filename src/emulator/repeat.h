// A run once more, from what its records say was put into it.
#pragma once

#include "core/record.h"
#include "emulator/emulator.h"

namespace predictor {

// Gives the emulator what the tick of `record` was given, and ticks. `emulator`: of the same
// scenario, after the tick before it (or with its state loaded).
void Repeat(const TickRecord& record, Emulator* emulator) noexcept;

// Whether two records of the same tick agree bit for bit, wall-clock times apart.
bool SameTick(const TickRecord& a, const TickRecord& b) noexcept;

}  // namespace predictor
