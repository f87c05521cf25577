#include "scenario/trajectory_file.h"

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "scenario/own_parameters.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

using Kind = YamlNode::Kind;

constexpr std::size_t kMaxBytes = 1u << 20;  // one byte less than ReadYamlText reads
constexpr const char* kFileKey = "trajectory_file";
constexpr const char* kListKey = "trajectory";
constexpr std::string_view kPosition = "time,x,y,z", kPose = "time,x,y,z,roll,pitch,yaw";

YamlNode NodeAt(Kind kind, const Place& place, std::string key = "") {
  YamlNode node;
  node.kind = kind;
  node.place = node.key_place = place;
  node.key = std::move(key);
  return node;
}

std::vector<YamlNode> NodesOf(std::string_view line, Place place) {
  std::vector<YamlNode> nodes;
  for (const std::string_view cell : CellsOf(line)) {
    place.column = static_cast<int>(cell.data() - line.data()) + 1;
    nodes.push_back(NodeAt(Kind::kScalar, place));
    nodes.back().text = cell;
  }
  return nodes;
}

YamlNode ListOfThree(const char* key, const std::vector<YamlNode>& cells, std::size_t first) {
  YamlNode list = NodeAt(Kind::kList, cells[first].place, key);
  for (std::size_t i = first; i < first + 3; ++i) list.items.push_back(cells[i]);
  return list;
}

YamlNode WaypointOf(std::vector<YamlNode> cells, const Place& place) {
  YamlNode waypoint = NodeAt(Kind::kMap, place);
  cells[0].key = "time";
  waypoint.items.push_back(cells[0]);
  waypoint.items.push_back(ListOfThree("xyz", cells, 1));
  if (cells.size() > 4) waypoint.items.push_back(ListOfThree("rpy", cells, 4));
  return waypoint;
}

void CheckHeader(const std::vector<YamlNode>& cells, const Place& place) {
  std::vector<std::string> words;
  for (const YamlNode& cell : cells) words.push_back(cell.text);
  const std::string header = Join(words, ",");
  if (header != kPosition && header != kPose)
    throw InputError(place.Text(), "the header is " + Quote(header) + "; it must be " +
                                       std::string(kPosition) + " or " + std::string(kPose) + ".");
}

// Controllers without these parameters refuse the key later.
bool HasTrajectoryFile(const YamlNode& controller) {
  const YamlNode* type = controller.Find("type");
  const ParameterKind* kind = FindKind(Controllers(), type ? type->text : ControllerSpec().type);
  return kind == nullptr || WriteParameters(kind->parameters().get()).Find(kFileKey) != nullptr;
}

}  // namespace

YamlNode ParseWaypoints(const std::string& text, const std::string& name) {
  Place place = {std::make_shared<const std::string>(name), 0, 1};
  if (text.size() > kMaxBytes)
    throw InputError(name, "the file has more than " + std::to_string(kMaxBytes) +
                               " bytes. Keep at most " + std::to_string(kMaxWaypoints) + " rows.");
  YamlNode list = NodeAt(Kind::kList, place, kListKey);
  std::size_t columns = 0;
  for (std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = std::string_view(text).substr(begin, end - begin);
    if (line.ends_with('\r')) line.remove_suffix(1);
    begin = end + 1;
    ++place.line;
    if (Trimmed(line).empty()) continue;
    std::vector<YamlNode> cells = NodesOf(line, place);
    if (columns == 0) {
      CheckHeader(cells, place);
      columns = cells.size();
      continue;
    }
    if (cells.size() != columns)
      throw InputError(place.Text(), "this row has " + std::to_string(cells.size()) +
                                         " values; the header has " + std::to_string(columns) +
                                         ". Give one value for each column.");
    if (list.items.size() == kMaxWaypoints)
      throw InputError(place.Text(), "there are more than " + std::to_string(kMaxWaypoints) +
                                         " waypoints. Leave out some rows; the set-point moves "
                                         "smoothly from each row to the next.");
    list.items.push_back(WaypointOf(std::move(cells), place));
  }
  if (list.items.empty())
    throw InputError(name, "the file has no waypoints. Begin the file with the header " +
                               std::string(kPosition) + ", and add a row for each waypoint.");
  return list;
}

void ExpandTrajectoryFile(const std::filesystem::path& folder, YamlNode* root) {
  YamlNode* cobot = root->Find("cobot");
  YamlNode* controller = cobot ? cobot->Find("controller") : nullptr;
  YamlNode* file = controller ? controller->Find(kFileKey) : nullptr;
  if (file == nullptr || file->kind != Kind::kScalar || file->text.empty() ||
      !HasTrajectoryFile(*controller))
    return;
  const std::string key = std::string("cobot.controller.") + kFileKey;
  YamlNode* list = controller->Find(kListKey);
  if (list != nullptr && !list->items.empty())
    throw InputError(file->place.Text(),
                     key + ": there is also a " + kListKey +
                         ". Remove one of the two keys, or set it to \"\" or [].");
  std::filesystem::path found;
  try {
    found = ResolveModelPath(file->text, folder);
  } catch (const InputError& error) {
    throw InputError(file->place.Text(), key + ": " + error.what());
  }
  YamlNode waypoints =
      ParseWaypoints(ReadYamlText(found, "a trajectory"), (folder / file->text).string());
  file->text.clear();
  file->quoted = true;
  if (list != nullptr)
    *list = std::move(waypoints);
  else
    controller->items.push_back(std::move(waypoints));
}

}  // namespace predictor
