// Limits the number of messages that a process alongside the run shows to the user, so that the
// user can read them.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace predictor {

class SaidFilter {
 public:
  static constexpr std::size_t kLongest = 16'384;           // bytes per message
  static constexpr double kMaxAtOnce = 30, kPerSecond = 5;  // messages
  using Time = std::chrono::steady_clock::time_point;

  explicit SaidFilter(std::string name) : name_(std::move(name)) {}  // name of the process

  static std::string Shortened(const std::string& text) {
    return text.size() <= kLongest ? text : text.substr(0, kLongest) + " ...";
  }

  // Returns the messages to show for `text`, which was received at `now`. If there were too many
  // messages recently, no message is returned. The text is shortened if necessary. If messages were
  // omitted before, a message with their number precedes the text.
  std::vector<std::string> Take(const std::string& text, Time now) {
    const std::chrono::duration<double> since = now - std::exchange(last_, now);
    room_ = std::min(kMaxAtOnce, room_ + kPerSecond * since.count());
    if (room_ < 1) {
      ++left_out_;
      return {};
    }
    room_ -= 1;
    std::vector<std::string> shown = {Shortened(text)};
    if (const int count = std::exchange(left_out_, 0); count > 0)
      shown.insert(shown.begin(),
                   name_ + " sent too many messages: " + std::to_string(count) + " are not shown.");
    return shown;
  }

 private:
  std::string name_;
  double room_ = kMaxAtOnce;
  Time last_;
  int left_out_ = 0;
};

}  // namespace predictor
