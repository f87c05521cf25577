#include "core/text_table.h"

#include <algorithm>

namespace predictor {
namespace {

std::string SpaceBeside(std::string_view utf8, std::size_t width) {
  const std::size_t characters = CharactersIn(utf8);
  return std::string(width > characters ? width - characters : 0, ' ');
}

}  // namespace

std::size_t CharactersIn(std::string_view utf8) {
  return static_cast<std::size_t>(std::ranges::count_if(
      utf8, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string LeftAligned(std::string_view utf8, std::size_t width) {
  return std::string(utf8) + SpaceBeside(utf8, width);
}

std::string RightAligned(std::string_view utf8, std::size_t width) {
  return SpaceBeside(utf8, width) + std::string(utf8);
}

}  // namespace predictor
