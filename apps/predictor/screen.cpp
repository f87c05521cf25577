#include "screen.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "core/text.h"

namespace predictor {

Screen& TheScreen() {
  static Screen screen;
  return screen;
}

Screen::Screen() {
  const char* term = std::getenv("TERM");
  terminal_ = isatty(STDERR_FILENO) == 1 && term != nullptr && std::string(term) != "dumb";
}

void Screen::Print(const std::string& line) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (std::exchange(drawn_, false)) std::fputs("\r\033[K", stderr);
  std::fprintf(stderr, "%s\n", Printable(line, Lines::kMany).c_str());
  Draw();
}

void Screen::Bar(const std::string& bar) {
  const std::lock_guard<std::mutex> lock(mutex_);
  bar_ = bar;
  if (typed_.empty()) Draw();
}

void Screen::Typed(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  typed_ = text;
  Draw();
}

void Screen::Draw() {
  const std::string& below = typed_.empty() ? bar_ : typed_;
  if (!terminal_ || (below.empty() && !drawn_)) return;
  std::fprintf(stderr, "\r\033[K%s", Printable(below).c_str());
  std::fflush(stderr);
  drawn_ = !below.empty();
}

bool TypedLine::Type(char key) {
  constexpr char kDelete = 127;
  if (key == kDelete || key == '\b') {
    if (!text_.empty()) text_.pop_back();
  } else if (static_cast<unsigned char>(key) < ' ') {
    return false;
  } else if (text_.size() < kMaxTyped) {
    text_.push_back(key);
  }
  Show();
  return true;
}

void TypedLine::Show() const { TheScreen().Typed(": " + text_); }

std::string TypedLine::Take(const std::string& why) {
  TheScreen().Typed("");
  TheScreen().Print(": " + text_ + why);
  return std::exchange(text_, "");
}

}  // namespace predictor
