// Compares each cell of the tables of RULA and REBA with copies that others transcribed.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "ergonomics/reba.h"
#include "ergonomics/rula.h"

namespace predictor::ergonomics {
namespace {

std::vector<int> NumbersIn(const std::string& text) {
  std::istringstream in(text);
  std::vector<int> numbers;
  for (int x; in >> x;) numbers.push_back(x);
  return numbers;
}

// Two public programs (one in Korean, one in Spanish) contain the same table. Its rows correspond
// to the score of the upper arm, and its columns to the scores of the lower arm and the wrist. The
// two digits of a pair are for the two scores of the wrist's twist. For upper arm 5, lower arm 2,
// wrist 3 and twist 2, two other programs have 6 instead of 7, but an older worksheet also has 7.
constexpr const char* kPrintedRulaA =
    "12 22 23 33  22 22 33 33  23 33 33 44\n"
    "23 33 34 44  33 33 34 44  34 44 44 55\n"
    "33 44 44 55  34 44 44 55  44 44 45 55\n"
    "44 44 45 55  44 44 45 55  44 45 55 66\n"
    "55 55 56 67  56 66 67 77  66 67 77 78\n"
    "77 77 78 89  88 88 89 99  99 99 99 99\n";
// Three public programs contain the same table. Its rows correspond to the score of the neck, and
// its columns to the scores of the trunk and the legs.
constexpr const char* kPrintedRulaB =
    "1 3 2 3 3 4 5 5 6 6 7 7\n"
    "2 3 2 3 4 5 5 5 6 7 7 7\n"
    "3 3 3 4 4 5 5 6 6 7 7 7\n"
    "5 5 5 6 6 7 7 7 7 7 8 8\n"
    "7 7 7 7 7 8 8 8 8 8 8 8\n"
    "8 8 8 8 8 8 8 9 9 9 9 9\n";
// The rows correspond to the score of wrist and arm, and the columns to the score of neck, trunk
// and legs.
constexpr const char* kPrintedRulaC =
    "1 2 3 3 4 5 5\n"
    "2 2 3 4 4 5 5\n"
    "3 3 3 4 4 5 6\n"
    "3 3 3 4 5 6 6\n"
    "4 4 4 5 6 7 7\n"
    "4 4 5 6 6 7 7\n"
    "5 5 6 6 7 7 7\n"
    "5 5 6 7 7 7 7\n";

TEST(Rula, TablesAreThoseOfOtherCopies) {
  const std::vector<int> a = NumbersIn(kPrintedRulaA);
  ASSERT_EQ(a.size(), 72u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const int upper = 1 + static_cast<int>(i) / 12, lower = 1 + static_cast<int>(i) / 4 % 3;
    const int wrist = 1 + static_cast<int>(i) % 4;
    EXPECT_EQ(10 * RulaTableA(upper, lower, wrist, 1) + RulaTableA(upper, lower, wrist, 2), a[i])
        << upper << lower << wrist;
  }
  const std::vector<int> b = NumbersIn(kPrintedRulaB);
  ASSERT_EQ(b.size(), 72u);
  for (int i = 0; i < 72; ++i)
    EXPECT_EQ(RulaTableB(1 + i / 12, 1 + i / 2 % 6, 1 + i % 2), b[static_cast<std::size_t>(i)])
        << i;
  const std::vector<int> c = NumbersIn(kPrintedRulaC);
  ASSERT_EQ(c.size(), 56u);
  for (int i = 0; i < 56; ++i)
    EXPECT_EQ(RulaTableC(1 + i / 7, 1 + i % 7), c[static_cast<std::size_t>(i)]) << i;
}

// The REBA Employee Assessment Worksheet prints this table. Its rows correspond to the score of the
// trunk, and its columns to the scores of the neck and the legs.
constexpr const char* kPrintedRebaA =
    "1 2 3 4 1 2 3 4 3 3 5 6\n"
    "2 3 4 5 3 4 5 6 4 5 6 7\n"
    "2 4 5 6 4 5 6 7 5 6 7 8\n"
    "3 5 6 7 5 6 7 8 6 7 8 9\n"
    "4 6 7 8 6 7 8 9 7 8 9 9\n";
// The rows correspond to the score of the upper arm, and the columns to the scores of the lower arm
// and the wrist.
constexpr const char* kPrintedRebaB =
    "1 2 2 1 2 3\n"
    "1 2 3 2 3 4\n"
    "3 4 5 4 5 5\n"
    "4 5 5 5 6 7\n"
    "6 7 8 7 8 8\n"
    "7 8 8 8 9 9\n";
// The rows correspond to score A, and the columns to score B. The copy ends at score A = 9.
constexpr const char* kPrintedRebaC =
    "1 1 1 2 3 3 4 5 6 7 7 7\n"
    "1 2 2 3 4 4 5 6 6 7 7 8\n"
    "2 3 3 3 4 5 6 7 7 8 8 8\n"
    "3 4 4 4 5 6 7 8 8 9 9 9\n"
    "4 4 4 5 6 7 8 8 9 9 9 9\n"
    "6 6 6 7 8 8 9 9 10 10 10 10\n"
    "7 7 7 8 9 9 9 10 10 11 11 11\n"
    "8 8 8 9 10 10 10 10 10 11 11 11\n"
    "9 9 9 10 10 10 11 11 11 12 12 12\n";

TEST(Reba, TablesAreThoseOfThePrintedWorksheet) {
  const std::vector<int> a = NumbersIn(kPrintedRebaA);
  ASSERT_EQ(a.size(), 60u);
  for (int i = 0; i < 60; ++i)
    EXPECT_EQ(RebaTableA(1 + i / 4 % 3, 1 + i / 12, 1 + i % 4), a[static_cast<std::size_t>(i)])
        << i;
  const std::vector<int> b = NumbersIn(kPrintedRebaB);
  ASSERT_EQ(b.size(), 36u);
  for (int i = 0; i < 36; ++i)
    EXPECT_EQ(RebaTableB(1 + i / 6, 1 + i / 3 % 2, 1 + i % 3), b[static_cast<std::size_t>(i)]) << i;
  const std::vector<int> c = NumbersIn(kPrintedRebaC);
  ASSERT_EQ(c.size(), 108u);
  for (int i = 0; i < 108; ++i)
    EXPECT_EQ(RebaTableC(1 + i / 12, 1 + i % 12), c[static_cast<std::size_t>(i)]) << i;
}

}  // namespace
}  // namespace predictor::ergonomics
