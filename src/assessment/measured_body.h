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

// A file with measurements, and the method that relates the file's clock to the recording's clock.
struct UsedTrack {
  std::string source;
  double offset = 0;                            // added to the file's times [s]
  std::optional<tracks::ClockOffset> estimate;  // empty if the offset was given
  bool by_clock = false;  // the track's times are those of PersonSample::by_clock
};

struct MeasuredPart {
  std::string what;    // "head", "head rotation", "left elbow", "right elbow"
  std::string source;  // file
  double share = 0;    // share of the judged time in which the part was measured
  // The median distance of the nominal posture from the measurement [m]. Empty for a rotation.
  std::optional<double> misfit;
};

// A signal that no score uses.
struct MeasuredSignal {
  std::string name, unit, source;
  double share = 0;            // share of the judged time in which the signal was measured
  std::vector<double> values;  // values at Assessment::times; NaN: missing
};

struct MeasuredBody {
  std::vector<UsedTrack> tracks;
  std::vector<MeasuredPart> parts;
  std::vector<MeasuredSignal> signals;
  MeasuredEmgs emg;  // their warnings are in `warnings` below
  std::vector<std::string> warnings;
};

// Adds the measured head and elbows to the samples. Missing values are not extrapolated, and are
// interpolated only in gaps of up to 0.05 s. `start_unix` is the start of the recording [s].
//
// Throws InputError, which names the file, if two tracks measure the same part or if a track has no
// measurement during the run. Also throws InputError if the offset of a track's clock cannot be
// estimated, or if most positions of a track are impossible for this person at this place (wrong
// unit, frame or marker). If only a few positions are impossible, these positions are left out and
// counted. Electromyograms are converted by AddEmg. A track of the run itself
// (BodyTrack::of_the_run) is left out with a warning instead of an error. If earlier tracks measure
// some of its parts or muscles, only these are left out. Pass this track after the others, so that
// a file that measures the same part is used.
MeasuredBody AddTracks(std::span<const tracks::BodyTrack> tracks, const PersonSetup& setup,
                       double start_unix, std::vector<PersonSample>* samples);

// Computes the distance of each measured part from the nominal postures. Warns if a misfit is
// larger than kMaxMisfit (design choice) [m].
void AddMisfit(std::span<const person::Posture> postures, MeasuredBody* measured,
               std::vector<std::string>* warnings);
inline constexpr double kMaxMisfit = 0.08;

// Returns a sentence such as "These were measured: the hands, the head (98 % of the time), ...".
std::string MeasuredSentence(const MeasuredBody& measured);
// Each of the following functions returns one sentence.
std::string Sentence(const UsedTrack& track);
std::string Sentence(const MeasuredPart& part);
std::string Sentence(const MeasuredSignal& signal);

}  // namespace predictor::assessment
