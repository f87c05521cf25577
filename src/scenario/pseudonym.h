// Pseudonyms of the people in a study.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace predictor {

inline constexpr std::size_t kPseudonymLength = 8;

// Eight characters from the digits 2 to 9 and the capitals without I and O, so it can be written
// down. The last character is a check character, so a single mistyped character never yields
// another valid pseudonym. All have the same length, so none is a part of another.
bool IsPseudonym(std::string_view text);
// Made from 35 random bits of the system's generator. Throws std::runtime_error.
std::string DrawPseudonym();

}  // namespace predictor
