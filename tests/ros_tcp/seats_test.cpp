#include "ros_tcp/seats.h"

#include <gtest/gtest.h>

namespace predictor::ros_tcp {
namespace {

constexpr std::uint32_t kOne = 0xC0000201, kOther = 0xC0000202;  // 192.0.2.1, 192.0.2.2
constexpr std::uint32_t kLocal = 0x7F000001;
constexpr Seats kSeats{4, 2};
using Kind = Seating::Kind;

TEST(Seats, AreGivenWhileThereAreAny) {
  EXPECT_EQ(SeatFor(kOne, {}, kSeats).kind, Kind::kFree);
  EXPECT_EQ(SeatFor(kOther, {{kOne, false}, {kOne, false}}, kSeats).kind, Kind::kFree);
}

TEST(Seats, OfTheLongestIdleClientGoToANewcomer) {
  const Seating seating =
      SeatFor(kLocal, {{kOne, false}, {kOther, true}, {kOne, true}, {kOther, false}}, kSeats);
  EXPECT_EQ(seating.kind, Kind::kReplace);
  EXPECT_EQ(seating.victim, 1u);
}

TEST(Seats, InUseAreKept) {
  EXPECT_EQ(
      SeatFor(kLocal, {{kOne, false}, {kOther, false}, {kOne, false}, {kOther, false}}, kSeats)
          .kind,
      Kind::kRefuse);
}

// A machine must not be able to use more than its share of the seats in any way.
TEST(Seats, OfOneAddressAreItsShare) {
  EXPECT_EQ(SeatFor(kOne, {{kOne, false}, {kOne, false}}, kSeats).kind, Kind::kRefuse);
  EXPECT_EQ(SeatFor(kOne, {{kOne, false}, {kOne, false}, {kOther, true}}, kSeats).kind,
            Kind::kRefuse);
  const Seating seating = SeatFor(kOne, {{kOther, true}, {kOne, false}, {kOne, true}}, kSeats);
  EXPECT_EQ(seating.kind, Kind::kReplace);
  EXPECT_EQ(seating.victim, 2u);
}

TEST(Seats, OfAllLoopbackAddressesAreOneShare) {
  EXPECT_EQ(SeatFor(kLocal + 9, {{kLocal, false}, {kLocal + 1, false}}, kSeats).kind,
            Kind::kRefuse);
}

}  // namespace
}  // namespace predictor::ros_tcp
