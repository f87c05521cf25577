// Writes permanent lines to standard error and, below these lines, one changing line: the progress,
// or the command that the operator is typing.
#pragma once

#include <mutex>
#include <string>

namespace predictor {

// The terminal of the operator, which all threads share. Without a terminal, or with TERM=dumb, the
// screen prints only the permanent lines. The screen first makes all text printable, because some
// texts come from files, other processes and robots.
class Screen {
 public:
  Screen();
  // Prints a permanent line. `line` has no newline.
  void Print(const std::string& line);
  // Shows progress, or hides it if `bar` is "". The progress is hidden while a command is being
  // typed.
  void Bar(const std::string& bar);
  // Shows the command being typed, or "" when typing has ended.
  void Typed(const std::string& text);

  bool terminal() const { return terminal_; }

 private:
  void Draw();

  std::mutex mutex_;
  bool terminal_ = false, drawn_ = false;
  std::string bar_, typed_;
};

// Returns the only instance.
Screen& TheScreen();

// A command that the operator types letter by letter. The command is shown at the bottom of the
// screen.
class TypedLine {
 public:
  // Adds a letter or erases the last letter. If the key neither adds nor erases a letter, ignores
  // the key and returns false.
  bool Type(char key);
  // Shows that a command has begun or continues.
  void Show() const;
  // Ends typing and returns the text. The text stays on the screen, followed by `why`.
  std::string Take(const std::string& why = "");
  bool empty() const { return text_.empty(); }

 private:
  static constexpr std::size_t kMaxTyped = 80;
  std::string text_;
};

}  // namespace predictor
