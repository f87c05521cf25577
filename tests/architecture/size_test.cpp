// A source file may have at most 500 lines, and a function of the program or of the page at most 60
// lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr std::ptrdiff_t kFileLines = 500, kFunctionLines = 60;

// ---- the functions of a C++ source --------------------------------------------------------------

bool IsOfWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// If a comment, a literal in quotation marks or a directive begins at `i`, returns its end.
// Otherwise, returns `i`.
std::size_t EndOfText(const std::string& s, std::size_t i) {
  const auto after = [&s](const std::string& end, std::size_t from) {
    const std::size_t at = s.find(end, from);
    return at == std::string::npos ? s.size() : at + end.size();
  };
  const bool in_word = i > 0 && IsOfWord(s[i - 1]);
  if (s.compare(i, 2, "//") == 0) return std::min(s.find('\n', i), s.size());
  if (s.compare(i, 2, "/*") == 0) return after("*/", i + 2);
  if (s.compare(i, 2, "R\"") == 0 && !in_word) {
    const std::size_t open = s.find('(', i);
    return after(")" + s.substr(i + 2, open - i - 2) + "\"", open);
  }
  if (s[i] == '"' || (s[i] == '\'' && !in_word)) {  // 1'000 contains no literal
    std::size_t end = i + 1;
    while (end < s.size() && s[end] != s[i]) end += s[end] == '\\' ? 2 : 1;
    return std::min(end + 1, s.size());
  }
  const std::size_t before = i == 0 ? std::string::npos : s.find_last_not_of(" \t", i - 1);
  if (s[i] != '#' || (before != std::string::npos && s[before] != '\n')) return i;
  std::size_t end = s.find('\n', i);
  while (end != std::string::npos && s[end - 1] == '\\') end = s.find('\n', end + 1);
  return std::min(end, s.size());
}

// Replaces comments, literals and directives by spaces. The line ends remain.
std::string CodeOf(std::string source) {
  for (std::size_t i = 0; i < source.size(); ++i) {
    const std::size_t end = EndOfText(source, i);
    if (end == i) continue;
    for (std::size_t k = i; k < end; ++k)
      if (source[k] != '\n') source[k] = ' ';
    i = end - 1;
  }
  return source;
}

// Returns the end of the bracket that opens at `i`.
std::size_t EndOfBracket(const std::string& code, std::size_t i, char opens, char closes) {
  int depth = 0;
  for (; i < code.size(); ++i) {
    if (code[i] == opens) ++depth;
    if (code[i] == closes && --depth == 0) return i + 1;
  }
  return i;
}

std::string WithoutSpaceBefore(const std::string& text) {
  return text.substr(std::min(text.find_first_not_of(" \n"), text.size()));
}

// Returns whether a value is assigned outside all parentheses, as in `int a[] = {1}`.
bool Assigns(const std::string& head) {
  int depth = 0;
  for (std::size_t i = 0; i < head.size(); ++i) {
    if (head[i] == '(' || head[i] == '[') ++depth;
    if (head[i] == ')' || head[i] == ']') --depth;
    if (head[i] == '=' && depth == 0) return true;
  }
  return false;
}

enum class Block { kScope, kFunction, kMember, kValue };

// Returns what a brace opens. `head` is the text between the previous statement and this brace.
Block BlockOf(std::string head) {
  head = WithoutSpaceBefore(head);
  while (head.starts_with("template"))
    head = WithoutSpaceBefore(head.substr(EndOfBracket(head, head.find('<'), '<', '>')));
  static const std::regex scope(R"(((inline )?namespace|class|struct|union|enum)\b[\s\S]*)"),
      operators(R"(operator\s*[-+*/%^&|<>=!]+)"),
      member(R"([\s\S]*\)\s*(noexcept\s*)?:[^:][\s\S]*[\w>])");
  if (std::regex_match(head, scope)) return Block::kScope;
  if (Assigns(std::regex_replace(head, operators, "operator"))) return Block::kValue;
  if (head.find('(') == std::string::npos)  // extern "C" {
    return head.starts_with("extern") ? Block::kScope : Block::kValue;
  return std::regex_match(head, member) ? Block::kMember : Block::kFunction;
}

struct Function {
  std::ptrdiff_t first_line, lines;
  bool operator==(const Function&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Function& f) {
  return out << "line " << f.first_line << ", " << f.lines << " lines";
}

// Returns the functions at the level of a namespace or a class. A lambda belongs to its function.
std::vector<Function> FunctionsOf(const std::string& source) {
  const std::string code = CodeOf(source);
  const auto lines = [&code](std::size_t from, std::size_t to) {
    return 1 + std::count(code.begin() + static_cast<std::ptrdiff_t>(from),
                          code.begin() + static_cast<std::ptrdiff_t>(to), '\n');
  };
  static const std::regex access(R"(\s*(public|protected|private)\s*)");
  std::vector<Function> functions;
  std::size_t begin = 0;  // of the statement
  for (std::size_t i = 0; i < code.size(); ++i) {
    if (code[i] == ';' || code[i] == '}') begin = i + 1;
    if (code[i] != ':' && code[i] != '{') continue;
    const std::string head = code.substr(begin, i - begin);
    if (code[i] == ':') {
      if (std::regex_match(head, access)) begin = i + 1;
      continue;
    }
    const Block block = BlockOf(head);
    const std::size_t end = EndOfBracket(code, i, '{', '}');
    if (block == Block::kFunction) {
      const std::size_t first = begin + head.size() - WithoutSpaceBefore(head).size();
      functions.push_back({lines(0, first), lines(first, end)});
    }
    if (block == Block::kScope || block == Block::kFunction)
      begin = block == Block::kScope ? i + 1 : end;
    if (block != Block::kScope) i = end - 1;
  }
  return functions;
}

TEST(FunctionsOf, ASourceAreFoundWithTheirLines) {
  const std::string source = R"sample(#define MACRO(x) {  \
  {
namespace a {
namespace {
constexpr int kTable[] = {1, 2};  // {
const auto kLambda = [](int i) {
  return i;
};
struct Point {
  int x{3};
  bool operator==(const Point& p) const {
    return x == p.x;
  }
};
}  // namespace

/* { */ template <class T = int, int N = 2>
T Sum(const T (&values)[N],
      int from = 0) {
  const char* text = "}\"}"; char brace = '}';
  for (int i = from; i < 1'000; ++i) { text = R"(}})"; }
  return {};
}
enum class Kind { kOne };
class Body : public Point {
 public:
  Body() : mass_{1}, size_(2) {
    mass_ = 0;
  }
  double mass() const noexcept { return mass_; }

 private:
  double mass_, size_;
};
extern "C" {
int Inside(void) { return 0; }
}
extern "C" int Alone(void) {
  return 0;
}
}  // namespace a
)sample";
  const std::vector<Function> expected = {{11, 3}, {17, 7}, {27, 3}, {30, 1}, {36, 1}, {38, 3}};
  EXPECT_EQ(FunctionsOf(source), expected);
}

TEST(FunctionsOf, ALongFunctionHasTheLinesOfItsHeadAndBody) {
  std::string source = "void F(int a,\n       int b) {\n";
  for (int i = 0; i < 70; ++i) source += "  if (a) { b = '}'; }\n";
  source += "}\nvoid G() {}\n";
  EXPECT_EQ(FunctionsOf(source), (std::vector<Function>{{1, 73}, {74, 1}}));
}

// ---- the functions of a TypeScript source -------------------------------------------------------

// Returns the blocks with parentheses in their heads at the level of a file or a class. The sources
// are indented by two spaces, so a block ends at the first brace below its head's first letter.
std::vector<Function> ScriptFunctionsOf(const std::string& source) {
  std::vector<std::string> lines;
  std::istringstream text(source);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  static const std::regex head(R"((  )?\w.*\(.*)");
  std::vector<Function> functions;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!std::regex_match(lines[i], head)) continue;
    std::size_t open = i;
    while (open < lines.size() && !lines[open].empty() && !lines[open].ends_with('{') &&
           !lines[open].ends_with(';'))
      ++open;
    if (open == lines.size() || !lines[open].ends_with('{')) continue;
    const std::string brace = (lines[i][0] == ' ' ? "  }" : "}");
    std::size_t end = open + 1;
    while (end < lines.size() && !lines[end].starts_with(brace)) ++end;
    functions.push_back(
        {static_cast<std::ptrdiff_t>(i + 1), static_cast<std::ptrdiff_t>(end - i + 1)});
  }
  return functions;
}

TEST(ScriptFunctionsOf, ASourceAreFoundWithTheirLines) {
  const std::string source = R"sample(import {h} from './dom';
const kTable = {
  a: 1,
};
export function one(a: number,
                    b: number) {
  return {
    a, b,
  };
}
class Page {
  private readonly word = h('span', {});
  constructor(root: HTMLElement) {
    if (root) {
      root.append();
    }
  }

  get empty(): boolean {
    return true;
  }
}
)sample";
  EXPECT_EQ(ScriptFunctionsOf(source), (std::vector<Function>{{5, 6}, {13, 5}, {19, 3}}));
}

// ---- the repository -----------------------------------------------------------------------------

std::string ContentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Returns the sources that we write. Packages of others are in folders named node_modules.
std::vector<fs::path> Sources(const std::vector<std::string>& folders,
                              const std::set<std::string>& extensions) {
  const fs::path root = PREDICTOR_SOURCE_DIR;
  std::vector<fs::path> files;
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (extensions.contains(entry.path().extension().string()) &&
          entry.path().string().find("/node_modules/") == std::string::npos &&
          !ContentOf(entry.path()).starts_with("// Generated "))
        files.push_back(entry.path().lexically_relative(root));
  return files;
}

TEST(Sources, HaveAtMost500Lines) {
  auto files = Sources({"src", "apps", "tests", "examples", "tools", "web/src"},
                       {".cpp", ".h", ".c", ".py", ".sh", ".ts", ".js", ".mjs", ".css", ".html"});
  files.emplace_back("dev");
  EXPECT_GT(files.size(), 1500u);
  for (const fs::path& file : files) {
    const std::string text = ContentOf(fs::path(PREDICTOR_SOURCE_DIR) / file);
    EXPECT_LE(std::ranges::count(text, '\n'), kFileLines) << file << " is too long. Split it.";
  }
}

// Expects that no function of the files is too long, and returns their number.
std::size_t CountShortFunctions(const std::vector<fs::path>& files,
                                std::vector<Function> (*functions_of)(const std::string&)) {
  std::size_t count = 0;
  for (const fs::path& file : files) {
    const std::vector<Function> functions =
        functions_of(ContentOf(fs::path(PREDICTOR_SOURCE_DIR) / file));
    count += functions.size();
    for (const Function& function : functions)
      EXPECT_LE(function.lines, kFunctionLines)
          << file << ":" << function.first_line << ": this function is too long. Split it.";
  }
  return count;
}

TEST(Sources, HaveFunctionsOfAtMost60Lines) {
  EXPECT_GT(CountShortFunctions(Sources({"src", "apps"}, {".cpp", ".h", ".c"}), FunctionsOf),
            6000u);
}

TEST(Sources, HavePageFunctionsOfAtMost60Lines) {
  EXPECT_GT(CountShortFunctions(Sources({"web/src"}, {".ts"}), ScriptFunctionsOf), 400u);
}

}  // namespace
