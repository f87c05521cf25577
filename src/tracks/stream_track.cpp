#include "tracks/stream_track.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "core/stream_sample.h"
#include "core/text.h"
#include "tracks/read_map.h"
#include "tracks/track_map_fields.h"

namespace predictor::tracks {

template <class V>
void Fields(V& v, StreamMap& s) {
  v("stream", s.stream, Required(Word("name or type of the stream")));
  v("offset", s.offset,
    Number("s", "added to the times of the stream, for example for a known delay of the device",
           Within(1)));
  BodyFields(v, s);
}

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestLabel = 256, kLongestMap = 64 * 1024;  // [bytes]

bool ReadWords(const Json& json, const char* key, std::vector<std::string>* words) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() > kMaxStreamChannels) return false;
  for (const Json& word : *found) {
    if (!word.is_string() || word.get_ref<const std::string&>().size() > kLongestLabel)
      return false;
    words->push_back(word);
  }
  return true;
}

bool ReadWord(const Json& json, const char* key, std::size_t longest, std::string* word) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) return false;
  *word = *found;
  return word->size() <= longest;
}

StreamMap MapOf(const StreamDescription& stream, const SeriesFile& file) {
  if (!stream.map.empty())
    return ParseStreamMap(stream.map, "mapping of " + Printable(stream.name));
  StreamMap map;
  static_cast<TrackMap&>(map) = MapOfColumns(file);
  return map;
}

template <class T>
void MoveTo(std::vector<T>* all, std::vector<T>* part) {
  all->insert(all->end(), std::make_move_iterator(part->begin()),
              std::make_move_iterator(part->end()));
}

// Removes from all vectors the first elements, whose times are before `time`.
template <class... Values>
void ForgetBefore(double time, std::vector<double>* times, Values*... values) {
  const auto count = std::ranges::lower_bound(*times, time) - times->begin();
  const auto drop = [count](auto* v) {
    if (std::ssize(*v) >= count) v->erase(v->begin(), v->begin() + count);
  };
  drop(times);
  (drop(values), ...);
}

void AppendPart(std::optional<PartTrack>* all, std::optional<PartTrack>* part) {
  if (!*part) return;
  if (!*all) all->emplace();
  MoveTo(&(**all).times, &(**part).times);
  MoveTo(&(**all).p, &(**part).p);
  MoveTo(&(**all).q, &(**part).q);
}

}  // namespace

std::string TextOf(const StreamDescription& stream) {
  return Json{{"name", stream.name},
              {"map", stream.map},
              {"rate", stream.rate},
              {"channels", stream.channels},
              {"units", stream.units}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

StreamDescription ParseStream(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  StreamDescription stream;
  const bool good = json.is_object() && ReadWord(json, "name", kLongestLabel, &stream.name) &&
                    ReadWord(json, "map", kLongestMap, &stream.map) && json.contains("rate") &&
                    json["rate"].is_number() && ReadWords(json, "channels", &stream.channels) &&
                    ReadWords(json, "units", &stream.units) && !stream.channels.empty() &&
                    stream.units.size() == stream.channels.size();
  if (!good) throw InputError("The description of a stream of measurements is invalid.");
  stream.rate = json["rate"];
  return stream;
}

StreamMap ParseStreamMap(const std::string& text, const std::string& name) {
  const auto check = [](const StreamMap& map, const YamlNode& root, Problems* problems) {
    CheckTrackMap(map, root, problems);
    if (map.left_hand || map.right_hand)
      problems->Add(root.place,
                    "The mapping of a stream has a hand, but the hands are measured by the arms. "
                    "Remove left_hand and right_hand.");
    if (map.MapsNothing())
      problems->Add(root.place,
                    "The mapping maps nothing. Add head, left_elbow, right_elbow, series or emg.");
  };
  return ReadMap<StreamMap>(text, name, "stream: NAME", check);
}

StreamTrack::StreamTrack(const StreamDescription& stream) {
  file_.name = "stream " + Printable(stream.name);
  auto none = std::make_shared<const std::vector<double>>();
  for (std::size_t i = 0; i < stream.channels.size(); ++i)
    file_.series.push_back({stream.channels[i], stream.units[i], none, {}});
  map_ = MapOf(stream, file_);
  map_.left_hand.reset(), map_.right_hand.reset();
  if (map_.MapsNothing())
    throw InputError(file_.name, "The stream has no channel that can be used.");
  track_ = ApplyMapToPart(map_, file_);  // also checks that the channels exist and have units
  track_.offset = 0;                     // Take adds the offset to the times
}

void StreamTrack::Take(double time, std::span<const double> values) {
  if (values.size() != channels() || !(time + map_.offset > last_)) return;
  last_ = time + map_.offset;
  times_.push_back(last_);
  for (std::size_t i = 0; i < values.size(); ++i) file_.series[i].values.push_back(values[i]);
}

void StreamTrack::Convert() {
  if (times_.empty()) return;
  SeriesFile part = file_;
  part.name = file_.name;
  const auto times = std::make_shared<const std::vector<double>>(std::exchange(times_, {}));
  for (Series& series : part.series) series.times = times;
  for (Series& series : file_.series) series.values.clear();
  Append(ApplyMapToPart(map_, part));
}

void StreamTrack::Append(BodyTrack&& part) {
  AppendPart(&track_.head, &part.head);
  for (std::size_t h = 0; h < kHands; ++h) AppendPart(&track_.elbows[h], &part.elbows[h]);
  for (std::size_t i = 0; i < part.signals.size(); ++i) {
    MoveTo(&track_.signals[i].times, &part.signals[i].times);
    MoveTo(&track_.signals[i].values, &part.signals[i].values);
  }
  for (std::size_t i = 0; i < part.emg.size(); ++i) {
    MoveTo(&track_.emg[i].times, &part.emg[i].times);
    MoveTo(&track_.emg[i].values, &part.emg[i].values);
  }
}

void StreamTrack::Forget(double time) {
  const auto forget = [time](std::optional<PartTrack>* part) {
    if (*part) ForgetBefore(time, &(**part).times, &(**part).p, &(**part).q);
  };
  forget(&track_.head);
  for (auto& elbow : track_.elbows) forget(&elbow);
  for (SignalTrack& signal : track_.signals) ForgetBefore(time, &signal.times, &signal.values);
  for (EmgTrack& emg : track_.emg) ForgetBefore(time, &emg.times, &emg.values);
}

}  // namespace predictor::tracks
