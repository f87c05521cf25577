#include "scenario/yaml_tree.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "fixture.h"
#include "scenario/yaml_scalar.h"

namespace predictor {
namespace {

YamlNode Parse(const std::string& text) { return ParseYaml(text, "f.yaml"); }

std::string ErrorOfYaml(const std::string& text) {
  try {
    Parse(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(YamlTree, KnowsThePlaceOfEachNode) {
  const YamlNode root = Parse("a: 1\nb:\n  c: [x, \"5\"]\n");
  const YamlNode* c = root.Find("b")->Find("c");
  EXPECT_EQ(root.Find("a")->place.Text(), "f.yaml:1:4");
  EXPECT_EQ(c->key_place.Text(), "f.yaml:3:3");
  EXPECT_EQ(c->items[1].place.Text(), "f.yaml:3:10");
  EXPECT_TRUE(c->items[1].quoted);
  EXPECT_FALSE(c->items[0].quoted);
}

TEST(YamlTree, RefusesWhatScenariosDoNotNeed) {
  EXPECT_EQ(ErrorOfYaml("a: &x 1\n").find("f.yaml:1:4: anchors (&) and aliases (*)"), 0u);
  EXPECT_EQ(ErrorOfYaml("a: *x\n").find("f.yaml:1:4: anchors (&) and aliases (*)"), 0u);
  EXPECT_EQ(ErrorOfYaml("a: !!str 1\n").find("f.yaml:1:4: tags are not allowed"), 0u);
  EXPECT_EQ(ErrorOfYaml("a: 1\n---\nb: 1\n").find("f.yaml:3:1: a second document"), 0u);
  EXPECT_EQ(ErrorOfYaml("a: 1\nb: 2\na: 3\n").find("f.yaml:3:1: the key \"a\" occurs twice"), 0u);
  EXPECT_EQ(ErrorOfYaml("[a]: 1\n").find("f.yaml:1:1: here is a list or a group instead of a key"),
            0u);
  EXPECT_EQ(ErrorOfYaml("a: [1, 2\n").find("f.yaml:"), 0u);
  EXPECT_EQ(ErrorOfYaml("a: \xff\n").find("f.yaml:1:4: the file is not UTF-8"), 0u);
  EXPECT_EQ(ErrorOfYaml(std::string("a: \0\n", 5)).find("f.yaml:1:4: here is a control character"),
            0u);
}

TEST(YamlTree, AcceptsUtf8AndRefusesItsForgeries) {
  EXPECT_EQ(Parse("a: é ü 日 🙂\n").Find("a")->text, "é ü 日 🙂");
  for (const char* forged : {"\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                             "\xf5\x80\x80\x80", "\x80", "\xe6\x97", "\xfe\xff"}) {
    EXPECT_NE(ErrorOfYaml(std::string("a: ") + forged), "") << forged;
  }
}

TEST(YamlTree, QuotationMarksMustBeClosed) {
  for (const char* good : {"a: é\r\nb: \"ok\"\r\n", "\xef\xbb\xbf\"é\": \"x\"\n", "a: 'it''s'\n",
                           "a: \"\\\"\"\n", "a: 'x'  # don't\n", "'a': b's\n", "a: |\n  don't\n"}) {
    EXPECT_EQ(ErrorOfYaml(good), "") << good;
  }
  for (const char* bad : {"a: \"x\n", "a: é\nb: 'x\n", "a: 'it''\n", "a: \"x\\\"\nb: 1\n"}) {
    EXPECT_NE(ErrorOfYaml(bad), "") << bad;
  }
}

TEST(YamlTree, CountsDepthExactly) {
  const auto nested = [](int depth) {
    return std::string(depth, '[') + "x" + std::string(depth, ']');
  };
  EXPECT_EQ(ErrorOfYaml(nested(kMaxYamlDepth)), "");
  EXPECT_NE(ErrorOfYaml(nested(kMaxYamlDepth + 1)).find("nested deeper than 32"),
            std::string::npos);
}

TEST(YamlTree, OverridesReachMapsAndLists) {
  YamlNode root = Parse("a: {b: 1, c: [x, {d: 2}]}\n");
  ApplyOverride("a.b=[7, 8]", &root);
  ApplyOverride("a.c.1.d=9", &root);
  ApplyOverride("new.deep.key=text = more", &root);
  EXPECT_EQ(root.Find("a")->Find("b")->items[1].text, "8");
  EXPECT_EQ(root.Find("a")->Find("c")->items[1].Find("d")->text, "9");
  EXPECT_EQ(root.Find("new")->Find("deep")->Find("key")->text, "text = more");
  EXPECT_EQ(root.Find("a")->Find("b")->place.Text(), "--set a.b");
}

TEST(YamlTree, OverridesThatLeadNowhereAreErrors) {
  YamlNode root = Parse("a: [1, 2]\n");
  for (const char* bad : {"a.2=1", "a.-1=1", "a.x=1", "a..b=1", ".a=1", "a.=1", "=1", "a", ""}) {
    EXPECT_THROW(ApplyOverride(bad, &root), InputError) << bad;
  }
  std::string deep = "a";
  for (int i = 0; i < 100; ++i) deep += ".a";
  EXPECT_THROW(ApplyOverride(deep + "=1", &root), InputError);
}

TEST(YamlScalar, ReadsDecimalNumbersOnly) {
  const auto is_number = [](const std::string& text) {
    double number;
    return ReadNumber(text, &number);
  };
  for (const char* good :
       {"0", "-1", "+1", "1.5", ".5", "5.", "1e3", "-1.0E-3", ".inf", "-.INF", ".nan", "1e999"}) {
    EXPECT_TRUE(is_number(good)) << good;
  }
  for (const char* bad : {"", "-", "+", ".", "e3", "1e", "0x10", "1_000", "1,5", "--1", "+-1",
                          "1 2", "infinity", "true", "12abc"}) {
    EXPECT_FALSE(is_number(bad)) << bad;
  }
}

TEST(YamlScalar, NumbersAreWrittenForOldReadersToo) {
  EXPECT_EQ(WriteNumber(1e-5), "1.0e-05");  // YAML 1.1 reads 1e-05 as a word
  EXPECT_EQ(WriteNumber(1.5e300), "1.5e+300");
  double back = 0;
  ASSERT_TRUE(ReadNumber(WriteNumber(-1e-5), &back));
  EXPECT_EQ(back, -1e-5);
}

// For any bytes, the parser must either return a tree or throw InputError.
TEST(YamlTree, SurvivesMutatedText) {
  const std::string text = FixtureText();
  RandomStream random(7, "mutations");
  const std::string alphabet = "[]{}:,-?&*!|>'\"%@`#\n \t~0aé\xff";
  int loaded = 0, refused = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string mutated = text;
    for (int i = 0; i < 1 + round % 5; ++i) {
      const std::size_t at = random.Next() % mutated.size();
      const std::size_t length = random.Next() % 8;
      switch (random.Next() % 4) {
        case 0:
          mutated.erase(at, length);
          break;
        case 1:
          mutated.insert(at, 1 + length, alphabet[random.Next() % alphabet.size()]);
          break;
        case 2:
          mutated[at] = static_cast<char>(random.Next());
          break;
        default:
          mutated.insert(at, mutated.substr(random.Next() % mutated.size(), 40));
      }
    }
    (ErrorOf(mutated).empty() ? loaded : refused) += 1;
  }
  EXPECT_GT(loaded, 20);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace predictor
