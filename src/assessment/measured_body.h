// Measurements of the person in addition to the hands: head, elbows, electromyograms, and other
// signals.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assessment/hand_samples.h"
#include "assessment/measured_emg.h"
#include "assessment/person_setup.h"
#include "person/posture_solver.h"
#include "tracks/body_track.h"
#include "tracks/clock_offset.h"

namespace predictor::assessment {

// A file with measurements, and how its clock was related to that of the recording.
struct UsedTrack {
  std::string source;
  double offset = 0;                            // added to its times [s]
  std::optional<tracks::ClockOffset> estimate;  // if the offset was estimated
};

struct MeasuredPart {
  std::string what;    // "head", "head rotation", "left elbow", "right elbow"
  std::string source;  // file
  double share = 0;    // of the judged time in which it was measured
  // The median distance of the nominal posture from the measurement [m]. A rotation has none.
  std::optional<double> misfit;
};

// No score uses these signals.
struct MeasuredSignal {
  std::string name, unit, source;
  double share = 0;            // of the judged time
  std::vector<double> values;  // at Assessment::times; NaN: missing
};

struct MeasuredBody {
  std::vector<UsedTrack> tracks;
  std::vector<MeasuredPart> parts;
  std::vector<MeasuredSignal> signals;
  MeasuredEmgs emg;  // the warnings about them are in `warnings`
  std::vector<std::string> warnings;
};

// Adds the measured head and elbows to the samples, as far as they were measured at these times. It
// extrapolates nothing, and interpolates only over 0.05 s. `start_unix` is the start of the
// recording [s].
//
// Throws InputError with the file if two tracks measure the same part, a track has no measurement
// during the run, its clock's offset cannot be estimated, or most of its positions are impossible
// for this person at this place (wrong unit, frame or marker). Single impossible positions are left
// out and counted. Electromyograms are converted by AddEmg.
MeasuredBody AddTracks(std::span<const tracks::BodyTrack> tracks, const PersonSetup& setup,
                       double start_unix, std::vector<PersonSample>* samples);

// Says how far the nominal postures are from the measurements. Warns if a misfit is larger than
// kMaxMisfit (design choice) [m].
void AddMisfit(std::span<const person::Posture> postures, MeasuredBody* measured,
               std::vector<std::string>* warnings);
inline constexpr double kMaxMisfit = 0.08;

// Returns "Measured were the hands, the head (98 % of the time), ...: the rest of the posture
// follows from comfort."
std::string MeasuredSentence(const MeasuredBody& measured);
// Each of these functions returns one sentence.
std::string Sentence(const UsedTrack& track);
std::string Sentence(const MeasuredPart& part);
std::string Sentence(const MeasuredSignal& signal);

}  // namespace predictor::assessment
