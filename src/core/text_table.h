// Pads columns of text for a terminal. Widths are counted in characters, not in bytes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace predictor {

// Returns the number of characters of a UTF-8 text. This is the number of bytes that do not
// continue a character.
std::size_t CharactersIn(std::string_view utf8);

// Returns the text, filled up to `width` characters with spaces after or before the text. A longer
// text is returned unchanged.
std::string LeftAligned(std::string_view utf8, std::size_t width);
std::string RightAligned(std::string_view utf8, std::size_t width);

}  // namespace predictor
