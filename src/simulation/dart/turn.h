// Functions that wait for the other process. They use the number of its last request or answer.
#pragma once

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <ctime>

namespace predictor::dart_engine {

inline constexpr int kSpins = 2000;  // before the first pause

inline std::uint32_t Load(const std::uint32_t* number) noexcept {
  return __atomic_load_n(number, __ATOMIC_ACQUIRE);
}

// Sets the number and wakes the process that waits for it.
inline void Publish(std::uint32_t* number, std::uint32_t value) noexcept {
  __atomic_store_n(number, value, __ATOMIC_RELEASE);
  syscall(SYS_futex, number, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

// Waits until the number is no longer `value`, but for at most a tenth of a second. Returns whether
// it changed.
inline bool WaitForChange(const std::uint32_t* number, std::uint32_t value) noexcept {
  for (int spin = 0; spin < kSpins; ++spin)
    if (Load(number) != value) return true;
  const timespec patience = {0, 100'000'000};
  syscall(SYS_futex, number, FUTEX_WAIT, value, &patience, nullptr, 0);
  return Load(number) != value;
}

}  // namespace predictor::dart_engine
