// Shows the progress of long tasks on standard error: a bar on a terminal, plain lines otherwise.
#pragma once

#include <chrono>
#include <string>

namespace predictor {

// Returns the remaining time, for example "12 min left", after `elapsed` [s], given the completed
// share of the work (0 to 1). Returns "" while the remaining time is unknown.
std::string RemainingText(double share, double elapsed);

class Progress {
 public:
  // `total` is the value that the last call of Update passes. If `quiet` is true, nothing is
  // printed.
  Progress(std::string title, double total, bool quiet);
  ~Progress();
  // Redraws at most ten times per second. If there is no terminal, prints a line for each tenth of
  // the work. `note` is a short text that is shown after the bar.
  void Update(double done, const std::string& note = "");
  void Finish();

 private:
  double Elapsed() const;  // [s]
  void Draw(double share, const std::string& note);
  std::string title_;
  double total_;
  bool quiet_;
  int tenth_ = 0;
  std::chrono::steady_clock::time_point last_{};
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace predictor
