// Pseudonyms of the people in a study.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace predictor {

inline constexpr std::size_t kPseudonymLength = 8;

// Returns whether a text is a pseudonym: eight characters, digits 2 to 9 and capitals without I and
// O, which people can write down. The last character is a check character, so a single mistyped
// character never yields another valid pseudonym. All pseudonyms have the same length, so no
// pseudonym is a part of another one.
bool IsPseudonym(std::string_view text);
// Makes a pseudonym from 35 random bits of the system's generator. Throws std::runtime_error.
std::string DrawPseudonym();

}  // namespace predictor
