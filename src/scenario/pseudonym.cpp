#include "scenario/pseudonym.h"

#include <sys/random.h>

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>

namespace predictor {
namespace {

constexpr std::string_view kPseudonymDigits = "23456789ABCDEFGHJKLMNPQRSTUVWXYZ";
static_assert(kPseudonymDigits.size() == 32);

// Returns the check character that makes the weighted sum of all values a multiple of 32, or
// nothing for invalid characters. The weights are 1, 3, 5, ..., and 1 for the check character
// itself. Because the weights are odd, a change of any single value is detected.
std::optional<char> CheckCharacter(std::string_view others) {
  std::size_t sum = 0, factor = 1;
  for (const char c : others) {
    const std::size_t value = kPseudonymDigits.find(c);
    if (value == std::string_view::npos) return {};
    sum += factor * value;
    factor += 2;
  }
  return kPseudonymDigits[(32 - sum % 32) % 32];
}

}  // namespace

bool IsPseudonym(std::string_view text) {
  return text.size() == kPseudonymLength &&
         text.back() == CheckCharacter(text.substr(0, text.size() - 1));
}

std::string DrawPseudonym() {
  std::array<std::uint8_t, kPseudonymLength - 1> random{};
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    throw std::runtime_error("The system provides no random numbers.");
  std::string text;
  for (const std::uint8_t byte : random) text += kPseudonymDigits[byte % kPseudonymDigits.size()];
  return text + CheckCharacter(text).value();
}

}  // namespace predictor
