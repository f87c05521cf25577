#include "fakes/ur/urscript.h"

#include <locale>
#include <sstream>
#include <utility>

#include "fakes/ur/urscript_lexer.h"

namespace predictor::urscript {
namespace {

class Compiler {
 public:
  explicit Compiler(const std::string& text) : tokens_(Tokens(text)) {}

  Program Run() {
    SkipNewlines();
    Expect("def");
    program_.name = Definition(false);
    SkipNewlines();
    if (tokens_[at_].kind != Token::Kind::kEnd) Fail("unexpected text after the program");
    for (const Instruction& i : program_.code) CheckCall(i);
    return std::move(program_);
  }

 private:
  struct Loop {
    int start;
    std::vector<int> breaks;
  };

  [[noreturn]] void Fail(const std::string& what) const { throw Error(tokens_[at_].line, what); }
  const Token& Peek() const { return tokens_[at_]; }
  bool At(const std::string& text) const {
    return Peek().text == text &&
           (Peek().kind == Token::Kind::kKeyword || Peek().kind == Token::Kind::kSymbol);
  }
  bool Accept(const std::string& text) {
    const bool there = At(text);
    if (there) ++at_;
    return there;
  }
  void Expect(const std::string& text) {
    if (!Accept(text)) Fail("'" + text + "' expected, not '" + Peek().text + "'");
  }
  std::string Name() {
    if (Peek().kind != Token::Kind::kName) Fail("a name was expected, not '" + Peek().text + "'");
    return tokens_[at_++].text;
  }
  void EndLine() {
    if (Peek().kind != Token::Kind::kNewline) Fail("unexpected '" + Peek().text + "'");
    SkipNewlines();
  }
  void SkipNewlines() {
    while (Peek().kind == Token::Kind::kNewline) ++at_;
  }

  int Here() const { return static_cast<int>(program_.code.size()); }
  int Emit(Op op, int number = 0, const std::string& name = "", const Value& value = 0.0) {
    program_.code.push_back({op, Peek().line, number, name, value});
    return Here() - 1;
  }
  void Land(int jump) { program_.code[static_cast<std::size_t>(jump)].number = Here(); }

  void CheckCall(const Instruction& i) const {
    if (i.op != Op::kCall && i.op != Op::kRun) return;
    const auto it = program_.functions.find(i.name);
    if (it == program_.functions.end() || it->second.thread != (i.op == Op::kRun))
      throw Error(i.line, "unknown function '" + i.name + "'");
    if (static_cast<int>(it->second.parameters.size()) != i.number)
      throw Error(i.line, "'" + i.name + "' has the wrong number of arguments");
  }

  // Parses a definition after `def` or `thread`. A jump instruction before the definition's code
  // skips this code.
  std::string Definition(bool thread) {
    const int over = Emit(Op::kJump);
    const std::string name = Name();
    if (program_.functions.count(name) != 0 || Builtins().count(name) != 0)
      Fail("'" + name + "' is defined twice");
    Function function{thread, Here(), {}};
    Expect("(");
    while (!Accept(")")) {
      function.parameters.push_back(Name());
      if (!At(")")) Expect(",");
    }
    program_.functions[name] = function;
    Expect(":");
    EndLine();
    const auto loops = std::exchange(loops_, {});
    Block();
    loops_ = loops;
    Expect("end");
    Emit(Op::kPush);
    Emit(Op::kReturn);
    Land(over);
    return name;
  }

  void Block() {
    SkipNewlines();
    while (!At("end") && !At("elif") && !At("else")) {
      if (Peek().kind == Token::Kind::kEnd) Fail("a block has no end");
      Statement();
      EndLine();
    }
  }

  void Statement() {
    if (Accept("def")) {
      Definition(false);
    } else if (Accept("thread")) {
      Definition(true);
    } else if (Accept("if")) {
      If();
    } else if (Accept("while")) {
      While();
    } else if (Accept("break")) {
      if (loops_.empty()) Fail("'break' outside of a loop");
      loops_.back().breaks.push_back(Emit(Op::kJump));
    } else if (Accept("continue")) {
      if (loops_.empty()) Fail("'continue' outside of a loop");
      Emit(Op::kJump, loops_.back().start);
    } else if (Accept("return")) {
      if (Peek().kind == Token::Kind::kNewline) {
        Emit(Op::kPush);
      } else {
        Expression();
      }
      Emit(Op::kReturn);
    } else if (Accept("halt")) {
      Emit(Op::kHalt);
    } else if (Accept("kill")) {
      Expression();
      Emit(Op::kKill);
    } else if (Accept("join")) {
      Expression();
      Emit(Op::kJoin);
    } else if (At("enter_critical") || At("exit_critical")) {
      ++at_;  // threads switch only at calls that wait
    } else {
      AssignmentOrCall();
    }
  }

  void AssignmentOrCall() {
    const Op op = Accept("global")  ? Op::kStoreGlobal
                  : Accept("local") ? Op::kStoreLocal
                                    : Op::kStore;
    const bool call = At("run") || tokens_[at_ + 1].text == "(";
    if (call && op == Op::kStore) {
      Expression();
      Emit(Op::kPop);
      return;
    }
    const std::string name = Name();
    const bool item = Accept("[");
    if (item) {
      Expression();
      Expect("]");
    }
    Expect("=");
    Expression();
    Emit(item ? Op::kStoreItem : op, 0, name);
  }

  void If() {
    std::vector<int> ends;
    while (true) {
      Expression();
      Expect(":");
      const int next = Emit(Op::kJumpIfFalse);
      Block();
      ends.push_back(Emit(Op::kJump));
      Land(next);
      if (Accept("elif")) continue;
      if (Accept("else")) {
        Expect(":");
        Block();
      }
      break;
    }
    Expect("end");
    for (const int end : ends) Land(end);
  }

  void While() {
    loops_.push_back({Here(), {}});
    Expression();
    Expect(":");
    const int out = Emit(Op::kJumpIfFalse);
    Block();
    Expect("end");
    Emit(Op::kJump, loops_.back().start);
    Land(out);
    for (const int end : loops_.back().breaks) Land(end);
    loops_.pop_back();
  }

  void Expression() { Or(); }
  void Or() {
    And();
    while (Accept("or")) {
      const int jump = Emit(Op::kOr);
      And();
      Land(jump);
    }
  }
  void And() {
    Not();
    while (Accept("and")) {
      const int jump = Emit(Op::kAnd);
      Not();
      Land(jump);
    }
  }
  void Not() {
    if (Accept("not")) {
      Not();
      Emit(Op::kNot);
    } else {
      Binary(0);
    }
  }
  // Parses an expression that is a comparison, a sum or a product. `level` counts from the lowest
  // precedence to the highest.
  void Binary(std::size_t level) {
    static const std::vector<std::vector<std::string>> kLevels = {
        {"==", "!=", "<=", ">=", "<", ">"}, {"+", "-"}, {"*", "/", "%"}};
    if (level == kLevels.size()) return Unary();
    Binary(level + 1);
    for (bool found = true; found;) {
      found = false;
      for (const std::string& op : kLevels[level]) {
        if (found || !Accept(op)) continue;
        found = true;
        Binary(level + 1);
        Emit(Op::kBinary, 0, op);
      }
    }
  }
  void Unary() {
    if (Accept("-")) {
      Unary();
      Emit(Op::kMinus);
      return;
    }
    Primary();
    while (Accept("[")) {
      Expression();
      Expect("]");
      Emit(Op::kIndex);
    }
  }

  int Arguments(const std::string& close) {
    int n = 0;
    while (!Accept(close)) {
      Expression();
      ++n;
      if (!At(close)) Expect(",");
    }
    return n;
  }

  void Primary() {
    const Token token = Peek();
    if (token.kind == Token::Kind::kNumber) {
      ++at_;
      Emit(Op::kPush, 0, "", Number(token));
    } else if (token.kind == Token::Kind::kString) {
      ++at_;
      Emit(Op::kPush, 0, "", token.text);
    } else if (Accept("True") || Accept("False")) {
      Emit(Op::kPush, 0, "", token.text == "True");
    } else if (Accept("(")) {
      Expression();
      Expect(")");
    } else if (Accept("[")) {
      Emit(Op::kList, Arguments("]"));
    } else if (Accept("run")) {
      const std::string name = Name();
      Expect("(");
      Emit(Op::kRun, Arguments(")"), name);
    } else {
      NameOrCall();
    }
  }

  Value Number(const Token& token) const {
    std::istringstream text(token.text);
    text.imbue(std::locale::classic());
    double x = 0;
    if (!(text >> x) || !text.eof())
      throw Error(token.line, "'" + token.text + "' is not a number");
    return x;
  }

  void NameOrCall() {
    const std::string name = Name();
    if (!Accept("(")) {
      Emit(Op::kLoad, 0, name);
      return;
    }
    const int n = Arguments(")");
    const auto builtin = Builtins().find(name);
    if (builtin == Builtins().end()) {
      Emit(Op::kCall, n, name);
      return;
    }
    if (n < builtin->second.least || n > builtin->second.most)
      Fail("'" + name + "' has the wrong number of arguments");
    Emit(Op::kBuiltin, n, name);
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  Program program_;
  std::vector<Loop> loops_;
};

}  // namespace

const std::map<std::string, Arity>& Builtins() {
  static const std::map<std::string, Arity> kBuiltins = {{"read_input_float_register", {1, 1}},
                                                         {"read_input_integer_register", {1, 1}},
                                                         {"write_output_float_register", {2, 2}},
                                                         {"write_output_integer_register", {2, 2}},
                                                         {"speedj", {2, 3}},
                                                         {"stopj", {1, 1}},
                                                         {"sync", {0, 0}},
                                                         {"sleep", {1, 1}},
                                                         {"get_steptime", {0, 0}},
                                                         {"textmsg", {1, 2}}};
  return kBuiltins;
}

Program Compile(const std::string& text) { return Compiler(text).Run(); }

bool Complete(const std::string& text) {
  std::istringstream lines(text.substr(0, text.rfind('\n') + 1));
  int depth = 0;
  bool any = false;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    first = first.substr(0, first.find_first_of("(:#"));
    if (first == "def" || first == "thread" || first == "if" || first == "while")
      ++depth, any = true;
    if (first == "end") --depth;
  }
  return any && depth == 0;
}

}  // namespace predictor::urscript
