#include "fakes/ur/urscript_lexer.h"

#include <cctype>
#include <set>
#include <utility>

#include "fakes/ur/urscript.h"

namespace predictor::urscript {
namespace {

const std::set<std::string> kKeywords = {"def",          "thread",
                                         "end",          "if",
                                         "elif",         "else",
                                         "while",        "break",
                                         "continue",     "return",
                                         "halt",         "global",
                                         "local",        "run",
                                         "kill",         "join",
                                         "and",          "or",
                                         "not",          "True",
                                         "False",        "enter_critical",
                                         "exit_critical"};

class Lexer {
 public:
  explicit Lexer(const std::string& text) : text_(text) {}

  std::vector<Token> Run() {
    using Kind = Token::Kind;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\n') {
        Add(Kind::kNewline, Take(1));
        ++line_;
      } else if (std::isspace(static_cast<unsigned char>(c)) != 0) {
        ++at_;
      } else if (c == '#') {
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
      } else if (Is(c, "_") || std::isalpha(static_cast<unsigned char>(c)) != 0) {
        const std::string word = TakeWhile("_");
        Add(kKeywords.count(word) != 0 ? Kind::kKeyword : Kind::kName, word);
      } else if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
        Add(Kind::kNumber, TakeWhile("."));
      } else if (c == '"') {
        Add(Kind::kString, String());
      } else {
        Add(Kind::kSymbol, Symbol());
      }
    }
    Add(Kind::kNewline, "");
    Add(Kind::kEnd, "");
    return std::move(tokens_);
  }

 private:
  static bool Is(char c, const char* set) { return std::string(set).find(c) != std::string::npos; }
  void Add(Token::Kind kind, const std::string& text) { tokens_.push_back({kind, text, line_}); }
  std::string Take(std::size_t n) {
    at_ += n;
    return text_.substr(at_ - n, n);
  }
  std::string TakeWhile(const char* more) {
    std::size_t n = 0;
    while (
        at_ + n < text_.size() &&
        (std::isalnum(static_cast<unsigned char>(text_[at_ + n])) != 0 || Is(text_[at_ + n], more)))
      ++n;
    return Take(n);
  }
  std::string String() {
    const std::size_t end = text_.find('"', at_ + 1);
    if (end == std::string::npos) throw Error(line_, "a string has no end");
    const std::string quoted = Take(end + 1 - at_);
    return quoted.substr(1, quoted.size() - 2);
  }
  std::string Symbol() {
    for (const char* two : {"==", "!=", "<=", ">="})
      if (text_.compare(at_, 2, two) == 0) return Take(2);
    if (!Is(text_[at_], "+-*/%()[],:=<>"))
      throw Error(line_, std::string("unknown symbol '") + text_[at_] + "'");
    return Take(1);
  }

  const std::string& text_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::vector<Token> tokens_;
};

}  // namespace

std::vector<Token> Tokens(const std::string& text) { return Lexer(text).Run(); }

}  // namespace predictor::urscript
