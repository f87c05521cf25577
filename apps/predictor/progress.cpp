#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace predictor {

Progress::Progress(std::string title, double total, bool quiet)
    : title_(std::move(title)),
      total_(total),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { Finish(); }

void Progress::Update(double done, const std::string& note) {
  if (quiet_) return;
  const double share = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 1;
  if (terminal_) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(100) && share < 1) return;
    last_ = now;
    Draw(share, note);
  } else if (static_cast<int>(share * 10) > tenth_) {
    tenth_ = static_cast<int>(share * 10);
    std::fprintf(stderr, "%s: %d %%%s%s\n", title_.c_str(), 10 * tenth_, note.empty() ? "" : " ",
                 note.c_str());
  }
}

void Progress::Draw(double share, const std::string& note) {
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(share * kWidth);
  std::string bar;
  for (int i = 0; i < kWidth; ++i) bar += i < filled ? "█" : "░";
  std::fprintf(stderr, "\r\033[K%s %s %3.0f %% %s", title_.c_str(), bar.c_str(), 100 * share,
               note.c_str());
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::Finish() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

}  // namespace predictor
