#include "tracks/track_map.h"

#include "core/error.h"
#include "core/text.h"
#include "scenario/field_reader.h"
#include "tracks/read_map.h"
#include "tracks/track_map_fields.h"

namespace predictor::tracks {
namespace {

void CheckCount(const std::vector<std::string>& names, std::size_t all, const std::string& path,
                const YamlNode& root, Problems* problems) {
  if (names.empty() || names.size() == 1 || names.size() == all) return;
  problems->Add(PlaceOf(path, root), path + " has " + std::to_string(names.size()) +
                                         " names. Give " + std::to_string(all) +
                                         " channels, or one name.");
}

void CheckPart(const PartMap& part, const std::string& path, const YamlNode& root,
               Problems* problems) {
  const auto add = [&](const std::string& sentence) {
    problems->Add(PlaceOf(path, root), path + sentence);
  };
  CheckCount(part.position, 3, path + ".position", root, problems);
  CheckCount(part.rotation, 4, path + ".rotation", root, problems);
  const bool sides =
      !part.front.empty() || !part.back.empty() || !part.left.empty() || !part.right.empty();
  const bool all_sides =
      !part.front.empty() && !part.back.empty() && !part.left.empty() && !part.right.empty();
  if (part.position.empty() == part.markers.empty()) add(" needs either position or markers.");
  if (sides && !all_sides) add(" needs markers for all of front, back, left and right, or none.");
  if (sides && !part.rotation.empty()) add(" has a rotation and also markers on its sides.");
  if (!sides && part.rotation.empty() && (part.xyz.norm() > 0 || part.rpy.norm() > 0))
    add(" has xyz or rpy, which need a measured rotation. Give the rotation, or markers on the "
        "sides of the part.");
}

void CheckHand(const HandMap& hand, const std::string& path, const YamlNode& root,
               Problems* problems) {
  CheckPart(hand, path, root, problems);
  CheckCount(hand.force, 3, path + ".force", root, problems);
  CheckCount(hand.torque, 3, path + ".torque", root, problems);
  if (hand.force.empty() && !hand.torque.empty())
    problems->Add(PlaceOf(path + ".torque", root), path + ".torque needs a force.");
}

void CheckEmg(const EmgMap& emg, const std::string& path, const YamlNode& root,
              Problems* problems) {
  if (!(emg.mvc > 0))
    problems->Add(
        PlaceOf(path, root),
        path +
            " has no mvc. A voltage depends on the electrode and the skin, so an activation "
            "follows from it only relative to a maximum voluntary contraction. Record such a "
            "contraction, and give its largest envelope as mvc, in the unit of the channel.");
  if (emg.band_low >= emg.band_high)
    problems->Add(PlaceOf(path, root), path + ".band_low must be below band_high.");
}

}  // namespace

void CheckTrackMap(const TrackMap& map, const YamlNode& root, Problems* problems) {
  if (map.head) CheckPart(*map.head, "head", root, problems);
  if (map.left_elbow) CheckPart(*map.left_elbow, "left_elbow", root, problems);
  if (map.right_elbow) CheckPart(*map.right_elbow, "right_elbow", root, problems);
  if (map.left_hand) CheckHand(*map.left_hand, "left_hand", root, problems);
  if (map.right_hand) CheckHand(*map.right_hand, "right_hand", root, problems);
  for (std::size_t i = 0; i < map.emg.size(); ++i)
    CheckEmg(map.emg[i], "emg." + std::to_string(i), root, problems);
  if (map.clock == TrackClock::kAuto && !map.left_hand && !map.right_hand)
    problems->Add(PlaceOf("clock", root),
                  "clock is auto, which needs the motion of a hand. Map left_hand or right_hand, "
                  "or give clock: recording with the offset.");
}

TrackMap ParseTrackMap(const std::string& text, const std::string& name) {
  const auto check = [](const TrackMap& map, const YamlNode& root, Problems* problems) {
    CheckTrackMap(map, root, problems);
    if (map.MapsNothing())
      problems->Add(root.place,
                    "The mapping maps nothing. Add head, left_elbow, right_elbow, left_hand, "
                    "right_hand, series or emg.");
  };
  return ReadMap<TrackMap>(text, name, "file: NAME", check);
}

TrackMap LoadTrackMap(const std::filesystem::path& file) {
  return ParseTrackMap(ReadYamlText(file, "a mapping"), file.string());
}

TrackMap MapOfColumns(const SeriesFile& file) {
  TrackMap map;
  std::vector<std::string> used;
  const auto has = [&](const std::string& name, const char* last) {
    return file.Find(name + last) != nullptr;
  };
  const auto take = [&](const std::string& name, const char* axis,
                        std::vector<std::string>* names) {
    if (!has(name, axis)) return;
    *names = {name};
    used.push_back(name + ".");
  };
  const auto part = [&](const std::string& name, PartMap* p) {
    take(name + ".p", ".x", &p->position);
    take(name + ".q", ".w", &p->rotation);
  };
  for (const auto& [name, place] : {std::pair{"head", &map.head},
                                    {"left_elbow", &map.left_elbow},
                                    {"right_elbow", &map.right_elbow}})
    if (has(name, ".p.x")) part(name, &place->emplace());
  for (const auto& [name, place] :
       {std::pair{"left_hand", &map.left_hand}, {"right_hand", &map.right_hand}}) {
    if (!has(name, ".p.x")) continue;
    HandMap& hand = place->emplace();
    part(name, &hand);
    take(std::string(name) + ".force", ".x", &hand.force);
    take(std::string(name) + ".torque", ".x", &hand.torque);
    if (has(name, ".holds")) {
      hand.holds = std::string(name) + ".holds";
      used.push_back(hand.holds);
    }
  }
  for (const Series& series : file.series) {
    const bool mapped = std::ranges::any_of(
        used, [&](const std::string& prefix) { return series.name.starts_with(prefix); });
    if (!mapped) map.series.push_back({series.name, series.name, ""});
  }
  return map;
}

}  // namespace predictor::tracks
