#include "core/ring.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>

namespace predictor {
namespace {

struct Item {
  std::uint64_t number;
  std::uint64_t copies[31];
};

Item Make(std::uint64_t n) {
  Item item{n, {}};
  for (auto& c : item.copies) c = n;
  return item;
}

TEST(Ring, DeliversEverythingInOrderToAReaderThatKeepsUp) {
  auto ring = std::make_unique<RingStorage<Item, 8>>();
  RingReader reader(*ring);
  Item item;
  EXPECT_FALSE(reader.Next(&item));
  for (std::uint64_t n = 0; n < 100; ++n) {
    ring->Publish(Make(n));
    ASSERT_TRUE(reader.Next(&item));
    EXPECT_EQ(item.number, n);
    EXPECT_FALSE(reader.Next(&item));
  }
  EXPECT_EQ(reader.lost(), 0u);
}

TEST(Ring, CountsWhatASlowReaderLost) {
  auto ring = std::make_unique<RingStorage<Item, 8>>();
  RingReader reader(*ring);
  for (std::uint64_t n = 0; n < 20; ++n) ring->Publish(Make(n));
  Item item;
  std::uint64_t received = 0;
  while (reader.Next(&item)) {
    EXPECT_EQ(item.number, 12 + received);
    ++received;
  }
  EXPECT_EQ(received, 8u);
  EXPECT_EQ(reader.lost(), 12u);
}

// A writer that never waits runs against a reader in another thread. No item may be torn, the order
// must be kept, and each item must be either delivered or counted as lost.
TEST(Ring, NeverTearsAnItem) {
  auto ring = std::make_unique<RingStorage<Item, 16>>();
  RingReader reader(*ring);
  constexpr std::uint64_t kItems = 200'000;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t n = 0; n < kItems; ++n) ring->Publish(Make(n));
    done = true;
  });
  std::uint64_t received = 0;
  std::uint64_t next = 0;
  const auto drain = [&] {
    Item item;
    while (reader.Next(&item)) {
      ASSERT_GE(item.number, next);
      next = item.number + 1;
      for (const auto c : item.copies) ASSERT_EQ(c, item.number);
      ++received;
    }
  };
  while (!done) drain();
  writer.join();
  drain();
  EXPECT_EQ(received + reader.lost(), kItems);
}

}  // namespace
}  // namespace predictor
