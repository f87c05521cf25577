#include "scenario/yaml_scalar.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/text.h"

namespace predictor {
namespace {

bool IsOneOf(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* word) { return text == word; });
}

}  // namespace

bool ReadNumber(const std::string& text, double* number) {
  const bool has_sign = !text.empty() && (text[0] == '-' || text[0] == '+');
  const std::string digits = text.substr(has_sign ? 1 : 0);
  if (IsOneOf(digits, {".inf", ".Inf", ".INF", "inf", "Inf", "INF"})) {
    *number = std::numeric_limits<double>::infinity() * (text[0] == '-' ? -1 : 1);
    return true;
  }
  if (IsOneOf(digits, {".nan", ".NaN", ".NAN", "nan", "NaN", "NAN"})) {
    *number = std::nan("");
    return true;
  }
  // from_chars does not accept '+', but accepts words such as "infinity" that are not YAML.
  if (digits.find_first_not_of("0123456789.eE+-") != std::string::npos) return false;
  if (digits.empty() || digits[0] == '-' || digits[0] == '+') return false;
  const char* end = digits.data() + digits.size();
  const auto result = std::from_chars(digits.data(), end, *number);
  if (result.ptr != end) return false;
  if (result.ec == std::errc::result_out_of_range) {  // too large or too small: 1e999 or 1e-999
    const bool is_small =
        digits.find("e-") != std::string::npos || digits.find("E-") != std::string::npos;
    *number = is_small ? 0 : std::numeric_limits<double>::infinity();
  } else if (result.ec != std::errc()) {
    return false;
  }
  if (text[0] == '-') *number = -*number;
  return true;
}

ScalarKind KindOf(const YamlNode& scalar) {
  if (scalar.quoted) return ScalarKind::kString;
  if (IsOneOf(scalar.text, {"true", "false"})) return ScalarKind::kBool;
  double number = 0;
  return ReadNumber(scalar.text, &number) ? ScalarKind::kNumber : ScalarKind::kString;
}

std::string WriteNumber(double number) {
  std::string text = FormatNumber(number);
  // Older readers treat "1e-05" as a word, because they require a decimal point before the
  // exponent.
  const std::size_t exponent = text.find('e');
  if (exponent != std::string::npos && text.find('.') == std::string::npos) {
    text.insert(exponent, ".0");
  }
  return text;
}

std::string QuoteYaml(const std::string& text) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += {'\\', 'x', kHex[byte >> 4], kHex[byte & 15]};
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

}  // namespace predictor
