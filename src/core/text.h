// Formats text for users: numbers, lists, quotations and the closest names. Not for use in the
// tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace predictor {

// Returns the candidate with the smallest edit distance to `word`. The edits are to insert, delete
// or replace a letter and to swap neighbours. A change of case costs nothing. Returns "" if more
// than a third of the longer word's letters would have to change. If several candidates are equally
// close, one that only needs letters added to `word` is preferred, and otherwise the first one.
std::string Nearest(const std::string& word, const std::vector<std::string>& candidates);

// Returns "Did you mean X?", or "The known names are: a, b, c." if no candidate is close.
std::string Suggestion(const std::string& word, const std::vector<std::string>& candidates);

// Returns the shortest decimal number that is read back as exactly `x` ("0.1", "1e-05", "inf").
std::string FormatNumber(double x);

// Returns a text to be appended to the message that refuses an angle `x` [rad] because it is
// outside the range from low to high [rad]. If the number `x`, read in degrees, is within these
// limits, the text is a sentence. Otherwise, the text is "".
std::string DegreesHint(double x, double low, double high);

// The first character of a UTF-8 text. If the size of the character is 0 bytes, the text does not
// begin with a valid character (RFC 3629).
struct Character {
  char32_t code;
  std::size_t bytes;
};
Character FirstCharacter(std::string_view text);

// Returns the FNV-1a hash of a text, continued from `hash`. The hash does not protect against
// deliberate changes of the text.
constexpr std::uint64_t Fnv1a(std::string_view text, std::uint64_t hash = 0xcbf29ce484222325ULL) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

// Makes text of unknown origin safe for a terminal. The function replaces the following by escapes
// ("\x1b", "\u202e"): control characters (C0, DEL, C1), characters that change the text direction
// (Unicode's bidirectional marks, embeddings, overrides and isolates), line separators, and bytes
// that are not UTF-8. With kMany, line feeds and tabs remain unchanged.
enum class Lines { kOne, kMany };
std::string Printable(std::string_view text, Lines lines = Lines::kOne);

// Returns `x` in quotation marks for a message. The text is made printable and truncated to 60
// bytes.
std::string Quote(std::string_view x);

// Returns the text without the spaces, tabs and line ends around it.
std::string_view Trimmed(std::string_view text);

// Returns the cells of one line of a table, without the white space and the quotation marks around
// them. A separator inside quotation marks belongs to its cell.
std::vector<std::string_view> CellsOf(std::string_view line, char separator = ',');

// Returns "a, b, c".
std::string Join(const std::vector<std::string>& words, std::string_view separator = ", ");

// Escapes text for HTML and XML, including quoted attributes. Characters that XML forbids become
// spaces.
std::string EscapeMarkup(std::string_view text);

// Returns the same JSON without "<" and line separators, so that the text is safe in an HTML script
// element.
std::string JsonInScript(std::string_view json);

// Returns one cell of a CSV table (RFC 4180), quoted if necessary. If the text begins with =, +, -,
// @, a tab or a carriage return, an apostrophe is placed in front, so that spreadsheets do not
// treat the text as a formula. Do not use this function for numbers.
std::string CsvCell(std::string_view text);

}  // namespace predictor
