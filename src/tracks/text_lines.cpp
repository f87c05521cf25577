#include "tracks/text_lines.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "tracks/series.h"

namespace predictor::tracks {
TextLines::TextLines(std::string_view text) : rest_(text) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool TextLines::Next(std::string_view* line) {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  *line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  if (line->ends_with('\r')) line->remove_suffix(1);
  ++number_;
  return true;
}

std::optional<double> NumberIn(std::string_view cell) {
  if (cell.empty()) return kMissing;
  if (cell.size() <= 4) {
    std::string lower(cell);
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
    if (lower == "nan" || lower == "-nan" || lower == "null" || lower == "na") return kMissing;
  }
  if (cell.front() == '+') cell.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) return {};
  if (!(value - value == 0)) return kMissing;  // infinite
  return value;
}

std::string LineOf(const std::string& file, int line) { return file + ":" + std::to_string(line); }

}  // namespace predictor::tracks
