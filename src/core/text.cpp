#include "core/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>

namespace predictor {
namespace {

constexpr std::size_t kLongestName = 100;  // comparing longer words would take too long

char Lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

// Returns the optimal string alignment distance. Both words must have at most kLongestName
// characters.
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

// Returns whether `word` is `text` without some of its letters.
bool Contains(std::string_view text, std::string_view word) {
  for (const char c : text)
    if (!word.empty() && Lower(c) == Lower(word[0])) word.remove_prefix(1);
  return word.empty();
}

// Returns whether a character is a C1 control character, changes the text direction or breaks the
// line.
bool IsHidden(char32_t c) {
  return (c >= 0x80 && c < 0xa0) || c == 0x061c || c == 0x200e || c == 0x200f ||
         (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

std::string Hex(char32_t number, int digits) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (int i = digits - 1; i >= 0; --i) text += kDigits[number >> (4 * i) & 15U];
  return text;
}

}  // namespace

// This function rejects overlong forms, surrogates and code points beyond U+10FFFF.
Character FirstCharacter(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return {byte(0), 1};
  const std::size_t size = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < size) return {0, 0};
  char32_t code = byte(0) & (0x7fU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return {0, 0};
    code = code << 6U | (byte(i) & 0x3fU);
  }
  const bool too_long = (size == 3 && code < 0x800) || (size == 4 && code < 0x10000);
  if (too_long || (code >= 0xd800 && code < 0xe000) || code > 0x10ffff) return {0, 0};
  return {code, size};
}

std::string Nearest(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.size() > kLongestName) return "";
  std::string nearest;
  std::size_t least = kLongestName;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > kLongestName) continue;
    const std::size_t distance = EditDistance(word, candidate);
    const std::size_t longer = std::max(word.size(), candidate.size());
    const bool nearer = distance < least || (distance == least && Contains(candidate, word) &&
                                             !Contains(nearest, word));
    if (nearer && 3 * distance <= std::max<std::size_t>(longer, 3)) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string Suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string nearest = Nearest(word, candidates);
  if (!nearest.empty()) return "Did you mean " + nearest + "?";
  return "The known names are: " + Join(candidates) + ".";
}

std::string FormatNumber(double x) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), x).ptr;
  return {text.data(), end};
}

std::string DegreesHint(double x, double low, double high) {
  const double degree = std::numbers::pi / 180;
  const double meant = x * degree;
  if (!(std::abs(x) > 2 * std::numbers::pi) || meant < low || meant > high) return "";
  return " A number without a unit is in rad. For degrees, write " + FormatNumber(x) + " deg.";
}

std::string Printable(std::string_view text, Lines lines) {
  std::string printable;
  while (!text.empty()) {
    const auto byte = static_cast<unsigned char>(text[0]);
    const Character c = FirstCharacter(text);
    if (lines == Lines::kMany && (byte == '\n' || byte == '\t'))
      printable += text[0];
    else if (c.bytes == 0 || c.code < 0x20 || c.code == 0x7f)
      printable += "\\x" + Hex(byte, 2);
    else if (IsHidden(c.code))
      printable += "\\u" + Hex(c.code, 4);
    else
      printable += text.substr(0, c.bytes);
    text.remove_prefix(std::max<std::size_t>(c.bytes, 1));
  }
  return printable;
}

std::string Quote(std::string_view x) {
  constexpr std::size_t kMaxShown = 60;
  if (x.size() <= kMaxShown) return "\"" + Printable(x) + "\"";
  // A multi-byte character at the cut is omitted as a whole.
  std::size_t end = kMaxShown;
  while (end > kMaxShown - 3 && (static_cast<unsigned char>(x[end]) & 0xc0) == 0x80) --end;
  return "\"" + Printable(x.substr(0, end)) + "...\"";
}

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kWhite = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kWhite), text.size()));
  return text.substr(0, text.find_last_not_of(kWhite) + 1);
}

std::vector<std::string_view> CellsOf(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    std::size_t end = begin;
    for (bool quoted = false; end < line.size() && (quoted || line[end] != separator); ++end)
      if (line[end] == '"') quoted = !quoted;
    std::string_view cell = Trimmed(line.substr(begin, end - begin));
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
      cell = Trimmed(cell.substr(1, cell.size() - 2));
    cells.push_back(cell);
    begin = end + 1;
  }
  return cells;
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
        // Characters that XML forbids.
        escaped += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
    }
  }
  return escaped;
}

std::string JsonInScript(std::string_view json) {
  std::string escaped;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string_view separator = json.substr(i, 3);
    if (json[i] == '<') {
      escaped += "\\u003c";
    } else if (separator == "\u2028" || separator == "\u2029") {
      escaped += separator == "\u2028" ? "\\u2028" : "\\u2029";
      i += 2;
    } else {
      escaped += json[i];
    }
  }
  return escaped;
}

std::string CsvCell(std::string_view text) {
  const bool formula = !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != text.npos;
  const std::string cell = (formula ? "'" : "") + std::string(text);
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace predictor
