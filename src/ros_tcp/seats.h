// Decides which clients of the ROS-TCP server keep their seats if there are more clients than
// seats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace predictor::ros_tcp {

struct Seat {
  std::uint32_t address = 0;  // IPv4, host byte order
  bool idle = true;           // has neither subscribed nor announced a stop
};

struct Seats {
  std::size_t total = 8;
  std::size_t per_address = 4;  // all loopback addresses count as one
};

struct Seating {
  enum class Kind { kFree, kReplace, kRefuse } kind = Kind::kFree;
  std::size_t victim = 0;  // the client that loses its seat, for kReplace
};

// Finds a seat for a new client from `address`. `taken` lists the occupied seats in the order in
// which their clients arrived. If all seats are taken, the idle client that connected first loses
// its seat. If an address already has its share of the seats, it gets another seat only from one of
// its own idle clients. A client that is not idle never loses its seat.
Seating SeatFor(std::uint32_t address, const std::vector<Seat>& taken, const Seats& seats);

}  // namespace predictor::ros_tcp
