#include "assessment/live_streams.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace predictor::assessment {
namespace {

constexpr double kKeptTime = kOldestHeartRate + 1;  // measurements that are kept [s]
constexpr double kEmgWindow = 1;                    // from which an activation is computed [s]
// At the beginning and after a gap, a channel fails for less than kEmgWindow. Only a longer failure
// is reported (design choice) [s].
constexpr double kEmgPatience = 2 * kEmgWindow;

InputState& Input(PersonState* state, PersonInput input) {
  return state->inputs[static_cast<std::size_t>(input)];
}

void Set(InputStatus status, double run_time, InputState* input) {
  input->status = status;
  if (status == InputStatus::kMeasured) input->last = static_cast<float>(run_time);
}

bool IsHeartRate(const tracks::SignalTrack& signal) {
  return std::ranges::find(kHeartRateNames, signal.name) != kHeartRateNames.end();
}

// Returns the part of a channel from `time` on.
tracks::EmgTrack Since(double time, const tracks::EmgTrack& emg) {
  const auto first = std::ranges::lower_bound(emg.times, time) - emg.times.begin();
  return {emg.map,
          {emg.times.begin() + first, emg.times.end()},
          {emg.values.begin() + first, emg.values.end()}};
}

void RefuseTwice(const std::string& what, const std::string& source, bool* seen) {
  if (std::exchange(*seen, true))
    throw InputError(source,
                     "The " + what + " is also measured by another stream. Map it only once.");
}

}  // namespace

LiveStreams::LiveStreams(std::span<const tracks::StreamDescription> streams) {
  std::array<bool, kHands> elbows{};
  bool head = false, heart_rate = false;
  for (const tracks::StreamDescription& stream : streams) {
    Stream& added = streams_.emplace_back(tracks::StreamTrack(stream));
    const tracks::BodyTrack& track = added.track.track();
    const std::string& name = added.track.name();
    if (track.head) RefuseTwice("head", name, &head);
    for (std::size_t h = 0; h < kHands; ++h)
      if (track.elbows[h])
        RefuseTwice(std::string(HandName(static_cast<int>(h))) + " elbow", name, &elbows[h]);
    for (const tracks::SignalTrack& signal : track.signals)
      if (IsHeartRate(signal)) RefuseTwice("heart rate", name, &heart_rate);
    for (const tracks::EmgTrack& emg : track.emg) emg_.push_back(DescribeEmg(emg, name, emg_));
    emg_failures_.resize(emg_.size());
    added.awaited = track.head || track.elbows[0] || track.elbows[1] || !track.emg.empty();
  }
}

void LiveStreams::Take(const StreamSample& sample, std::uint64_t newest_ns) {
  if (!IsCredible(sample, newest_ns) || sample.stream >= streams_.size()) return;
  Stream& stream = streams_[sample.stream];
  if (sample.count != stream.track.channels() || sample.wall_ns <= stream.last_ns) return;
  stream.last_ns = sample.wall_ns;
  stream.track.Take(Seconds(sample.wall_ns), std::span(sample.values).first(sample.count));
}

bool LiveStreams::IsAwaited(std::uint64_t tick_ns, std::uint64_t newest_ns) const {
  return std::ranges::any_of(streams_, [&](const Stream& stream) {
    const double last = Seconds(stream.last_ns) + stream.track.offset();
    return stream.awaited && stream.last_ns != 0 && last < Seconds(tick_ns) &&
           Seconds(newest_ns) <=
               Seconds(stream.last_ns) + tracks::PartTrack::kMaxGap + kLongestStreamDelay;
  });
}

void LiveStreams::Convert(double clock) {
  for (Stream& stream : streams_) {
    try {
      stream.track.Convert();
    } catch (const InputError& error) {
      if (!std::exchange(stream.failed, true)) problems_.emplace_back(error.what());
    }
    stream.track.Forget(clock - kKeptTime);
  }
}

void LiveStreams::Update(double clock, double run_time, PersonState* state) {
  Convert(clock);
  for (const Stream& stream : streams_)
    for (const tracks::SignalTrack& signal : stream.track.track().signals)
      if (IsHeartRate(signal)) AddHeartRate(signal, clock, run_time, state);
}

void LiveStreams::AddTo(double clock, const PersonSetup& setup, PersonSample* sample,
                        PersonState* state) {
  for (const Stream& stream : streams_) {
    const tracks::BodyTrack& track = stream.track.track();
    for (std::size_t h = 0; h < kHands; ++h)
      if (track.elbows[h]) AddElbow(*track.elbows[h], h, clock, setup, sample, state);
    if (track.head && state->head == HeadSource::kModelled)
      AddHead(*track.head, clock, setup, sample, state);
  }
}

// As LiveHead::AddTo.
void LiveStreams::AddHead(const tracks::PartTrack& head, double clock, const PersonSetup& setup,
                          PersonSample* sample, PersonState* state) {
  PersonSample with = *sample;
  state->head = AddHeadAt(clock, head, setup, &with, &head_);
  if (state->head == HeadSource::kModelled) return;
  if (head_.MostlyImpossible()) state->head = HeadSource::kImpossible;
  if (state->head == HeadSource::kMeasured) *sample = std::move(with);
}

void LiveStreams::AddElbow(const tracks::PartTrack& elbow, std::size_t hand, double clock,
                           const PersonSetup& setup, PersonSample* sample, PersonState* state) {
  InputState& input = Input(state, hand == 0 ? PersonInput::kLeftElbow : PersonInput::kRightElbow);
  const auto p = elbow.PositionAt(clock);
  if (!p) return Set(InputStatus::kMissing, 0, &input);
  PositionCount& count = elbows_[hand];
  ++count.measured;
  const person::HandSample& held = sample->body.hands[hand];
  const bool possible =
      IsPossible(setup, *p) &&
      (!held.present || (*p - held.X_WD.p).norm() < kElbowToHandle * setup.body.height);
  count.impossible += possible ? 0 : 1;
  if (!possible || count.MostlyImpossible()) return Set(InputStatus::kImpossible, 0, &input);
  sample->body.p_WElbow[hand] = *p;
  Set(InputStatus::kMeasured, sample->body.time, &input);
}

void LiveStreams::AddHeartRate(const tracks::SignalTrack& signal, double clock, double run_time,
                               PersonState* state) {
  InputState& input = Input(state, PersonInput::kHeartRate);
  const auto after = std::ranges::upper_bound(signal.times, clock) - signal.times.begin();
  const double value =
      after == 0 ? tracks::kMissing : signal.values[static_cast<std::size_t>(after) - 1];
  const double age = after == 0 ? 0 : clock - signal.times[static_cast<std::size_t>(after) - 1];
  const bool present = std::isfinite(value) && age < kOldestHeartRate;
  state->heart_rate = present ? static_cast<float>(value) : kUnknown;
  Set(present ? InputStatus::kMeasured : InputStatus::kMissing, run_time - age, &input);
}

std::array<MeasuredActivations, kHands> LiveStreams::ActivationsAt(double clock, double run_time,
                                                                   PersonState* state) {
  std::size_t next = 0;
  std::array<bool, kHands> expected{}, measured{};
  for (const Stream& stream : streams_)
    for (const tracks::EmgTrack& emg : stream.track.track().emg) {
      MeasuredEmg& channel = emg_[next];
      const auto hand = static_cast<std::size_t>(channel.hand);
      channel.measured = {
          ActivationOf(Since(clock - kEmgWindow, emg), clock, &emg_failures_[next++])};
      expected[hand] = true;
      measured[hand] = measured[hand] || std::isfinite(channel.measured[0]);
    }
  constexpr std::array kInputs = {PersonInput::kLeftEmg, PersonInput::kRightEmg};
  for (std::size_t h = 0; h < kHands; ++h)
    if (expected[h])
      Set(measured[h] ? InputStatus::kMeasured : InputStatus::kMissing, run_time,
          &Input(state, kInputs[h]));
  return assessment::ActivationsAt(emg_, 0);
}

// Returns NaN if the channel cannot be used at this time.
double LiveStreams::ActivationOf(const tracks::EmgTrack& emg, double clock, EmgFailure* failure) {
  try {
    const double activation =
        emg.times.empty() ? tracks::kMissing : ActivationsOf(emg).At(clock, 1 / kSampleRate);
    failure->since.reset();
    return activation;
  } catch (const InputError& error) {
    if (!failure->since) failure->since = clock;
    if (clock - *failure->since > kEmgPatience && !std::exchange(failure->reported, true))
      problems_.push_back("The electromyogram " + Quote(emg.map.channel) + ": " + error.what());
  }
  return tracks::kMissing;
}

}  // namespace predictor::assessment
