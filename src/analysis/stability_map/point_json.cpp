#include "analysis/stability_map/point_json.h"

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

Json JsonOf(const MapPoint& point) {
  Json samples = Json::array();
  for (const GrowthAt& sample : point.found.samples) samples.push_back(ToJson(sample));
  return {{"value", point.value},
          {"impossible", point.impossible},
          {"predicted", ToJson(point.predicted)},
          {"simulated", point.simulated},
          {"found", ToJson(point.found.extent)},
          {"samples", samples}};
}

bool ReadPoint(const Json& json, MapPoint* point) try {
  *point = PointFrom(json);
  return true;
} catch (const Json::exception&) {
  return false;
}

}  // namespace predictor
