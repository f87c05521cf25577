#include "progress.h"

#include <algorithm>
#include <cstdlib>

#include "core/format.h"
#include "screen.h"

namespace predictor {
namespace {

// Returns whether the terminal's character set is UTF-8.
bool HasUtf8() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const std::string locale = value;
    return locale.find("UTF-8") != std::string::npos || locale.find("utf8") != std::string::npos;
  }
  return false;
}

}  // namespace

std::string RemainingText(double share, double elapsed) {
  constexpr double kSoonest = 5;  // earlier estimates would vary too much [s]
  if (share <= 0 || share >= 1 || elapsed < kSoonest) return "";
  const double left = elapsed * (1 - share) / share;
  if (left >= 5400) return Formatted("%.0f h left", left / 3600);
  return left >= 90 ? Formatted("%.0f min left", left / 60) : Formatted("%.0f s left", left);
}

Progress::Progress(std::string title, double total, bool quiet)
    : title_(std::move(title)), total_(total), quiet_(quiet) {}

Progress::~Progress() { Finish(); }

void Progress::Update(double done, const std::string& note) {
  if (quiet_) return;
  const double share = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 1;
  if (TheScreen().terminal()) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(100) && share < 1) return;
    last_ = now;
    Draw(share, note);
  } else if (static_cast<int>(share * 10) > tenth_) {
    tenth_ = static_cast<int>(share * 10);
    const std::string left = RemainingText(share, Elapsed());
    TheScreen().Print(Formatted("%s: %d %%%s%s%s%s", title_.c_str(), 10 * tenth_,
                                left.empty() ? "" : ", ", left.c_str(), note.empty() ? "" : ", ",
                                note.c_str()));
  }
}

void Progress::Draw(double share, const std::string& note) {
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(share * kWidth);
  const bool blocks = HasUtf8();
  std::string bar;
  for (int i = 0; i < kWidth; ++i)
    bar += blocks ? (i < filled ? "█" : "░") : (i < filled ? "#" : ".");
  TheScreen().Bar(Formatted("%s %s %3.0f %% %s %s", title_.c_str(), bar.c_str(), 100 * share,
                            RemainingText(share, Elapsed()).c_str(), note.c_str()));
}

double Progress::Elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::Finish() { TheScreen().Bar(""); }

}  // namespace predictor
