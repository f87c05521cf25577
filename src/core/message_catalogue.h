// Texts shown at the console, on the page, in the headset and in reports. Each text has an ID in
// message_catalogue.json. The page imports this file too. Not for use in the tick.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace predictor {

struct CatalogueEntry {
  std::string_view id, text;
};

inline constexpr CatalogueEntry kMessageCatalogue[] = {
#include "message_table.inc"
};

// Returns the text of an ID, or "" if the catalogue does not contain it.
constexpr std::string_view FindMessage(std::string_view id) {
  for (const CatalogueEntry& entry : kMessageCatalogue)
    if (entry.id == id) return entry.text;
  return {};
}

// This function has no definition and is not constexpr. A constant expression cannot call such a
// function, so code with an unknown ID does not compile.
void RejectUnknownMessageId();

// The ID of a text in the catalogue. Code with an unknown literal does not compile.
class MessageId {
 public:
  consteval MessageId(const char* id) : text_(FindMessage(id)) {  // NOLINT: converts a literal
    if (text_.empty()) RejectUnknownMessageId();
  }
  constexpr std::string_view text() const { return text_; }

 private:
  std::string_view text_;
};

// Replaces the placeholder {name} in a text.
struct MessageValue {
  std::string_view name;
  std::string value;
};

std::string FillIn(std::string_view text, std::initializer_list<MessageValue> values = {});
inline std::string Message(MessageId id, std::initializer_list<MessageValue> values = {}) {
  return FillIn(id.text(), values);
}
// Returns the text of an ID that is composed at run time, or the ID itself if the catalogue does
// not contain it.
std::string MessageOf(std::string_view id, std::initializer_list<MessageValue> values = {});

}  // namespace predictor
