// Counts what a piece of code takes from and gives back to the heap.
#pragma once

#include <cstdint>

namespace predictor::test {

// Counts the calls of malloc, calloc, realloc, free and their aligned kin (so operator new, Eigen
// and libraries too) that the current thread makes from here on. Link the library test_support.
//
//   AllocationGuard guard;
//   arm.Tick();
//   EXPECT_EQ(guard.count(), 0);
//
// A sanitizer has an allocator of its own: then kIsActive is false and count() stays 0. Begin such
// a test with PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD(), so that it says so.
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
  static std::int64_t Calls();  // of this thread, since it began
  std::int64_t start_;
};

}  // namespace predictor::test

#define PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD()                            \
  do {                                                                       \
    if (!predictor::test::AllocationGuard::kIsActive) {                      \
      GTEST_SKIP() << "Allocations cannot be counted under this sanitizer."; \
    }                                                                        \
  } while (false)
