#include "core/text_table.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

// The text contains characters of 1, 2, 3 and 4 bytes (RFC 3629).
TEST(TextTable, CountsCharactersAndNotBytes) {
  EXPECT_EQ(CharactersIn(""), 0u);
  EXPECT_EQ(CharactersIn("N·m"), 3u);
  EXPECT_EQ(CharactersIn("– 5 %"), 5u);
  EXPECT_EQ(CharactersIn("\xf0\x9f\x99\x82!"), 2u);
}

TEST(TextTable, PadsToTheWidthInCharacters) {
  EXPECT_EQ(LeftAligned("N·m", 5), "N·m  ");
  EXPECT_EQ(RightAligned("–", 3), "  –");
  EXPECT_EQ(RightAligned("longer", 3), "longer");
}

}  // namespace
}  // namespace predictor
