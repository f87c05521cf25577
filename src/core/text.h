// Text for people: numbers, lists, quotations, and the nearest of some names. Not for the tick.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace predictor {

// The candidate nearest to `word` by edit distance (insert, delete, replace, swap of neighbours;
// case costs nothing), or "" if none is near enough to be what was meant: more than a third of the
// longer one's letters would have to change. The first of equals wins.
std::string Nearest(const std::string& word, const std::vector<std::string>& candidates);

// "Did you mean X?", or "Known are: a, b, c." when none is near.
std::string Suggestion(const std::string& word, const std::vector<std::string>& candidates);

// The shortest decimal number that reads back as exactly `x` ("0.1", "1e-05", "inf").
std::string FormatNumber(double x);

// Behind the sentence that refuses the angle `x` [rad] because it is beyond low … high [rad]: where
// it is so large that it may be in degrees, and would then be within, a sentence that says so; else
// "".
std::string DegreesHint(double x, double low, double high);

// `x` in quotation marks for a message: control characters escaped, cut after 60 bytes.
std::string Quote(std::string_view x);

// "a, b, c".
std::string Join(const std::vector<std::string>& words, std::string_view separator = ", ");

// As text or in quotation marks within HTML and XML; characters that XML forbids become spaces.
std::string EscapeMarkup(std::string_view text);

}  // namespace predictor
