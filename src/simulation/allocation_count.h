// Counts the heap allocations of code that was not compiled for this purpose: the libraries of
// controllers. A counted call of malloc costs one addition more than an ordinary one.
#pragma once

#include <cstdint>

namespace predictor {

// From now on, counts the calls of malloc, calloc, realloc, free and their aligned variants
// (therefore also of operator new) by every library that is loaded now. Counting lasts until the
// process ends. A further call of this function adds the libraries that have been loaded since.
// Throws InputError if this system does not allow the counting. May be called by any thread, but
// not in the tick.
void BeginAllocationCount();
// Returns the number of calls that this thread has made since counting began. Reads one variable of
// the thread.
std::int64_t AllocationCalls() noexcept;

}  // namespace predictor
