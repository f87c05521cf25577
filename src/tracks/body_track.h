// Provides the measured motion of parts of a person, in W.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "tracks/series.h"
#include "tracks/track_map.h"

namespace predictor::tracks {

// The pose of a part over time.
struct PartTrack {
  std::vector<double> times;  // in the file's clock [s]
  std::vector<Vector3> p;     // in W [m]; NaN: missing
  std::vector<Quaternion> q;  // R_WT; empty: not measured; NaN: missing

  // Interpolates linearly between two measurements that are at most `gap` [s] apart. Returns no
  // value for times outside the range of the measurements.
  std::optional<Vector3> PositionAt(double time, double gap = kMaxGap) const;
  std::optional<Quaternion> RotationAt(double time, double gap = kMaxGap) const;

  // If a part is missing for longer than this time, its pose is not interpolated (design choice)
  // [s].
  static constexpr double kMaxGap = 0.05;
};

struct HandTrack {
  PartTrack pose;
  std::vector<double> wrench_times;  // [s]
  std::vector<Wrench> F;             // wrench on the handle, about the point `about`; NaN: missing
  std::vector<double> holds_times, holds;
  bool along_handle = false;        // F is along the handle's axes, otherwise along those of W
  Vector3 about = Vector3::Zero();  // point of the torque, in the handle's frame [m]

  // Returns F_D_W about the handle's origin, or no value at times at which the pose or the wrench
  // is missing. If there are several values within `width` [s] around the time, their mean is used.
  // If there are not several values, the value is interpolated linearly.
  std::optional<Wrench> WrenchAt(double time, double width = 0) const;
  bool HoldsAt(double time) const;
};

// Other measured numbers, such as EMG or heart rate.
struct SignalTrack {
  std::string name, unit;
  std::vector<double> times, values;

  // Returns the mean of the values within `width` [s] around the time, if there are several.
  // If not, the function interpolates linearly between neighbours that are at most twice the median
  // interval apart. NaN means that the value is missing.
  double At(double time, double width) const;
};

// A raw electromyogram, and the parameters with which the activation is computed from it.
struct EmgTrack {
  EmgMap map;
  std::vector<double> times, values;  // [s], in the unit of the channel; NaN: missing
};

struct BodyTrack {
  std::string source;  // file
  TrackClock clock = TrackClock::kRecording;
  double offset = 0;  // [s]
  std::optional<PartTrack> head;
  std::array<std::optional<PartTrack>, kHands> elbows;
  std::array<std::optional<HandTrack>, kHands> hands;
  std::vector<SignalTrack> signals;
  std::vector<EmgTrack> emg;
  std::vector<std::string> warnings;
  // Whether the run's own recording contains this track. The user did not choose it for the
  // evaluation, so if it cannot be used, the evaluation continues without it.
  bool of_the_run = false;
};

// Applies a mapping. Throws InputError if a channel is missing, a position has no unit, a rotation
// is not a unit quaternion, or a part was never measured.
BodyTrack ApplyMap(const TrackMap& map, const SeriesFile& file);

// Applies a mapping to a part of a measurement. A part of the body may be missing throughout, and
// the file may have no times. Otherwise as ApplyMap.
BodyTrack ApplyMapToPart(const TrackMap& map, const SeriesFile& file);

// Loads a mapping (.yaml) with its file, or a table with named columns (MapOfColumns). Throws
// InputError.
BodyTrack LoadBodyTrack(const std::filesystem::path& file);

}  // namespace predictor::tracks
