// Counts the heap allocations and deallocations of a piece of code.
#pragma once

#include <cstdint>

namespace predictor::test {

// Counts the calls of malloc, calloc, realloc, free and their aligned variants (therefore also
// operator new, Eigen and libraries) that the current thread makes from now on. Link the library
// test_support.
//
//   AllocationGuard guard;
//   arm.Tick();
//   EXPECT_EQ(guard.count(), 0);
//
// A sanitizer has its own allocator. In a build with a sanitizer, kIsActive is therefore false, and
// count() stays 0. A test that uses the guard must begin with
// PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD(), so that a build without the guard reports the test as
// skipped.
class AllocationGuard {
 public:
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static constexpr bool kIsActive = false;
#else
  static constexpr bool kIsActive = true;
#endif

  AllocationGuard() : start_(Calls()) {}
  std::int64_t count() const { return Calls() - start_; }

 private:
  static std::int64_t Calls();  // calls by this thread since it began
  std::int64_t start_;
};

}  // namespace predictor::test

#define PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD()                            \
  do {                                                                       \
    if (!predictor::test::AllocationGuard::kIsActive) {                      \
      GTEST_SKIP() << "Allocations cannot be counted under this sanitizer."; \
    }                                                                        \
  } while (false)
