// Lines of JSON between the run and a process beside it.
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

// Blocks until all is written, or writes what goes without. False if the other side is gone.
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

// Lines out of what was read.
class LineReader {
 public:
  // Blocks for more bytes. False at the end, or if a line grows beyond the limit.
  bool Read(int descriptor) {
    char part[65536];
    ssize_t n;
    do n = recv(descriptor, part, sizeof part, 0);
    while (n < 0 && errno == EINTR);
    if (n <= 0 || text_.size() > kLongestControlLine) return false;
    text_.append(part, static_cast<std::size_t>(n));
    return true;
  }
  // The next whole line; a line that is no JSON object is an empty object.
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
