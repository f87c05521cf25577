// Computes activations from electromyograms of the arm muscles in a recording, and describes how
// the model uses these activations.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "assessment/hand_samples.h"
#include "assessment/muscle_use.h"
#include "assessment/person_setup.h"
#include "tracks/body_track.h"

namespace predictor::assessment {

// One channel. The channel's activation applies to each muscle that is assigned to the channel.
struct MeasuredEmg {
  std::string channel, source;  // source: file
  int hand = 0;                 // side of the arm
  std::vector<int> muscles;     // indices into muscles::MuscleTable()
  double weight = 0;            // muscles::ActivationProblem::trust
  double share = 0;             // share of the judged time in which the channel was measured
  double largest = 0;           // largest envelope over mvc; above 1, the activation is limited
  double above = 0;             // share of the channel's usable time with an envelope above mvc
  // Activations at Assessment::times, 0 ... 1; NaN: missing. `modelled` is the mean activation of
  // the muscles in the model, which takes the measured activation into account. Values are missing
  // for times at which the arm holds no handle.
  std::vector<double> measured, modelled;
};

struct MeasuredEmgs {
  std::vector<MeasuredEmg> channels;
  std::vector<std::string> warnings;
  std::vector<NotEvaluable> gaps;  // channels that cannot be used
};

// Describes a channel, without values. Throws InputError, which names the file, if a muscle is
// unknown or is measured by one of the other channels.
MeasuredEmg DescribeEmg(const tracks::EmgTrack& emg, const std::string& source,
                        const std::vector<MeasuredEmg>& others);

// The activations computed from a channel, at its own times, without the ends of its parts.
struct EmgActivations {
  std::vector<double> times, values;
  double largest = 0;     // envelope over mvc
  std::size_t above = 0;  // number of times with an envelope above mvc

  // Returns the mean activation within `width` around `time`, or NaN outside of a part.
  double At(double time, double width) const;
};
// Throws InputError with the reason if the channel cannot be used (see AddEmg).
EmgActivations ActivationsOf(const tracks::EmgTrack& track);

// Converts the electromyograms of a file with muscles::EmgActivation and adds the results. `times`
// are the times of the samples by the clock of the file [s]. A channel is split where values are
// missing for more than PartTrack::kMaxGap. Shorter gaps do not split a channel, because the
// envelope changes more slowly. At both ends of each part, one period of the low-pass
// (kEmgSettling) is left out. Parts shorter than kShortestEmg are left out, too (D).
//
// A channel is left out if it is constant, has no part that is long enough, or has too low a
// sampling rate for its band. `gaps` then contains the reason. Throws InputError, which names the
// file, if a muscle is unknown or is measured twice.
void AddEmg(const tracks::BodyTrack& track, std::span<const double> times, MeasuredEmgs* emgs);
inline constexpr double kEmgSettling = 1.0 / 6, kShortestEmg = 0.5;  // [s]

// Returns the activations that were measured at a sample.
std::array<MeasuredActivations, kHands> ActivationsAt(std::span<const MeasuredEmg> channels,
                                                      std::size_t sample);

// Stores what the model computed for the muscles of the channels at the next sample.
void AddModelled(const std::array<ArmMuscleUse, kHands>& use, std::vector<MeasuredEmg>* channels);

// Adds to `gaps` the channels that had no influence on the result. A channel has no influence if,
// during the measurement, its arm held no handle or was raised above 90°. Adds to `assumptions` a
// description of how the model uses the other channels.
void AddEmgWords(const std::vector<MeasuredEmg>& channels, std::vector<std::string>* assumptions,
                 std::vector<NotEvaluable>* gaps);

// Returns "right.biceps_long+biceps_short", for example.
std::string PathOf(const MeasuredEmg& channel);
// The agreement between measured and modelled activations of a channel, over the times at which
// both are known. If there are no such times, the values are NaN.
struct EmgAgreement {
  double measured = 0, modelled = 0;  // means
  double rms = 0;                     // root mean square of the difference
};
EmgAgreement AgreementOf(const MeasuredEmg& channel);
std::string Sentence(const MeasuredEmg& channel);

}  // namespace predictor::assessment
