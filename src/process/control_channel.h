// Sends lines of JSON between the run and a process alongside it.
#pragma once

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace predictor {

using Json = nlohmann::ordered_json;

inline constexpr std::size_t kLongestControlLine = 4u << 20;  // a scenario is at most 1 MiB

// Writes a line. If `wait` is true, the function blocks until the whole line is written. Without
// `wait`, the function writes only the part of the line that can be written without blocking.
// Returns false if the other side has closed the channel or, without `wait`, if part of the line
// was not written.
inline bool SendLine(int descriptor, const Json& line, bool wait) {
  const std::string text = line.dump() + "\n";
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = send(descriptor, text.data() + sent, text.size() - sent,
                           MSG_NOSIGNAL | (wait ? 0 : MSG_DONTWAIT));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

// Splits the received bytes into lines.
class LineReader {
 public:
  // Blocks until more bytes arrive. Returns false at the end of the stream or if a line exceeds the
  // limit.
  bool Read(int descriptor) {
    char part[65536];
    ssize_t n;
    do n = recv(descriptor, part, sizeof part, 0);
    while (n < 0 && errno == EINTR);
    if (n <= 0 || text_.size() > kLongestControlLine) return false;
    text_.append(part, static_cast<std::size_t>(n));
    return true;
  }
  // Returns the next complete line. A line that is not a JSON object is returned as an empty
  // object.
  std::optional<Json> Next() {
    const std::size_t end = text_.find('\n');
    if (end == std::string::npos) return {};
    Json line = Json::parse(text_.substr(0, end), nullptr, false);
    text_.erase(0, end + 1);
    return line.is_object() ? line : Json::object();
  }

 private:
  std::string text_;
};

}  // namespace predictor
