#include "analysis/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace predictor {
namespace {

TEST(DoInParallel, DoesEachPieceOnce) {
  std::vector<std::atomic<int>> done(100);
  DoInParallel(
      done.size(), 4, [&](std::size_t i) { ++done[i]; }, [] {});
  for (const auto& times : done) EXPECT_EQ(times, 1);
}

TEST(DoInParallel, UsesTheCoresWithoutANumberOfWorkers) {
  std::vector<std::atomic<int>> done(100);
  DoInParallel(
      done.size(), 0, [&](std::size_t i) { ++done[i]; }, [] {});
  for (const auto& times : done) EXPECT_EQ(times, 1);
  DoInParallel(
      0, 0, [](std::size_t) { FAIL(); }, [] {});
}

TEST(DoInParallel, ReportsTheErrorAndEndsTheRest) {
  std::atomic<int> done = 0;
  const auto piece = [&](std::size_t i) {
    if (i == 3) throw std::bad_alloc();
    ++done;
  };
  EXPECT_THROW(DoInParallel(1000, 1, piece, [] {}), std::bad_alloc);
  EXPECT_EQ(done, 3);
}

}  // namespace
}  // namespace predictor
