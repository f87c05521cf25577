// The hands that exist.
#pragma once

#include "core/types.h"

namespace predictor {

// A set of hands (0: left, 1: right). The loop `for (const int hand : hands)` visits its members,
// left first.
class Hands {
 public:
  constexpr Hands() = default;
  constexpr Hands(bool left, bool right) : bits_((left ? 1U : 0U) | (right ? 2U : 0U)) {}

  constexpr bool Has(int hand) const noexcept { return (bits_ >> hand & 1U) != 0; }
  constexpr void Add(int hand) noexcept { bits_ |= 1U << hand; }
  constexpr int count() const noexcept { return Has(0) + Has(1); }

  class Iterator {
   public:
    constexpr Iterator(unsigned bits, int hand) : bits_(bits), hand_(hand) { Skip(); }
    constexpr int operator*() const noexcept { return hand_; }
    constexpr Iterator& operator++() noexcept {
      ++hand_;
      Skip();
      return *this;
    }
    constexpr bool operator!=(const Iterator& other) const noexcept { return hand_ != other.hand_; }

   private:
    constexpr void Skip() noexcept {
      while (hand_ < kHands && (bits_ >> hand_ & 1U) == 0) ++hand_;
    }
    unsigned bits_;
    int hand_;
  };
  constexpr Iterator begin() const noexcept { return {bits_, 0}; }
  constexpr Iterator end() const noexcept { return {0, kHands}; }

 private:
  unsigned bits_ = 0;  // bit = hand
};

}  // namespace predictor
