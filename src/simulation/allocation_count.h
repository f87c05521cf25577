// Counts the heap allocations of code that was not compiled for this purpose. Counting is meant for
// a trial, not for a run.
#pragma once

#include <cstdint>

namespace predictor {

// From now on, counts the calls of malloc, calloc, realloc, free and their aligned variants
// (therefore also of operator new) by every library that is loaded now. Counting lasts until the
// process ends. Throws InputError if this system does not allow the counting.
void BeginAllocationCount();
// Returns the number of calls that this thread has made since counting began.
std::int64_t AllocationCalls() noexcept;

}  // namespace predictor
