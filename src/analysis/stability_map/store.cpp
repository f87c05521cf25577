#include "analysis/stability_map/store.h"

#include <cinttypes>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const StableExtent& extent) {
  Json boundaries = Json::array();
  for (const Boundary& b : extent.boundaries)
    boundaries.push_back({{"stiffness", b.stiffness},
                          {"stable_below", b.stable_below},
                          {"frequency_hz", b.frequency}});
  return {{"stable_at_softest", extent.stable_at_softest}, {"boundaries", boundaries}};
}

StableExtent ExtentFrom(const Json& json) {
  StableExtent extent;
  extent.stable_at_softest = json.at("stable_at_softest");
  for (const Json& b : json.at("boundaries"))
    extent.boundaries.push_back({b.at("stiffness"), b.at("stable_below"), b.at("frequency_hz")});
  return extent;
}

Json ToJson(const GrowthAt& sample) {
  const Growth& g = sample.growth;
  return {{"stiffness", sample.stiffness},
          {"grows", g.grows},
          {"rate", g.rate ? Json(*g.rate) : Json(nullptr)},
          {"frequency_hz", g.frequency},
          {"time", g.time},
          {"limited", g.limited},
          {"stopped", g.stopped}};
}

GrowthAt SampleFrom(const Json& json) {
  GrowthAt sample;
  Growth& g = sample.growth;
  sample.stiffness = json.at("stiffness");
  g.grows = json.at("grows");
  if (!json.at("rate").is_null()) g.rate = json.at("rate").get<double>();
  g.frequency = json.at("frequency_hz");
  g.time = json.at("time");
  g.limited = json.at("limited");
  g.stopped = json.at("stopped");
  return sample;
}

Json ToJson(const std::string& key, const MapPoint& point) {
  Json samples = Json::array();
  for (const GrowthAt& sample : point.found.samples) samples.push_back(ToJson(sample));
  return {{"key", key},
          {"value", point.value},
          {"impossible", point.impossible},
          {"predicted", ToJson(point.predicted)},
          {"simulated", point.simulated},
          {"found", ToJson(point.found.extent)},
          {"samples", samples}};
}

MapPoint PointFrom(const Json& json) {
  MapPoint point;
  point.value = json.at("value");
  point.impossible = json.at("impossible");
  point.predicted = ExtentFrom(json.at("predicted"));
  point.simulated = json.at("simulated");
  point.found.extent = ExtentFrom(json.at("found"));
  for (const Json& sample : json.at("samples")) point.found.samples.push_back(SampleFrom(sample));
  return point;
}

}  // namespace

std::string HashOf(const std::string& text) { return Formatted("%016" PRIx64, Fnv1a(text)); }

MapStore::MapStore(const std::filesystem::path& file) : file_(file) {
  bool whole = true;  // the last line is complete
  if (std::ifstream in(file); in) {
    for (std::string line; std::getline(in, line);) {
      whole = !in.eof();
      ReadLine(line);
    }
  }
  out_.open(file, std::ios::app);
  if (!whole) out_ << '\n';
  Flush();
}

void MapStore::ReadLine(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return;
  try {
    points_[json.at("key").get<std::string>()] = PointFrom(json);
  } catch (const Json::exception&) {  // from another version or damaged: the point is computed
                                      // again
  }
}

bool MapStore::Find(const std::string& key, MapPoint* point) const {
  const auto found = points_.find(key);
  if (found == points_.end()) return false;
  *point = found->second;
  return true;
}

void MapStore::Add(const std::string& key, const MapPoint& point) {
  const std::string line = ToJson(key, point).dump() + '\n';
  const std::lock_guard lock(mutex_);
  out_ << line;
  Flush();
}

void MapStore::Flush() {
  if (!out_.flush())
    throw InputError("--map: '" + file_.string() +
                     "' could not be written. Give a writable folder on a disk with free space.");
}

}  // namespace predictor
