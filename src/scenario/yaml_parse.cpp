#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>
#include <unordered_set>

#include "core/error.h"
#include "core/text.h"
#include "scenario/yaml_tree.h"

namespace predictor {
namespace {

constexpr int kMaxBrackets = 20000;
constexpr const char* kNoAliases =
    "anchors (&) and aliases (*) are not allowed. Write the value itself at each place where it is "
    "used.";

using Source = std::shared_ptr<const std::string>;

// Builds the tree from the parser's events. Stops the parser (by InputError) at forbidden content.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const Source& source, YamlNode* root) : source_(source), root_(root) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnAnchor(const YAML::Mark& mark, const std::string& name) override {
    Refuse(mark, std::string(kNoAliases) + " The anchor is " + Quote(name) + ".");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { Refuse(mark, kNoAliases); }

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (ExpectsKey()) Refuse(mark, "a key is missing before the colon.");
    Add(mark, YamlNode::Kind::kNull);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& text) override {
    CheckTag(mark, tag);
    if (tag == "!") last_quoted_ = mark;
    if (ExpectsKey()) return TakeKey(mark, text);
    YamlNode* node = Add(mark, YamlNode::Kind::kScalar);
    node->text = text;
    node->quoted = tag == "!";
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    Open(mark, tag, YamlNode::Kind::kList);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    Open(mark, tag, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { open_.pop_back(); }

  // Detects a quotation that is never closed, because the parser treats it as closed at the end of
  // the text.
  void CheckLastQuote(const std::string& text) const {
    auto i = static_cast<std::size_t>(last_quoted_.pos);
    if (last_quoted_.is_null() || i >= text.size()) return;
    const char quote = text[i];
    if (quote != '"' && quote != '\'') return;  // a block of text
    for (++i; i < text.size(); ++i) {
      if (quote == '"' && text[i] == '\\') {
        ++i;
      } else if (text[i] == quote) {
        if (quote == '"' || i + 1 >= text.size() || text[i + 1] != quote) return;
        ++i;  // two single quotes represent one
      }
    }
    Refuse(last_quoted_, "a quotation mark opens here but is not closed. Close it.");
  }

 private:
  struct Level {
    YamlNode* node;
    std::unordered_set<std::string> keys;
    bool has_key = false;  // a key was read and its value follows
    std::string key;
    Place key_place;
  };

  Place At(const YAML::Mark& mark) const { return {source_, mark.line + 1, mark.column + 1}; }

  [[noreturn]] void Refuse(const YAML::Mark& mark, const std::string& sentence) const {
    throw InputError(At(mark).Text(), sentence);
  }

  // The parser returns "?" for a plain scalar and "!" for a quoted scalar.
  void CheckTag(const YAML::Mark& mark, const std::string& tag) const {
    if (tag.empty() || tag == "?" || tag == "!") return;
    Refuse(mark, "tags are not allowed, but here is " + Quote(tag) + ". Remove it.");
  }

  bool ExpectsKey() const {
    return !open_.empty() && open_.back().node->kind == YamlNode::Kind::kMap &&
           !open_.back().has_key;
  }

  void TakeKey(const YAML::Mark& mark, const std::string& key) {
    Level& level = open_.back();
    if (!level.keys.insert(key).second) {
      Refuse(mark, "the key " + Quote(key) + " occurs twice in the same group, first at " +
                       level.node->Find(key)->key_place.Text() + ". Remove one.");
    }
    level.has_key = true;
    level.key = key;
    level.key_place = At(mark);
  }

  // Pointers to open nodes stay valid, because only the innermost list or map grows.
  YamlNode* Add(const YAML::Mark& mark, YamlNode::Kind kind) {
    if (++nodes_ > kMaxYamlNodes) {
      Refuse(mark, "the file contains more than " + std::to_string(kMaxYamlNodes) +
                       " values. Shorten it.");
    }
    YamlNode* node = root_;
    if (!open_.empty()) {
      Level& level = open_.back();
      node = &level.node->items.emplace_back();
      if (level.has_key) {
        node->key = level.key;
        node->key_place = level.key_place;
        level.has_key = false;
      }
    }
    node->kind = kind;
    node->place = At(mark);
    return node;
  }

  void Open(const YAML::Mark& mark, const std::string& tag, YamlNode::Kind kind) {
    CheckTag(mark, tag);
    if (ExpectsKey())
      Refuse(mark,
             "here is a list or a group instead of a key. Close every bracket, and use a word as "
             "each key.");
    if (open_.size() >= kMaxYamlDepth) {
      Refuse(mark, "lists and groups are nested deeper than " + std::to_string(kMaxYamlDepth) +
                       " levels. Flatten them.");
    }
    open_.push_back({Add(mark, kind), {}, false, {}, {}});
  }

  Source source_;
  YamlNode* root_;
  std::vector<Level> open_;
  int nodes_ = 0;
  YAML::Mark last_quoted_ = YAML::Mark::null_mark();
};

// Refuses content that must not reach the parser. Brackets are counted everywhere. The parser reads
// ahead through open brackets before it reports any event, and needs a quarter of a kilobyte for
// each open bracket.
void CheckBytes(const std::string& text, const Source& source) {
  if (text.size() > kMaxYamlBytes) {
    throw InputError(*source, "the file has more than " + std::to_string(kMaxYamlBytes) +
                                  " bytes, which is too large for a scenario. Give another file.");
  }
  if (std::count_if(text.begin(), text.end(), [](char c) { return c == '[' || c == '{'; }) >
      kMaxBrackets) {
    throw InputError(*source, "the file has more than " + std::to_string(kMaxBrackets) +
                                  " opening brackets. Shorten it.");
  }
  Place place{source, 1, 1};
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    const std::size_t length = FirstCharacter(std::string_view(text).substr(i)).bytes;
    if (length == 0) throw InputError(place.Text(), "the file is not UTF-8. Save it as UTF-8.");
    const bool is_space = c == '\n' || c == '\r' || c == '\t';
    if (static_cast<unsigned char>(c) < 0x20 && !is_space) {
      throw InputError(place.Text(), "here is a control character. Remove it.");
    }
    i += length;
    place.line += c == '\n';
    place.column = c == '\n' ? 1 : place.column + 1;
  }
}

}  // namespace

YamlNode ParseYaml(const std::string& file_text, const std::string& source_name) {
  const auto source = std::make_shared<const std::string>(source_name);
  const std::string text = file_text.substr(file_text.rfind("\xef\xbb\xbf", 0) == 0 ? 3 : 0);
  CheckBytes(text, source);
  YamlNode root;
  root.place = {source, 0, 0};
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder builder(source, &root);
    if (!parser.HandleNextDocument(builder)) return root;
    YamlNode second;
    TreeBuilder rest(source, &second);
    if (parser.HandleNextDocument(rest)) {
      throw InputError(second.place.Text(),
                       "a second document begins here. A file must contain only one document.");
    }
    builder.CheckLastQuote(text);
  } catch (const YAML::Exception& error) {
    const Place place{source, error.mark.line + 1, error.mark.column + 1};
    const bool is_alias = error.msg.find("anchor") != std::string::npos;
    throw InputError(
        error.mark.is_null() ? source_name : place.Text(),
        is_alias ? std::string(kNoAliases) : "this is not valid YAML: " + error.msg + ".");
  }
  return root;
}

}  // namespace predictor
