// Progress of long work on standard error: a bar on a terminal, plain lines otherwise.
#pragma once

#include <chrono>
#include <string>

namespace predictor {

class Progress {
 public:
  // total: of whatever Update counts. quiet: prints nothing.
  Progress(std::string title, double total, bool quiet);
  ~Progress();
  // Redraws at most ten times a second (a line every tenth of the way without a terminal).
  // `note`: a few words after the bar.
  void Update(double done, const std::string& note = "");
  void Finish();

 private:
  void Draw(double share, const std::string& note);
  std::string title_;
  double total_;
  bool quiet_;
  int tenth_ = 0;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace predictor
