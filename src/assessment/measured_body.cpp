#include "assessment/measured_body.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "assessment/measured_head.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "evaluation/statistics_samples.h"

namespace predictor::assessment {
namespace {

struct Finding {
  PositionCount count;
  std::vector<double> heights, distances;  // the impossible positions, in S [m]

  void AddImpossible(const PersonSetup& setup, const Vector3& p_W) {
    const Vector3 p = setup.stance.X_WS.Inverse() * p_W;
    heights.push_back(p.z());
    distances.push_back(std::hypot(p.x(), p.y()));
  }
};

// Returns the time of a sample by the clock of the track [s].
double TimeOf(const PersonSample& sample, const UsedTrack& track) {
  return (track.by_clock ? sample.by_clock : sample.recorded) - track.offset;
}

double Share(std::size_t count, std::size_t all) {
  return static_cast<double>(count) / static_cast<double>(all);
}

void Judge(const Finding& finding, const std::string& what, const std::string& source,
           const PersonSetup& setup, MeasuredBody* body) {
  if (finding.count.impossible == 0) return;
  if (finding.count.MostlyImpossible())
    throw InputError(
        source,
        Formatted("The %s is %.2f m above the operator's ground and %.2f m beside the feet, which "
                  "is impossible for a person of %.2f m. Check the unit and the frame in the "
                  "mapping, and operator.stance.",
                  what.c_str(), Median(finding.heights), Median(finding.distances),
                  setup.body.height));
  body->warnings.push_back(
      Formatted("%s: %.1f %% of the positions of the %s are impossible and are left out.",
                Printable(source).c_str(),
                100 * Share(finding.count.impossible, finding.count.measured), what.c_str()));
}

void AddHead(const tracks::PartTrack& head, const UsedTrack& track, const PersonSetup& setup,
             std::vector<PersonSample>* samples, MeasuredBody* body) {
  Finding finding;
  std::size_t positions = 0, rotations = 0;
  for (PersonSample& sample : *samples) {
    const double time = TimeOf(sample, track);
    const HeadSource source = AddHeadAt(time, head, setup, &sample, &finding.count);
    if (source == HeadSource::kImpossible) finding.AddImpossible(setup, *head.PositionAt(time));
    if (source != HeadSource::kMeasured) continue;
    ++positions;
    rotations += sample.body.head_rotation_measured ? 1 : 0;
  }
  Judge(finding, "head", track.source, setup, body);
  body->parts.push_back({"head", track.source, Share(positions, samples->size()), {}});
  if (!head.q.empty())
    body->parts.push_back({"head rotation", track.source, Share(rotations, samples->size()), {}});
}

void AddElbow(const tracks::PartTrack& elbow, int hand, const UsedTrack& track,
              const PersonSetup& setup, std::vector<PersonSample>* samples, MeasuredBody* body) {
  const auto h = static_cast<std::size_t>(hand);
  const std::string what = std::string(HandName(hand)) + " elbow";
  Finding finding;
  std::vector<double> to_handle;
  std::size_t positions = 0;
  for (PersonSample& sample : *samples) {
    const auto p = elbow.PositionAt(TimeOf(sample, track));
    if (!p) continue;
    ++finding.count.measured;
    if (!IsPossible(setup, *p)) {
      ++finding.count.impossible;
      finding.AddImpossible(setup, *p);
      continue;
    }
    if (sample.body.hands[h].present)
      to_handle.push_back((*p - sample.body.hands[h].X_WD.p).norm());
    sample.body.p_WElbow[h] = *p;
    ++positions;
  }
  Judge(finding, what, track.source, setup, body);
  if (!to_handle.empty() && Median(to_handle) > kElbowToHandle * setup.body.height)
    throw InputError(track.source,
                     Formatted("The %s is %.2f m away from its handle, farther than a forearm "
                               "reaches. Check the frame, and that left and right are not "
                               "exchanged.",
                               what.c_str(), Median(to_handle)));
  body->parts.push_back({what, track.source, Share(positions, samples->size()), {}});
}

void AddSignals(const tracks::BodyTrack& track, const UsedTrack& used,
                const std::vector<PersonSample>& samples, MeasuredBody* body) {
  for (const tracks::SignalTrack& signal : track.signals) {
    MeasuredSignal result{signal.name, signal.unit, used.source, 0, {}};
    std::size_t measured = 0;
    for (const PersonSample& sample : samples) {
      result.values.push_back(signal.At(TimeOf(sample, used), 1 / kSampleRate));
      measured += std::isfinite(result.values.back()) ? 1 : 0;
    }
    result.share = Share(measured, samples.size());
    body->signals.push_back(std::move(result));
  }
}

// Returns the clock offset that was estimated from the hand whose measured and recorded speeds
// agree better.
tracks::ClockOffset Estimate(const tracks::BodyTrack& track,
                             const std::vector<PersonSample>& samples) {
  std::vector<double> times;
  for (const PersonSample& sample : samples) times.push_back(sample.recorded);
  std::optional<tracks::ClockOffset> best;
  for (std::size_t h = 0; h < kHands; ++h) {
    if (!track.hands[h]) continue;
    std::vector<Vector3> handle;
    for (const PersonSample& sample : samples)
      handle.push_back(sample.body.hands[h].present ? sample.body.hands[h].X_WD.p
                                                    : Vector3::Constant(std::nan("")));
    const tracks::PartTrack& hand = track.hands[h]->pose;
    const auto found = tracks::EstimateOffset({times, handle}, {hand.times, hand.p}, track.source);
    if (!best || found.correlation > best->correlation) best = found;
  }
  return *best;  // set, because a mapping with an unknown clock must map a hand
}

// Warns about measurements that are almost never near the time of the run.
void AddRareWarnings(MeasuredBody* body) {
  constexpr double kRare = 0.01;  // share of the time (design choice)
  for (const MeasuredPart& part : body->parts)
    if (part.share < kRare)
      body->warnings.push_back(Formatted(
          "%s: The %s is measured for only %.1f %% of the time, so it hardly changes the results. "
          "Check the rate and the clock of the measurement.",
          Printable(part.source).c_str(), part.what.c_str(), 100 * part.share));
}

UsedTrack Relate(const tracks::BodyTrack& track, double start_unix,
                 const std::vector<PersonSample>& samples) {
  UsedTrack used{
      std::filesystem::path(track.source).filename().string(), track.offset, {}, track.of_the_run};
  if (track.clock == tracks::TrackClock::kUnix) used.offset -= start_unix;
  if (track.clock == tracks::TrackClock::kAuto) {
    used.estimate = Estimate(track, samples);
    used.offset = used.estimate->offset;
  }
  return used;
}

std::pair<double, double> SpanOf(const tracks::BodyTrack& track) {
  double first = INFINITY, last = -INFINITY;
  const auto add = [&](const std::vector<double>& times) {
    if (times.empty()) return;
    first = std::min(first, times.front());
    last = std::max(last, times.back());
  };
  if (track.head) add(track.head->times);
  for (std::size_t h = 0; h < kHands; ++h) {
    if (track.elbows[h]) add(track.elbows[h]->times);
    if (track.hands[h]) add(track.hands[h]->pose.times);
  }
  for (const tracks::SignalTrack& signal : track.signals) add(signal.times);
  for (const tracks::EmgTrack& emg : track.emg) add(emg.times);
  return {first, last};
}

void CheckOverlap(const tracks::BodyTrack& track, const UsedTrack& used,
                  const std::vector<PersonSample>& samples) {
  const auto [first, last] = SpanOf(track);
  if (first + used.offset <= samples.back().recorded &&
      last + used.offset >= samples.front().recorded)
    return;
  throw InputError(track.source,
                   Formatted("The file covers %.1f to %.1f s of the recording's time, but the "
                             "hands hold the handles from %.1f to %.1f s. Check clock and offset "
                             "in the mapping.",
                             first + used.offset, last + used.offset, samples.front().recorded,
                             samples.back().recorded));
}

// Two measurements of the same part of the body could contradict each other.
void CheckUnique(const MeasuredBody& body) {
  for (const MeasuredPart& a : body.parts)
    for (const MeasuredPart& b : body.parts)
      if (&a < &b && a.what == b.what)
        throw InputError(b.source, "The " + b.what + " is also measured in " + a.source +
                                       ". Map this part in only one of the files.");
}

void AddTrack(const tracks::BodyTrack& track, const PersonSetup& setup, double start_unix,
              std::vector<PersonSample>* samples, MeasuredBody* body) {
  const UsedTrack used = Relate(track, start_unix, *samples);
  CheckOverlap(track, used, *samples);
  body->tracks.push_back(used);
  for (const std::string& warning : track.warnings)
    body->warnings.push_back(used.source + ": " + warning);
  if (track.head) AddHead(*track.head, used, setup, samples, body);
  for (int hand = 0; hand < kHands; ++hand)
    if (const auto& elbow = track.elbows[static_cast<std::size_t>(hand)])
      AddElbow(*elbow, hand, used, setup, samples, body);
  AddSignals(track, used, *samples, body);
  std::vector<double> times;
  for (const PersonSample& sample : *samples) times.push_back(TimeOf(sample, used));
  AddEmg(track, times, &body->emg);
  CheckUnique(*body);
}

// Removes from a track of the run what another track measures already. The rest can still be used.
void LeaveOutWhatIsMeasured(tracks::BodyTrack* track, MeasuredBody* body) {
  for (const MeasuredPart& part : body->parts) {
    std::optional<tracks::PartTrack>* const here = part.what == "head"          ? &track->head
                                                   : part.what == "left elbow"  ? &track->elbows[0]
                                                   : part.what == "right elbow" ? &track->elbows[1]
                                                                                : nullptr;
    if (here == nullptr || !*here) continue;
    here->reset();
    body->warnings.push_back("The " + part.what + " of " + Printable(track->source) +
                             " in the recording is not used, because " + Printable(part.source) +
                             " measures it too.");
  }
  std::erase_if(track->emg, [&](const tracks::EmgTrack& emg) {
    try {
      DescribeEmg(emg, track->source, body->emg.channels);
      return false;
    } catch (const InputError& error) {
      body->warnings.push_back(std::string("An electromyogram in the recording is not used: ") +
                               error.what());
      return true;
    }
  });
}

bool IsEmpty(const tracks::BodyTrack& track) {
  return !track.head && !track.elbows[0] && !track.elbows[1] && track.signals.empty() &&
         track.emg.empty();
}

void AddTrackOfTheRun(const tracks::BodyTrack& track, const PersonSetup& setup, double start_unix,
                      std::vector<PersonSample>* samples, MeasuredBody* body) {
  tracks::BodyTrack rest = track;
  LeaveOutWhatIsMeasured(&rest, body);
  if (IsEmpty(rest)) return;
  std::vector<PersonSample> with = *samples;
  MeasuredBody measured = *body;
  try {
    AddTrack(rest, setup, start_unix, &with, &measured);
  } catch (const InputError& error) {
    body->warnings.push_back(std::string("The measurement in the recording is not used: ") +
                             error.what());
    return;
  }
  *samples = std::move(with);
  *body = std::move(measured);
}

}  // namespace

MeasuredBody AddTracks(std::span<const tracks::BodyTrack> tracks, const PersonSetup& setup,
                       double start_unix, std::vector<PersonSample>* samples) {
  MeasuredBody body;
  for (const tracks::BodyTrack& track : tracks) {
    (track.of_the_run ? AddTrackOfTheRun : AddTrack)(track, setup, start_unix, samples, &body);
  }
  body.warnings.insert(body.warnings.end(), body.emg.warnings.begin(), body.emg.warnings.end());
  AddRareWarnings(&body);
  return body;
}

void AddMisfit(std::span<const person::Posture> postures, MeasuredBody* measured,
               std::vector<std::string>* warnings) {
  for (MeasuredPart& part : measured->parts) {
    std::vector<double> misfits;
    for (const person::Posture& posture : postures) {
      const double misfit = part.what == "head"          ? posture.head_error
                            : part.what == "left elbow"  ? posture.elbow_error[0]
                            : part.what == "right elbow" ? posture.elbow_error[1]
                                                         : 0;
      if (misfit > 0) misfits.push_back(misfit);  // 0: not measured at this time
    }
    if (misfits.empty()) continue;
    part.misfit = Median(misfits);
    if (*part.misfit > kMaxMisfit)
      warnings->push_back(
          Formatted("The modelled body stays %.0f mm away from the measured %s in %s. Check the "
                    "frame in the mapping, operator.stance and operator.body.",
                    1e3 * *part.misfit, part.what.c_str(), Printable(part.source).c_str()));
  }
}

std::string MeasuredSentence(const MeasuredBody& measured) {
  if (measured.parts.empty())
    return "Only the hands were measured, so the rest of the posture is the most comfortable one.";
  std::vector<std::string> parts = {"the hands"};
  for (const MeasuredPart& part : measured.parts)
    parts.push_back(Formatted("the %s (%.0f %% of the time)", part.what.c_str(), 100 * part.share));
  return "These were measured: " + Join(parts) +
         ": the rest of the posture is the most comfortable one.";
}

std::string Sentence(const MeasuredPart& part) {
  std::string text = Formatted("%s: measured for %.1f %% of the time (%s)", part.what.c_str(),
                               100 * part.share, Printable(part.source).c_str());
  if (part.misfit) Append(&text, ", %.0f mm from the nominal body", 1e3 * *part.misfit);
  return text + ".";
}

std::string Sentence(const MeasuredSignal& signal) {
  const std::string unit = signal.unit.empty() ? "" : " [" + signal.unit + "]";
  return Formatted("%s: measured for %.1f %% of the time (%s); no score uses it.",
                   Printable(signal.name + unit).c_str(), 100 * signal.share,
                   Printable(signal.source).c_str());
}

std::string Sentence(const UsedTrack& track) {
  std::string text =
      Formatted("%s: its times plus %.3f s", Printable(track.source).c_str(), track.offset);
  if (track.estimate)
    Append(&text,
           ", estimated from the motion of the hands (± %.3f s with 95 %% confidence, correlation "
           "%.2f)",
           track.estimate->uncertainty, track.estimate->correlation);
  return text + ".";
}

}  // namespace predictor::assessment
