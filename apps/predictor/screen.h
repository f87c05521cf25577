// Standard error as one place: lines that stay, and below them one that changes (how far it is, or
// what somebody is typing), which the others do not cut.
#pragma once

#include <mutex>
#include <string>

namespace predictor {

// From any thread. Where standard error is no terminal, only the lines are printed.
class Screen {
 public:
  Screen();
  // A line that stays, without its end.
  void Tell(const std::string& line);
  // How far it is; "" for nothing. Not shown while something is typed.
  void Bar(const std::string& bar);
  // What is being typed; "" when it is over.
  void Typed(const std::string& text);

  bool terminal() const { return terminal_; }

 private:
  void Draw();

  std::mutex mutex_;
  bool terminal_, drawn_ = false;
  std::string bar_, typed_;
};

// The only one.
Screen& TheScreen();

// A command that is typed letter by letter, and shown at the screen's bottom.
class TypedLine {
 public:
  // A letter, or a key that erases one; what is no part of a text is not taken: false.
  bool Type(char key);
  // Shows that a command has begun, or goes on.
  void Show() const;
  // What was typed, which is over with it: it stays on the screen, `why` behind it.
  std::string Take(const std::string& why = "");
  bool empty() const { return text_.empty(); }

 private:
  static constexpr std::size_t kMost = 80;
  std::string text_;
};

}  // namespace predictor
