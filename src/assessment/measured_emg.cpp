#include "assessment/measured_emg.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "assessment/frame.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "muscles/emg.h"

namespace predictor::assessment {
namespace {

constexpr double kMaxShareAbove =
    0.01;  // share of the time with an envelope above mvc that causes no warning (D)

// A part of a channel that contains no long gap.
struct Part {
  std::vector<double> times, values;

  double Duration() const { return times.back() - times.front(); }
};

std::vector<Part> PartsOf(const tracks::EmgTrack& track) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < track.times.size(); ++i) {
    if (!std::isfinite(track.values[i])) continue;
    if (parts.empty() || track.times[i] - parts.back().times.back() > tracks::PartTrack::kMaxGap)
      parts.emplace_back();
    parts.back().times.push_back(track.times[i]);
    parts.back().values.push_back(track.values[i]);
  }
  return parts;
}

bool Changes(const std::vector<Part>& parts) {
  for (const Part& part : parts)
    for (const double value : part.values)
      if (value != parts.front().values.front()) return true;
  return false;
}

// Throws InputError if the sampling rate is too low for the filter's pass band.
void AddPart(const Part& part, const tracks::EmgMap& map, EmgActivations* all) {
  muscles::EmgProcessing how;
  const double rate = static_cast<double>(part.times.size() - 1) / part.Duration();
  how.rate = std::round(1e3 * rate) / 1e3;  // rounded for messages
  how.band_low = map.band_low;
  how.band_high = map.band_high;
  how.mvc = map.mvc;
  how.shape = map.shape;
  how.delay = map.delay;
  const std::vector<double> activation = muscles::EmgActivation(part.values, how);
  const std::vector<double> envelope = muscles::EmgEnvelope(part.values, how);
  const double begin = part.times.front() + kEmgSettling, end = part.times.back() - kEmgSettling;
  for (std::size_t i = 0; i < part.times.size(); ++i) {
    if (part.times[i] < begin || part.times[i] > end) continue;
    all->largest = std::max(all->largest, envelope[i] / map.mvc);
    if (part.times[i] < begin + map.delay) continue;
    all->above += envelope[i] > map.mvc ? 1 : 0;
    all->times.push_back(part.times[i]);
    all->values.push_back(activation[i]);
  }
}

int MuscleOf(const std::string& key, const std::string& source) {
  std::vector<std::string> keys;
  for (const muscles::MuscleSpec& muscle : muscles::MuscleTable()) {
    if (key == muscle.key) return static_cast<int>(keys.size());
    keys.emplace_back(muscle.key);
  }
  const std::string nearest = Nearest(key, keys);
  throw InputError(source, "emg: the arm model has no muscle " + Quote(key) + ". " +
                               (nearest.empty() ? "Its muscles are " + Join(keys) + "."
                                                : "Did you mean " + nearest + "?"));
}

// Two measurements of the same muscle could contradict each other.
void CheckUnique(const MeasuredEmg& added, const std::vector<MeasuredEmg>& channels) {
  for (const MeasuredEmg& other : channels)
    for (const int muscle : added.muscles)
      if (other.hand == added.hand &&
          std::ranges::find(other.muscles, muscle) != other.muscles.end())
        throw InputError(
            added.source,
            Formatted("emg: the muscle %s of the %s arm is also measured by %s of %s. Map it once.",
                      muscles::MuscleTable()[static_cast<std::size_t>(muscle)].key,
                      HandName(added.hand), Quote(other.channel).c_str(), other.source.c_str()));
}

// Returns the text of the error without its full stop, because the text becomes part of a sentence
// in the list of gaps.
std::string ReasonOf(const InputError& error) {
  std::string text = error.what();
  if (text.ends_with('.')) text.pop_back();
  return text;
}

void WarnAboutGaps(const tracks::EmgTrack& track, const std::string& name, MeasuredEmgs* emgs) {
  const std::vector<Part> parts = PartsOf(track);
  double longest = 0;
  for (std::size_t i = 1; i < parts.size(); ++i)
    longest = std::max(longest, parts[i].times.front() - parts[i - 1].times.back());
  if (parts.size() > 1)
    emgs->warnings.push_back(
        Formatted("%s has gaps that are not used: %zu, of up to %.2f s. If the recorder of the "
                  "channel did not pause, the recorder's clock jumped, and later times are wrong.",
                  name.c_str(), parts.size() - 1, longest));
}

}  // namespace

double EmgActivations::At(double time, double width) const {
  const auto begin = std::ranges::lower_bound(times, time - width / 2);
  const auto end = std::ranges::lower_bound(times, time + width / 2);
  if (begin == end) return kUnknownValue;
  double sum = 0;
  for (auto i = begin; i != end; ++i) sum += values[static_cast<std::size_t>(i - times.begin())];
  return sum / static_cast<double>(end - begin);
}

EmgActivations ActivationsOf(const tracks::EmgTrack& track) {
  const std::vector<Part> parts = PartsOf(track);
  if (parts.empty()) throw InputError("The channel contains no numbers.");
  if (!Changes(parts))
    throw InputError("The channel has the same value throughout. Check the electrode.");
  EmgActivations all;
  double longest = 0;
  for (const Part& part : parts) {
    longest = std::max(longest, part.Duration());
    if (part.Duration() >= kShortestEmg) AddPart(part, track.map, &all);
  }
  if (all.times.empty())
    throw InputError(
        Formatted("No part of the channel lasts %.1f s without a gap of more than %.2f s. The "
                  "longest part lasts %.2f s. Check the unit of the times.",
                  kShortestEmg, tracks::PartTrack::kMaxGap, longest));
  return all;
}

MeasuredEmg DescribeEmg(const tracks::EmgTrack& emg, const std::string& source,
                        const std::vector<MeasuredEmg>& others) {
  MeasuredEmg channel;
  channel.channel = emg.map.channel;
  channel.source = std::filesystem::path(source).filename().string();
  channel.hand = emg.map.arm == tracks::ArmSide::kLeft ? 0 : 1;
  channel.weight = emg.map.weight;
  for (const std::string& key : emg.map.muscles) channel.muscles.push_back(MuscleOf(key, source));
  CheckUnique(channel, others);
  return channel;
}

void AddEmg(const tracks::BodyTrack& track, std::span<const double> times, MeasuredEmgs* emgs) {
  const std::string source = std::filesystem::path(track.source).filename().string();
  for (const tracks::EmgTrack& emg : track.emg) {
    MeasuredEmg channel = DescribeEmg(emg, track.source, emgs->channels);
    const std::string name =
        "The electromyogram " + Quote(channel.channel) + " of " + Printable(source);
    EmgActivations activations;
    try {
      activations = ActivationsOf(emg);
    } catch (const InputError& error) {
      emgs->gaps.push_back({name + " (" + PathOf(channel) + ")", ReasonOf(error)});
      continue;
    }
    WarnAboutGaps(emg, name, emgs);
    std::size_t known = 0;
    for (const double time : times) {
      channel.measured.push_back(activations.At(time, 1 / kSampleRate));
      known += std::isfinite(channel.measured.back()) ? 1 : 0;
    }
    channel.share = static_cast<double>(known) / static_cast<double>(times.size());
    channel.largest = activations.largest;
    channel.above =
        static_cast<double>(activations.above) / static_cast<double>(activations.times.size());
    if (channel.above > kMaxShareAbove)
      emgs->warnings.push_back(Formatted(
          "%s exceeds mvc for %.1f %% of the time, up to %.2f times: the contraction that gave mvc "
          "was not the maximum, or the channel has artefacts. Activations are limited to 1.",
          name.c_str(), 100 * channel.above, channel.largest));
    emgs->channels.push_back(std::move(channel));
  }
}

std::array<MeasuredActivations, kHands> ActivationsAt(std::span<const MeasuredEmg> channels,
                                                      std::size_t sample) {
  std::array<MeasuredActivations, kHands> arms;
  for (const MeasuredEmg& channel : channels) {
    const double activation = channel.measured[sample];
    if (!std::isfinite(activation)) continue;
    MeasuredActivations& arm = arms[static_cast<std::size_t>(channel.hand)];
    for (const int muscle : channel.muscles) {
      arm.value[muscle] = activation;
      arm.trust[muscle] = channel.weight;
    }
  }
  return arms;
}

void AddModelled(const std::array<ArmMuscleUse, kHands>& use, std::vector<MeasuredEmg>* channels) {
  for (MeasuredEmg& channel : *channels) {
    double sum = 0;
    for (const int muscle : channel.muscles)
      sum += use[static_cast<std::size_t>(channel.hand)].activation[muscle];
    channel.modelled.push_back(sum / static_cast<double>(channel.muscles.size()));
  }
}

void AddEmgWords(const std::vector<MeasuredEmg>& channels, std::vector<std::string>* assumptions,
                 std::vector<NotEvaluable>* gaps) {
  bool used = false;
  for (const MeasuredEmg& channel : channels) {
    const bool has = std::isfinite(AgreementOf(channel).rms);
    used = used || has;
    if (!has)
      gaps->push_back({"The electromyogram " + Quote(channel.channel) + " of " +
                           Printable(channel.source) + " (" + PathOf(channel) + ")",
                       std::string("the ") + HandName(channel.hand) +
                           " arm holds no handle while it is measured, or is raised above 90°"});
  }
  if (used)
    assumptions->emplace_back(
        "The model keeps the activations of measured muscles close to the measured activations. "
        "The torques of the joints stay the same, so the activations of the arm's other muscles "
        "change.");
}

std::string PathOf(const MeasuredEmg& channel) {
  std::vector<std::string> keys;
  for (const int muscle : channel.muscles)
    keys.emplace_back(muscles::MuscleTable()[static_cast<std::size_t>(muscle)].key);
  return std::string(HandName(channel.hand)) + "." + Join(keys, "+");
}

EmgAgreement AgreementOf(const MeasuredEmg& channel) {
  EmgAgreement sum;
  double count = 0;
  for (std::size_t i = 0; i < channel.modelled.size(); ++i) {
    const double difference = channel.measured[i] - channel.modelled[i];
    if (!std::isfinite(difference)) continue;
    sum.measured += channel.measured[i];
    sum.modelled += channel.modelled[i];
    sum.rms += difference * difference;
    count += 1;
  }
  if (count == 0) return {kUnknownValue, kUnknownValue, kUnknownValue};
  return {sum.measured / count, sum.modelled / count, std::sqrt(sum.rms / count)};
}

std::string Sentence(const MeasuredEmg& channel) {
  std::string text = Formatted(
      "%s, %s: measured for %.1f %% of the time (%s), largest envelope %.2f of the "
      "maximum voluntary contraction",
      PathOf(channel).c_str(), Printable(channel.channel).c_str(), 100 * channel.share,
      Printable(channel.source).c_str(), channel.largest);
  const EmgAgreement agreement = AgreementOf(channel);
  if (std::isfinite(agreement.rms))
    Append(&text,
           "; mean activation %.1f %% measured, %.1f %% modelled with it, rms difference %.1f %%",
           100 * agreement.measured, 100 * agreement.modelled, 100 * agreement.rms);
  return text + ".";
}

}  // namespace predictor::assessment
