#include "progress.h"

#include <algorithm>
#include <cstdio>

#include "core/format.h"
#include "screen.h"

namespace predictor {

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
    TheScreen().Tell(Formatted("%s: %d %%%s%s", title_.c_str(), 10 * tenth_,
                               note.empty() ? "" : " ", note.c_str()));
  }
}

void Progress::Draw(double share, const std::string& note) {
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(share * kWidth);
  std::string bar;
  for (int i = 0; i < kWidth; ++i) bar += i < filled ? "█" : "░";
  TheScreen().Bar(
      Formatted("%s %s %3.0f %% %s", title_.c_str(), bar.c_str(), 100 * share, note.c_str()));
}

void Progress::Finish() { TheScreen().Bar(""); }

}  // namespace predictor
