// Counts heap allocations of code that was not compiled for it. It is for a trial, not for a run.
#pragma once

#include <cstdint>

namespace predictor {

// Counts, from now on and for the rest of this process, the calls of malloc, calloc, realloc, free
// and their aligned variants (therefore also of operator new) by every library that is loaded now.
// Throws InputError if this system does not allow it.
void BeginAllocationCount();
// Returns the number of calls by this thread so far.
std::int64_t AllocationCalls() noexcept;

}  // namespace predictor
