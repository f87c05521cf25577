#include "core/text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>

#include "core/random.h"

namespace predictor {
namespace {

TEST(Nearest, FindsTheIntendedName) {
  const std::vector<std::string> keys = {"force", "torque", "tracking", "max_age"};
  EXPECT_EQ(Nearest("forse", keys), "force");
  EXPECT_EQ(Nearest("Torque", keys), "torque");
  EXPECT_EQ(Nearest("troque", keys), "torque");  // one swap
  EXPECT_EQ(Nearest("trcking", keys), "tracking");
  EXPECT_EQ(Nearest("maxage", keys), "max_age");
}

TEST(Nearest, IsSilentWhenNothingIsNear) {
  EXPECT_EQ(Nearest("colour", {"force", "torque"}), "");
  EXPECT_EQ(Nearest("", {"force"}), "");
  EXPECT_EQ(Nearest("force", {}), "");
  EXPECT_EQ(Nearest(std::string(1000000, 'f'), {"force"}), "");
}

TEST(Nearest, ShortNamesAllowOneChange) {
  EXPECT_EQ(Nearest("kq", {"kp", "ko"}), "kp");
  EXPECT_EQ(Nearest("sed", {"set", "seed"}), "seed");  // a letter is missing, none is wrong
  EXPECT_EQ(Nearest("xy", {"kp", "ko"}), "");
}

TEST(Suggestion, ListsAllWhenNothingIsNear) {
  EXPECT_EQ(Suggestion("forse", {"force", "torque"}), "Did you mean force?");
  EXPECT_EQ(Suggestion("colour", {"force", "torque"}), "The known names are: force, torque.");
}

TEST(DegreesHint, OnlyOfWhatMayHaveBeenMeant) {
  EXPECT_EQ(DegreesHint(-90, -3, 3),
            " A number without a unit is in rad. For degrees, write -90 deg.");
  EXPECT_EQ(DegreesHint(90, -3, -0.1), "");  // would be out of range in degrees as well
  EXPECT_EQ(DegreesHint(4, -3, 3), "");      // an angle in rad
  EXPECT_EQ(DegreesHint(5000, -3, 3), "");
}

TEST(FormatNumber, ReadsBackExactly) {
  RandomStream random(1, "numbers");
  int finite = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = std::bit_cast<double>(random.Next());
    if (!std::isfinite(x)) continue;
    ++finite;
    ASSERT_EQ(std::strtod(FormatNumber(x).c_str(), nullptr), x);
  }
  EXPECT_GT(finite, 90000);
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  EXPECT_EQ(FormatNumber(-500), "-500");
}

TEST(Quote, EscapesAndCuts) {
  EXPECT_EQ(Quote("a b"), "\"a b\"");
  EXPECT_EQ(Quote(std::string("\x1b[2J\0", 5)), "\"\\x1b[2J\\x00\"");
  EXPECT_EQ(Quote(std::string(61, 'a')), "\"" + std::string(60, 'a') + "...\"");
  // "é" has two bytes, and the text is cut between these bytes.
  std::string accents = "a";
  for (int i = 0; i < 40; ++i) accents += "é";
  EXPECT_EQ(Quote(accents).substr(58), "é...\"");
}

TEST(Printable, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(Printable("Box, 9 kg: 30 µm, 你好, 😀 \"q\" \\ ~"),
            "Box, 9 kg: 30 µm, 你好, 😀 \"q\" \\ ~");
  EXPECT_EQ(Printable("\x1b]0;owned\a\x1b[2J"), "\\x1b]0;owned\\x07\\x1b[2J");
  EXPECT_EQ(Printable("a\nb\tc\rd\x7f"), "a\\x0ab\\x09c\\x0dd\\x7f");
  EXPECT_EQ(Printable("a\nb\tc\rd", Lines::kMany), "a\nb\tc\\x0dd");
  EXPECT_EQ(Printable("\u009b2J\u0085"), "\\u009b2J\\u0085");  // CSI and NEL of C1
  EXPECT_EQ(Printable("\u202e\u2066\u2069\u200f\u061c\u2028"),
            "\\u202e\\u2066\\u2069\\u200f\\u061c\\u2028");
  EXPECT_EQ(Printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(Printable(""), "");
}

// These bytes are not valid UTF-8. They are isolated, truncated, overlong, surrogates, or beyond
// the last character.
TEST(Printable, ShowsInvalidUtf8ByteByByte) {
  EXPECT_EQ(Printable("\x9b"
                      "2J"),
            "\\x9b2J");
  EXPECT_EQ(Printable("\xc3"), "\\xc3");
  EXPECT_EQ(Printable("\xe2\x80"), "\\xe2\\x80");
  EXPECT_EQ(Printable("\xc0\x9b"), "\\xc0\\x9b");
  EXPECT_EQ(Printable("\xe0\x82\x9b"), "\\xe0\\x82\\x9b");
  EXPECT_EQ(Printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(Printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(Printable("\xff\xc3\xa9"), "\\xffé");
}

// For any input, the output must not contain bytes that control a terminal. A second pass must not
// change the output.
TEST(Printable, LeavesNoControlInRandomBytes) {
  RandomStream random(1, "printable");
  for (int k = 0; k < 20'000; ++k) {
    std::string text;
    for (int i = 0; i < 12; ++i) text += static_cast<char>(random.Next() & 0xff);
    const std::string shown = Printable(text);
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const auto byte = static_cast<unsigned char>(shown[i]);
      ASSERT_TRUE(byte >= 0x20 && byte != 0x7f);
      ASSERT_TRUE(byte != 0xc2 || static_cast<unsigned char>(shown[i + 1]) >= 0xa0);
    }
    ASSERT_EQ(Printable(shown), shown);
  }
}

TEST(JsonInScript, HoldsNothingThatEndsAScript) {
  EXPECT_EQ(JsonInScript(R"({"a":"</script><!--<script>","b":1})"),
            R"({"a":"\u003c/script>\u003c!--\u003cscript>","b":1})");
  EXPECT_EQ(JsonInScript("\"a\u2028b\u2029c\u2027\""), "\"a\\u2028b\\u2029c\u2027\"");
}

TEST(CsvCell, IsQuotedWhereItMustBeAndNeverAFormula) {
  EXPECT_EQ(CsvCell("plain text"), "plain text");
  EXPECT_EQ(CsvCell(""), "");
  EXPECT_EQ(CsvCell("a,b"), "\"a,b\"");
  EXPECT_EQ(CsvCell("say \"a\""), "\"say \"\"a\"\"\"");
  EXPECT_EQ(CsvCell("a\nb"), "\"a\nb\"");
  EXPECT_EQ(CsvCell("=cmd|'/c calc'!A1"), "'=cmd|'/c calc'!A1");
  for (const char first : {'=', '+', '-', '@', '\t'})
    EXPECT_EQ(CsvCell(std::string(1, first) + "1"), std::string("'") + first + "1");
  EXPECT_EQ(CsvCell("\r1"), "\"'\r1\"");
  EXPECT_EQ(CsvCell("=1,2"), "\"'=1,2\"");
  EXPECT_EQ(CsvCell("1=1"), "1=1");
}

TEST(Join, SeparatesWords) {
  EXPECT_EQ(Join({}), "");
  EXPECT_EQ(Join({"a"}), "a");
  EXPECT_EQ(Join({"a", "b", "c"}, "; "), "a; b; c");
}

}  // namespace
}  // namespace predictor
