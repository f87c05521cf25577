#include "core/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>

namespace predictor {
namespace {

constexpr std::size_t kLongestName = 100;  // longer words have no neighbours worth the time

char Lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

// Optimal string alignment distance; both words at most kLongestName long.
std::size_t EditDistance(const std::string& a, const std::string& b) {
  using Row = std::array<std::size_t, kLongestName + 1>;
  Row before{}, last{}, row{};
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = Lower(a[i - 1]) == Lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && Lower(a[i - 1]) == Lower(b[j - 2]) &&
                           Lower(a[i - 2]) == Lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = last;
    last = row;
  }
  return last[b.size()];
}

}  // namespace

std::string Nearest(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.size() > kLongestName) return "";
  std::string nearest;
  std::size_t least = kLongestName;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > kLongestName) continue;
    const std::size_t distance = EditDistance(word, candidate);
    const std::size_t longer = std::max(word.size(), candidate.size());
    if (distance < least && 3 * distance <= std::max<std::size_t>(longer, 3)) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string Suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string nearest = Nearest(word, candidates);
  if (!nearest.empty()) return "Did you mean " + nearest + "?";
  return "Known are: " + Join(candidates) + ".";
}

std::string FormatNumber(double x) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), x).ptr;
  return {text.data(), end};
}

std::string DegreesHint(double x, double low, double high) {
  const double degree = std::numbers::pi / 180;
  const double meant = std::round(1e4 * x * degree) / 1e4;
  if (!(std::abs(x) > 2 * std::numbers::pi) || meant < low || meant > high) return "";
  return " Angles are in rad: " + FormatNumber(x) + " degrees are " + FormatNumber(meant) + ".";
}

std::string Quote(std::string_view x) {
  constexpr std::size_t kMost = 60;
  static constexpr char kHex[] = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : x.substr(0, kMost)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      quoted += "\\x";
      quoted += kHex[byte >> 4];
      quoted += kHex[byte & 15];
    } else {
      quoted += c;
    }
  }
  // A character of several bytes may have been cut: drop what is left of it.
  if (x.size() > kMost) {
    while ((static_cast<unsigned char>(quoted.back()) & 0xc0) == 0x80) quoted.pop_back();
    if ((static_cast<unsigned char>(quoted.back()) & 0xc0) == 0xc0) quoted.pop_back();
    quoted += "...";
  }
  return quoted + "\"";
}

std::string Join(const std::vector<std::string>& words, std::string_view separator) {
  std::string joined;
  for (const std::string& word : words) {
    if (!joined.empty()) joined += separator;
    joined += word;
  }
  return joined;
}

std::string EscapeMarkup(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        // What XML does not allow at all.
        escaped += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
    }
  }
  return escaped;
}

}  // namespace predictor
