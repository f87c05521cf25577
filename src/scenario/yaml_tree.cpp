#include "scenario/yaml_tree.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "scenario/yaml_scalar.h"

namespace predictor {
namespace {

constexpr std::size_t kCommentColumn = 48;

// Takes one step along a path, which is a key of a map or an index of a list. Returns null if the
// key or index does not exist.
const YamlNode* Step(const std::string& step, const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kList) return node.Find(step);
  std::size_t i = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), i);
  const bool is_number = error == std::errc() && end == step.data() + step.size();
  return is_number && i < node.items.size() ? &node.items[i] : nullptr;
}

// Follows the path of an override and creates missing keys.
YamlNode* Descend(const std::string& step, const Place& place, YamlNode* node) {
  if (node->kind == YamlNode::Kind::kList) {
    if (const YamlNode* entry = Step(step, *node)) return const_cast<YamlNode*>(entry);
    throw InputError(place.Text(), "entry " + Quote(step) + " does not exist in a list of " +
                                       std::to_string(node->items.size()) +
                                       ". Entries are counted from 0.");
  }
  if (node->kind != YamlNode::Kind::kMap) {  // a group replaces the value
    node->kind = YamlNode::Kind::kMap;
    node->place = place;
    node->text.clear();
  }
  if (YamlNode* item = node->Find(step)) return item;
  YamlNode& item = node->items.emplace_back();
  item.place = item.key_place = place;
  item.key = step;
  return &item;
}

std::string Inline(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return "null";
    case YamlNode::Kind::kScalar:
      return node.quoted ? QuoteYaml(node.text) : node.text;
    case YamlNode::Kind::kMap:
      return "{}";
    case YamlNode::Kind::kList:
      break;
  }
  std::vector<std::string> items;
  for (const YamlNode& item : node.items) items.push_back(Inline(item));
  return "[" + Join(items) + "]";
}

bool IsBlock(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kMap) return !node.items.empty();
  return node.kind == YamlNode::Kind::kList && !node.items.empty() &&
         node.items.front().kind == YamlNode::Kind::kMap;
}

void AppendComment(const std::string& comment, std::size_t line_start, std::string* out) {
  if (comment.empty()) return;
  const std::size_t width = out->size() - line_start;
  out->append(width < kCommentColumn ? kCommentColumn - width : 1, ' ');
  *out += " # " + comment;
}

// If `indented` is true, the indentation of the first line (the "- " of a list) has already been
// written.
void WriteBlock(const YamlNode& node, std::size_t indent, bool indented, std::string* out) {
  for (const YamlNode& item : node.items) {
    const std::size_t line_start = indented ? out->rfind('\n') + 1 : out->size();
    if (!indented) out->append(indent, ' ');
    indented = false;
    if (node.kind == YamlNode::Kind::kList) {
      *out += "- ";
      WriteBlock(item, indent + 2, true, out);
      continue;
    }
    *out += item.key + ":";
    if (!IsBlock(item)) *out += " " + Inline(item);
    AppendComment(item.comment, line_start, out);
    *out += '\n';
    if (IsBlock(item)) WriteBlock(item, indent + 2, false, out);
  }
}

// The innermost existing node on the path, and whether this node is the end of the path.
const YamlNode* Innermost(const std::string& path, const YamlNode& root, bool* is_found) {
  const YamlNode* node = &root;
  *is_found = false;
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const YamlNode* next = Step(path.substr(begin, end - begin), *node);
    if (next == nullptr) return node;
    node = next;
    begin = end + 1;
  }
  *is_found = true;
  return node;
}

}  // namespace

std::string Place::Text() const {
  if (source == nullptr) return "";
  if (line == 0) return *source;
  return *source + ":" + std::to_string(line) + ":" + std::to_string(column);
}

const YamlNode* YamlNode::Find(const std::string& name) const {
  if (kind != Kind::kMap) return nullptr;
  const auto found = std::find_if(items.begin(), items.end(),
                                  [&](const YamlNode& item) { return item.key == name; });
  return found == items.end() ? nullptr : &*found;
}

YamlNode* YamlNode::Find(const std::string& name) {
  return const_cast<YamlNode*>(std::as_const(*this).Find(name));
}

const YamlNode* NodeAt(const std::string& path, const YamlNode& root) {
  bool is_found = false;
  const YamlNode* node = Innermost(path, root, &is_found);
  return is_found ? node : nullptr;
}

Place PlaceOf(const std::string& path, const YamlNode& root) {
  bool is_found = false;
  return Innermost(path, root, &is_found)->place;
}

void ApplyOverride(const std::string& assignment, YamlNode* root) {
  const std::size_t equals = assignment.find('=');
  const std::string path = assignment.substr(0, equals);
  const auto source = std::make_shared<const std::string>("--set " + path);
  const Place place{source, 0, 0};
  if (equals == std::string::npos) {
    throw InputError("--set " + Quote(assignment) + ": \"=\" is missing. Write path.to.key=value.");
  }
  if (std::count(path.begin(), path.end(), '.') >= kMaxYamlDepth) {
    throw InputError("--set " + Quote(path) + ": the path is too long.");
  }
  YamlNode value = ParseYaml(assignment.substr(equals + 1), *source);
  YamlNode* node = root;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    if (end == begin) throw InputError(place.Text(), "the path has an empty part.");
    node = Descend(path.substr(begin, end - begin), place, node);
    begin = end + 1;
  }
  value.key = node->key;
  value.key_place = node->key_place;
  value.place = place;
  *node = std::move(value);
}

std::string WriteYaml(const YamlNode& root) {
  std::string out;
  WriteBlock(root, 0, false, &out);
  return out;
}

std::string ReadYamlText(const std::filesystem::path& file, const std::string& what) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status))
    throw InputError(file.string(), "the file does not exist. Give the path of " + what + ".");
  if (!fs::is_regular_file(status))
    throw InputError(file.string(), "this is not a file. Give the path of " + what + ".");
  // One byte more than permitted shows that the text is too long.
  return ReadWholeFile(file, kMaxYamlBytes + 1);
}

}  // namespace predictor
