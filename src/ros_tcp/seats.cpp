#include "ros_tcp/seats.h"

#include <algorithm>

namespace predictor::ros_tcp {
namespace {

constexpr std::uint32_t kLoopback = 127u << 24;

std::uint32_t SourceOf(std::uint32_t address) {
  return address >> 24 == kLoopback >> 24 ? kLoopback : address;
}

}  // namespace

Seating SeatFor(std::uint32_t address, const std::vector<Seat>& taken, const Seats& seats) {
  const auto is_own = [source = SourceOf(address)](const Seat& seat) {
    return SourceOf(seat.address) == source;
  };
  const auto own = static_cast<std::size_t>(std::count_if(taken.begin(), taken.end(), is_own));
  const bool share_taken = own >= seats.per_address;
  if (!share_taken && taken.size() < seats.total) return {Seating::Kind::kFree};
  const auto victim = std::find_if(taken.begin(), taken.end(), [&](const Seat& seat) {
    return seat.idle && (!share_taken || is_own(seat));
  });
  if (victim == taken.end()) return {Seating::Kind::kRefuse};
  return {Seating::Kind::kReplace, static_cast<std::size_t>(victim - taken.begin())};
}

}  // namespace predictor::ros_tcp
