#include "core/message_catalogue.h"

#include <algorithm>

namespace predictor {

std::string FillIn(std::string_view text, std::initializer_list<MessageValue> values) {
  std::string filled;
  while (!text.empty()) {
    const std::size_t open = text.find('{');
    filled += text.substr(0, open);
    if (open == std::string_view::npos) break;
    const std::size_t close = text.find('}', open);
    const std::string_view name =
        close == std::string_view::npos ? "" : text.substr(open + 1, close - open - 1);
    const auto* found = std::ranges::find(values, name, &MessageValue::name);
    if (close == std::string_view::npos || found == values.end()) {
      filled += '{';
      text.remove_prefix(open + 1);
    } else {
      filled += found->value;
      text.remove_prefix(close + 1);
    }
  }
  return filled;
}

std::string MessageOf(std::string_view id, std::initializer_list<MessageValue> values) {
  const std::string_view text = FindMessage(id);
  return text.empty() ? std::string(id) : FillIn(text, values);
}

}  // namespace predictor
