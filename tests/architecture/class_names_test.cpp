// No two classes may have the same full name. The linker would silently merge their members, and
// one class would run the other's code.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// Maps the full name of a class to the files that define it.
using Definitions = std::map<std::string, std::set<std::string>>;

// Adds the classes that `source` defines at namespace level, where clang-format puts them in the
// first column. Classes in an anonymous namespace are skipped, because they are local to their
// file.
void AddClasses(std::istream* source, const std::string& file, Definitions* found) {
  const std::regex opens(R"(namespace ([\w:]*) ?\{.*)"), closes(R"(\}  // namespace.*)"),
      defines(
          R"((?:class|struct|enum class|enum|union)(?: \[\[\w+\]\])? (\w+)(?: final)?(?: : [^;]*)?(?: \{.*)?)");
  std::vector<std::string> open;
  std::smatch match;
  for (std::string line; std::getline(*source, line);) {
    if (std::regex_match(line, match, opens)) {
      open.push_back(match[1]);
    } else if (std::regex_match(line, closes)) {
      if (!open.empty()) open.pop_back();
    } else if (std::regex_match(line, match, defines)) {
      std::string name;
      bool anonymous = false;
      for (const std::string& space : open) {
        anonymous |= space.empty();
        name += space + "::";
      }
      if (!anonymous) (*found)[name + match[1].str()].insert(file);
    }
  }
}

std::string Clashes(const Definitions& found) {
  std::string text;
  for (const auto& [name, files] : found) {
    if (files.size() < 2) continue;
    text += name + " is defined in";
    for (const std::string& file : files) text += " " + file;
    text += "\n";
  }
  return text;
}

TEST(ClassNames, OfTwoModulesThatClashAreFound) {
  Definitions found;
  std::istringstream a("namespace predictor {\nclass Session {\n};\n}  // namespace predictor\n");
  std::istringstream b(
      "namespace predictor {\nnamespace {\nstruct Own {\n};\n}  // namespace\n"
      "class Session final : public Base {\n};\nclass Later;\n}  // namespace predictor\n");
  std::istringstream c(
      "namespace predictor::viewer {\nclass Session {\n};\n}  // namespace predictor::viewer\n");
  AddClasses(&a, "a.h", &found);
  AddClasses(&b, "b.h", &found);
  AddClasses(&c, "c.h", &found);
  EXPECT_EQ(Clashes(found), "predictor::Session is defined in a.h b.h\n");
  EXPECT_EQ(found.size(), 2u);
}

TEST(ClassNames, AreUnique) {
  const fs::path root = PREDICTOR_SOURCE_DIR;
  Definitions found;
  for (const char* folder : {"src", "apps"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path& file = entry.path();
      if (file.extension() != ".h" && file.extension() != ".cpp") continue;
      std::ifstream source(file);
      AddClasses(&source, file.lexically_relative(root).string(), &found);
    }
  }
  EXPECT_GT(found.size(), 400u);
  EXPECT_EQ(Clashes(found), "");
}

}  // namespace
