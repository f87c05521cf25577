#include "tracks/body_track.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor::tracks {
namespace {

// Returns the channels to which `names` refers. If `names` contains a single NAME, the channels are
// those of this name with an axis added. Otherwise, they are the given channels.
std::vector<const Series*> ChannelsOf(const SeriesFile& file, const std::vector<std::string>& names,
                                      const std::vector<const char*>& axes) {
  std::vector<const Series*> channels;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string name = names.size() == 1 ? names[0] + axes[i] : names[i];
    channels.push_back(&file.At(name));
    if (channels.back()->times != channels[0]->times)
      throw InputError(file.name, Quote(name) + " has other times than " +
                                      Quote(channels[0]->name) +
                                      ". Map channels of one message or table.");
  }
  return channels;
}
const std::vector<const char*> kXyz = {".x", ".y", ".z"}, kWxyz = {".w", ".x", ".y", ".z"};

double FactorFor(const std::string& given, const Series& series, const SeriesFile& file,
                 const char* key, double (*factor)(const std::string&, const std::string&)) {
  const std::string& unit = given.empty() ? series.unit : given;
  if (unit.empty())
    throw InputError(file.name, "The file does not state the unit of " + Quote(series.name) +
                                    ". Give it in the mapping: " + key + ".");
  return factor(unit, file.name + ", " + Printable(series.name));
}

std::vector<Vector3> VectorsOf(const std::vector<const Series*>& channels, double factor) {
  std::vector<Vector3> all;
  all.reserve(channels[0]->values.size());
  for (std::size_t i = 0; i < channels[0]->values.size(); ++i)
    all.emplace_back(factor * channels[0]->values[i], factor * channels[1]->values[i],
                     factor * channels[2]->values[i]);
  return all;
}

class Mapper {
 public:
  Mapper(const TrackMap& map, const SeriesFile& file)
      : map_(map), file_(file), X_WF_(PoseFromXyzRpy(map.frame.xyz, map.frame.rpy)) {}

  PartTrack PartOf(const PartMap& part) const {
    PartTrack track;
    const auto times = TimesOf(part.position.empty() ? MarkerChannels(part.markers[0])
                                                     : ChannelsOf(file_, part.position, kXyz));
    track.times = *times;
    track.p = part.position.empty() ? MeanOf(part.markers, times)
                                    : Points(ChannelsOf(file_, part.position, kXyz));
    if (!part.rotation.empty())
      track.q = Rotations(part.rotation, times);
    else if (!part.front.empty())
      track.q = Triads(part, times);
    Place(part, &track);
    return track;
  }

  HandTrack HandOf(const HandMap& hand) const {
    HandTrack track;
    track.pose = PartOf(hand);
    track.along_handle = hand.axes == WrenchAxes::kHand;
    track.about = hand.about;
    if (!hand.force.empty()) AddWrench(hand, &track);
    if (!hand.holds.empty()) {
      const Series& holds = file_.At(hand.holds);
      track.holds_times = *holds.times;
      track.holds = holds.values;
    }
    return track;
  }

  SignalTrack SignalOf(const SeriesMap& signal) const {
    const Series& series = file_.At(signal.channel);
    return {signal.name, signal.unit.empty() ? series.unit : signal.unit, *series.times,
            series.values};
  }

  EmgTrack EmgOf(const EmgMap& emg) const {
    const Series& series = file_.At(emg.channel);
    return {emg, *series.times, series.values};
  }

 private:
  using Times = std::shared_ptr<const std::vector<double>>;

  static Times TimesOf(const std::vector<const Series*>& channels) { return channels[0]->times; }
  std::vector<const Series*> MarkerChannels(const std::string& marker) const {
    return ChannelsOf(file_, {marker}, kXyz);
  }
  std::vector<Vector3> Points(const std::vector<const Series*>& channels) const {
    return VectorsOf(channels, FactorFor(map_.unit, *channels[0], file_, "unit: mm", LengthFactor));
  }

  std::vector<Vector3> MeanOf(const std::vector<std::string>& markers, const Times& times) const {
    std::vector<Vector3> mean(times->size(), Vector3::Zero());
    for (const std::string& marker : markers) {
      const auto channels = MarkerChannels(marker);
      CheckTimes(channels, times);
      const std::vector<Vector3> points = Points(channels);
      for (std::size_t i = 0; i < mean.size(); ++i)
        mean[i] += points[i] / static_cast<double>(markers.size());
    }
    return mean;
  }

  void CheckTimes(const std::vector<const Series*>& channels, const Times& times) const {
    if (TimesOf(channels) != times)
      throw InputError(
          file_.name, Quote(channels[0]->name) +
                          " has times that differ from those of the position of the same part. Map "
                          "channels of one message or table.");
  }

  std::vector<Quaternion> Rotations(const std::vector<std::string>& names,
                                    const Times& times) const {
    const auto channels = ChannelsOf(file_, names, kWxyz);
    CheckTimes(channels, times);
    std::vector<Quaternion> all;
    for (std::size_t i = 0; i < times->size(); ++i) {
      const auto value = [&](std::size_t k) { return channels[k]->values[i]; };
      const Quaternion q(value(0), value(1), value(2), value(3));
      constexpr double kTolerance = 0.02;
      if (q.coeffs().allFinite() && std::abs(q.norm() - 1) > kTolerance)
        throw InputError(file_.name,
                         Formatted("The quaternion of %s at %.6g s has the length %.3g instead of "
                                   "1. Check the order w, x, y, z in the mapping.",
                                   Printable(channels[0]->name).c_str(), (*times)[i], q.norm()));
      all.push_back(q.normalized());
    }
    return all;
  }

  std::vector<Quaternion> Triads(const PartMap& part, const Times& times) const {
    const auto front = MeanOf(part.front, times), back = MeanOf(part.back, times),
               left = MeanOf(part.left, times), right = MeanOf(part.right, times);
    std::vector<Quaternion> all;
    for (std::size_t i = 0; i < times->size(); ++i) {
      Matrix3 R;
      R.col(0) = (front[i] - back[i]).normalized();
      R.col(2) = R.col(0).cross(left[i] - right[i]).normalized();
      R.col(1) = R.col(2).cross(R.col(0));
      all.push_back(R.allFinite() ? Quaternion(R) : Quaternion(kMissing, 0, 0, 0));
    }
    return all;
  }

  // Converts from the tracked frame in F to the part in W.
  void Place(const PartMap& part, PartTrack* track) const {
    const Pose X_TP = PoseFromXyzRpy(part.xyz, part.rpy);
    for (std::size_t i = 0; i < track->p.size(); ++i) {
      Vector3& p = track->p[i];
      if (track->q.empty()) {
        p = X_WF_ * p;
        continue;
      }
      Quaternion& q = track->q[i];
      const bool turned = q.coeffs().allFinite();
      // Without the rotation of the part, its offset from the tracked point is unknown.
      p = turned                 ? X_WF_ * (p + q * X_TP.p)
          : X_TP.p.norm() < 1e-9 ? X_WF_ * p
                                 : Vector3::Constant(kMissing);
      if (turned) q = (X_WF_.q * q * X_TP.q).normalized();
    }
  }

  void AddWrench(const HandMap& hand, HandTrack* track) const {
    const auto force = ChannelsOf(file_, hand.force, kXyz);
    const double newton =
        FactorFor(map_.force_unit, *force[0], file_, "force_unit: N", ForceFactor);
    const std::vector<Vector3> forces = VectorsOf(force, newton);
    std::vector<Vector3> torques(forces.size(), Vector3::Zero());
    if (!hand.torque.empty()) {
      const auto torque = ChannelsOf(file_, hand.torque, kXyz);
      if (TimesOf(torque) != TimesOf(force))
        throw InputError(file_.name, Quote(torque[0]->name) + " has other times than " +
                                         Quote(force[0]->name) + ".");
      torques = VectorsOf(
          torque, FactorFor(map_.torque_unit, *torque[0], file_, "torque_unit: N m", TorqueFactor));
    }
    track->wrench_times = *TimesOf(force);
    const double sign = hand.on == WrenchOn::kHandle ? 1 : -1;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      Wrench F;
      F.head<3>() = sign * (track->along_handle ? forces[i] : X_WF_.q * forces[i]);
      F.tail<3>() = sign * (track->along_handle ? torques[i] : X_WF_.q * torques[i]);
      track->F.push_back(F);
    }
  }

  const TrackMap& map_;
  const SeriesFile& file_;
  Pose X_WF_;
};

// The two measurements around a time, as the index of the later one and its weight.
struct Between {
  std::size_t after = 0;
  double weight = 0;
};
std::optional<Between> Around(const std::vector<double>& times, double time, double gap) {
  const auto later = std::ranges::lower_bound(times, time);
  if (later == times.end()) return {};
  const auto i = static_cast<std::size_t>(later - times.begin());
  if (*later == time) return Between{i, 1};
  constexpr double kRounding = 1e-6;  // [s]
  if (i == 0 || times[i] - times[i - 1] > gap + kRounding) return {};
  return Between{i, (time - times[i - 1]) / (times[i] - times[i - 1])};
}

// Returns a value between two measurements. If `at` is exactly the time of one measurement, the
// other one may be missing.
template <class T>
T Blend(const std::vector<T>& values, const Between& at) {
  if (at.weight == 1) return values[at.after];
  return (1 - at.weight) * values[at.after - 1] + at.weight * values[at.after];
}

// Returns the mean of the values within `width` around the time, or no value if there are fewer
// than two.
template <class T>
std::optional<T> MeanWithin(const std::vector<double>& times, const std::vector<T>& values,
                            double time, double width) {
  const auto begin = std::ranges::lower_bound(times, time - width / 2);
  const auto end = std::ranges::lower_bound(times, time + width / 2);
  if (end - begin < 2) return {};
  T sum = values[static_cast<std::size_t>(begin - times.begin())];
  for (auto i = begin + 1; i != end; ++i)
    sum += values[static_cast<std::size_t>(i - times.begin())];
  return T(sum / static_cast<double>(end - begin));
}

double MedianInterval(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

}  // namespace

std::optional<Vector3> PartTrack::PositionAt(double time, double gap) const {
  const auto at = Around(times, time, gap);
  if (!at) return {};
  const Vector3 blended = Blend(p, *at);
  return blended.allFinite() ? std::optional(blended) : std::nullopt;
}

std::optional<Quaternion> PartTrack::RotationAt(double time, double gap) const {
  if (q.empty()) return {};
  const auto at = Around(times, time, gap);
  if (!at) return {};
  const Quaternion& after = q[at->after];
  const Quaternion blended = at->weight == 1 ? after : q[at->after - 1].slerp(at->weight, after);
  return blended.coeffs().allFinite() ? std::optional(blended) : std::nullopt;
}

std::optional<Wrench> HandTrack::WrenchAt(double time, double width) const {
  const auto R_WD = pose.RotationAt(time);
  const bool needs_rotation = along_handle || about.norm() > 0;
  if (needs_rotation && !R_WD) return {};
  Wrench wrench;
  if (const auto mean = MeanWithin(wrench_times, F, time, width)) {
    wrench = *mean;
  } else {
    const auto at = Around(wrench_times, time, PartTrack::kMaxGap);
    if (!at) return {};
    wrench = Blend(F, *at);
  }
  if (!wrench.allFinite()) return {};
  if (along_handle) {
    wrench.head<3>() = *R_WD * Vector3(wrench.head<3>());
    wrench.tail<3>() = *R_WD * Vector3(wrench.tail<3>());
  }
  return needs_rotation ? ShiftWrench(wrench, *R_WD * about) : wrench;
}

bool HandTrack::HoldsAt(double time) const {
  if (holds.empty()) return true;
  const auto later = std::ranges::upper_bound(holds_times, time);
  if (later == holds_times.begin()) return false;
  return holds[static_cast<std::size_t>(later - holds_times.begin()) - 1] > 0.5;
}

double SignalTrack::At(double time, double width) const {
  if (const auto mean = MeanWithin(times, values, time, width)) return *mean;
  const auto at = Around(times, time, 2 * MedianInterval(times));
  return at ? Blend(values, *at) : kMissing;
}

namespace {

void CheckMeasured(const PartTrack& part, const char* name, const std::string& source) {
  if (std::ranges::none_of(part.p, [](const Vector3& p) { return p.allFinite(); }))
    throw InputError(source, std::string("The position of ") + name +
                                 " is missing at every time. Check the mapping.");
}

}  // namespace

BodyTrack ApplyMap(const TrackMap& map, const SeriesFile& file) {
  BodyTrack track = ApplyMapToPart(map, file);
  if (track.head) CheckMeasured(*track.head, "head", file.name);
  constexpr std::array kElbows = {"left_elbow", "right_elbow"},
                       kHandParts = {"left_hand", "right_hand"};
  for (std::size_t h = 0; h < kHands; ++h) {
    if (track.elbows[h]) CheckMeasured(*track.elbows[h], kElbows[h], file.name);
    if (track.hands[h]) CheckMeasured(track.hands[h]->pose, kHandParts[h], file.name);
  }
  return track;
}

BodyTrack ApplyMapToPart(const TrackMap& map, const SeriesFile& file) {
  const Mapper mapper(map, file);
  BodyTrack track;
  track.source = file.name;
  track.clock = map.clock;
  track.offset = map.offset;
  track.warnings = file.warnings;
  if (map.head) track.head = mapper.PartOf(*map.head);
  if (map.left_elbow) track.elbows[0] = mapper.PartOf(*map.left_elbow);
  if (map.right_elbow) track.elbows[1] = mapper.PartOf(*map.right_elbow);
  if (map.left_hand) track.hands[0] = mapper.HandOf(*map.left_hand);
  if (map.right_hand) track.hands[1] = mapper.HandOf(*map.right_hand);
  for (const SeriesMap& signal : map.series) track.signals.push_back(mapper.SignalOf(signal));
  for (const EmgMap& emg : map.emg) track.emg.push_back(mapper.EmgOf(emg));
  return track;
}

BodyTrack LoadBodyTrack(const std::filesystem::path& file) {
  if (file.extension() == ".yaml" || file.extension() == ".yml") {
    const TrackMap map = LoadTrackMap(file);
    return ApplyMap(map, ReadSeries(file.parent_path() / map.file, map.TimeOf()));
  }
  if (file.extension() == ".trc" || file.extension() == ".c3d")
    throw InputError(file.string(),
                     "The markers of this file must be mapped to parts of the body. Give a mapping "
                     "(.yaml) that names this file.");
  const SeriesFile table = ReadSeries(file);
  TrackMap map = MapOfColumns(table);
  if (map.MapsNothing())
    throw InputError(file.string(), "The table has no column of numbers other than the time.");
  return ApplyMap(map, table);
}

}  // namespace predictor::tracks
