#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/choice.h"
#include "core/handle_target.h"
#include "core/norm.h"
#include "core/units.h"
#include "core/words.h"
#include "evaluation/guidance_distance.h"
#include "report/run_data.h"

namespace predictor {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kMaxShownEvents = 1000, kMaxParts = 2000, kMaxPages = 64;
constexpr std::size_t kMaxMarkers = 6;     // number of markers around which every tick is
                                           // kept
constexpr std::size_t kDetailedStops = 4;  // likewise for stops
constexpr double kAfterStop = 2;           // [s]
constexpr double kPathStep = 0.05;         // [s]

constexpr std::pair<InputKind, const char*> kInputWords[] = {
    {InputKind::kAlign, "a page: align"},
    {InputKind::kStart, "a page: start"},
    {InputKind::kReset, "a page: reset"},
    {InputKind::kHeadset, "a headset stopped responding"},
    {InputKind::kWatchdog, "the watchdog stopped responding"},
    {InputKind::kSuspended, "the computer was suspended"}};

// The worst value so far, and its position in the trace.
struct Worst {
  const char* what;
  double value = 0;
  std::size_t interest = 0;
  bool known = false;
};

}  // namespace

class RunCollector::Impl {
 public:
  Impl(RunInfo info, const ReadOptions& options);
  void Add(const TickRecord& record);
  RunData Finish();

 private:
  void Begin(const TickRecord& record);
  void FollowStates(const TickRecord& record);
  void FollowStop(const TickRecord& record);
  void FollowPower(const TickRecord& record);
  void FollowEvents(const TickRecord& record);
  void FollowInputs(const TickRecord& record);
  void FollowMarkers(std::uint64_t tick);
  void AddHand(const TickRecord& record, int i);
  void AddPair(const TickRecord& record);
  void AddCobot(const TickRecord& record);
  void AddActive(const TickRecord& record);
  void AddEnergy(const TickRecord& record);
  void AddTiming(const TickRecord& record);
  void AddPath(const TickRecord& record);
  void Note(std::uint64_t tick, std::string text, bool marker = false);
  void Compare(Worst* worst, double value, std::uint64_t tick);
  void Set(std::size_t channel, double value) { values_[channel] = static_cast<float>(value); }
  void SetHand(int hand, HandChannel channel, double value) {
    Set(ChannelOf(hand, channel), value);
  }

  RunData d_;
  SummaryBuilder summary_;
  std::vector<OscillationIndex> oscillation_;  // one per hand
  std::array<float, kChannels> values_{};
  bool began_ = false, ran_ = false;
  RunState state_ = RunState::kInit;
  StopCause harder_ = StopCause::kNone;
  std::int32_t action_ = -1;
  std::uint16_t active_events_ = 0;
  std::uint8_t cobot_stop_ = 0;
  std::uint64_t last_wall_ = 0, path_ticks_ = 1;
  std::size_t next_marker_ = 0, markers_ = 0;
  double stored_start_ = 0;
  Worst error_{"largest distance between a real handle and its virtual handle"},
      rotation_{"largest angle between a real handle and its virtual handle"},
      distance_{"largest error of the handles' distance"},
      angle_{"largest error of the handles' relative rotation"}, tick_{"longest tick"};
};

RunCollector::Impl::Impl(RunInfo info, const ReadOptions& options) : summary_(info.scenario) {
  d_.info = std::move(info);
  d_.dt = 1 / d_.info.scenario.rate;
  d_.trace = Trace(kChannels, d_.dt, options.detail);
  oscillation_.assign(kHands, OscillationIndex(d_.dt));
  path_ticks_ = static_cast<std::uint64_t>(std::max(1L, std::lround(kPathStep / d_.dt)));
  std::stable_sort(d_.info.events.begin(), d_.info.events.end(),
                   [](const auto& a, const auto& b) { return a.tick < b.tick; });
}

void RunCollector::Impl::Begin(const TickRecord& record) {
  began_ = true;
  d_.first = d_.origin = record.tick;
  state_ = record.state;
  action_ = record.action;
  d_.parts.push_back({record.tick, record.tick, record.state});
  d_.real_time = record.wall_ns != 0;
}

void RunCollector::Impl::Note(std::uint64_t tick, std::string text, bool marker) {
  if (d_.events.size() == kMaxShownEvents) {
    ++d_.more_events;
    return;
  }
  d_.events.push_back({tick, std::move(text), marker});
}

void RunCollector::Impl::Compare(Worst* worst, double value, std::uint64_t tick) {
  if (!(value > worst->value)) return;
  worst->value = value;
  if (worst->known) return d_.trace.Move(worst->interest, tick);
  worst->known = true;
  worst->interest = d_.trace.Keep({tick, 5, 5, 1, worst->what});
}

void RunCollector::Impl::FollowStates(const TickRecord& record) {
  if (record.state != state_) {
    Note(record.tick, std::string("state ") + Name(record.state));
    if (d_.parts.size() < kMaxParts) {
      d_.parts.back().to = record.tick;
      d_.parts.push_back({record.tick, record.tick, record.state});
    }
  }
  state_ = record.state;
  d_.parts.back().to = record.tick + 1;
  if (record.action != action_ && record.action >= 0) {
    const auto& script = d_.info.scenario.operator_.script;
    const auto index = static_cast<std::size_t>(record.action);
    Note(record.tick, index < script.size() ? "action '" + script[index].action + "'"
                                            : "the script's next action");
  }
  action_ = record.action;
}

// Marks the events in the plots.
void RunCollector::Impl::FollowEvents(const TickRecord& record) {
  const unsigned changed = record.events ^ std::exchange(active_events_, record.events);
  for (std::size_t i = 0; i < d_.info.scenario.events.size(); ++i) {
    if ((changed >> i & 1U) == 0) continue;
    const bool begins = (record.events >> i & 1U) != 0;
    const std::string name = "event '" + d_.info.scenario.events[i].event + "'";
    Note(record.tick, begins ? name : name + " ends", true);
    if (begins) d_.trace.Keep({record.tick, 5, 5, 2, name});
  }
  const std::uint8_t before = std::exchange(cobot_stop_, record.cobot_stop);
  if (record.cobot_stop == 0 || before != 0 || record.cobot_stop >= kCobotStops) return;
  Note(record.tick,
       "the cobot stops itself: " + CobotStopWords(static_cast<CobotStop>(record.cobot_stop)),
       true);
}

// The function uses the result of the summary, because the summary has already processed this
// record.
void RunCollector::Impl::FollowStop(const TickRecord& record) {
  const std::vector<StopSummary>& stops = summary_.stops().stops();
  if (d_.stops.size() != stops.size()) {
    d_.stops.push_back({record.tick, stops.back()});
    Note(record.tick, std::string("STOP: ") + Name(record.cause));
    if (d_.stops.size() <= kDetailedStops)
      d_.trace.Keep({record.tick, Trace::kBefore, kAfterStop, 0, "stop"});
  }
  FollowPower(record);
}

// The fault that removes the power occurs with the decision to stop or long after it. This fault
// belongs to the last stop. If there were too many stops and the last one was therefore not kept,
// the fault belongs to none of the kept stops.
void RunCollector::Impl::FollowPower(const TickRecord& record) {
  const StopCause before = std::exchange(harder_, record.harder.cause);
  if (harder_ == StopCause::kNone || before != StopCause::kNone) return;
  Note(record.tick, std::string("POWER OFF: ") + Name(harder_));
  if (!d_.stops.empty() && d_.stops.size() == summary_.stops().count())
    d_.stops.back().power_off = record.tick;
}

void RunCollector::Impl::FollowInputs(const TickRecord& record) {
  const int count = std::min<int>(record.input_count, kInputsPerTick);
  for (int k = 0; k < count; ++k) {
    const RunInput& input = record.inputs[static_cast<std::size_t>(k)];
    switch (input.kind) {
      case InputKind::kStop:
        Note(record.tick,
             input.value == kEndAsPlanned ? "a page ended the run" : "a page requested a stop");
        break;
      case InputKind::kParameter:
        if (static_cast<int>(input.parameter) < kParameters)
          Note(record.tick,
               std::string("a page: ") + Name(input.parameter) + " = " + Significant(input.value));
        break;
      case InputKind::kLatency:
        if (d_.pages.size() < kMaxPages || d_.pages.contains(input.client)) {
          d_.pages[input.client].received.Add(std::max(0.0, input.p[1]));
          d_.pages[input.client].rendered.Add(std::max(0.0, input.p[2]));
        }
        break;
      default:
        for (const auto& [kind, words] : kInputWords)
          if (kind == input.kind) Note(record.tick, words);
    }
  }
}

void RunCollector::Impl::FollowMarkers(std::uint64_t tick) {
  const auto& events = d_.info.events;
  for (; next_marker_ < events.size() && events[next_marker_].tick <= tick; ++next_marker_) {
    Note(events[next_marker_].tick, events[next_marker_].text, true);
    if (++markers_ <= kMaxMarkers)
      d_.trace.Keep({events[next_marker_].tick, 5, 5, 2, "marker: " + events[next_marker_].text});
  }
}

void RunCollector::Impl::AddHand(const TickRecord& record, int i) {
  const HandRecord& h = record.hands[static_cast<std::size_t>(i)];
  if (!h.present) return;
  using C = HandChannel;
  if (record.ran) {
    d_.present.Add(i);
    const Pose real = FromRecord(h.real.pose);
    const Pose goal = HandleTarget(record, static_cast<std::size_t>(i));
    const double error = (real.p - goal.p).norm();
    const double rotation = RotationError(goal.q, real.q).norm();
    SetHand(i, C::kError, 1e3 * error);
    SetHand(i, C::kErrorRotation, kDegrees * rotation);
    SetHand(i, C::kCouplingForce, Norm(h.coupling.data()));
    SetHand(i, C::kCouplingTorque, Norm(h.coupling.data() + 3));
    Compare(&error_, error, record.tick);
    Compare(&rotation_, rotation, record.tick);
    const auto* window = oscillation_[static_cast<std::size_t>(i)].Add(
        static_cast<double>(record.tick - d_.origin) * d_.dt,
        Vector3(h.wrench[0], h.wrench[1], h.wrench[2]));
    if (window) d_.oscillation[static_cast<std::size_t>(i)].push_back(*window);
  } else {
    oscillation_[static_cast<std::size_t>(i)].Break();
  }
  SetHand(i, C::kForceX, h.wrench[0]);
  SetHand(i, C::kForceY, h.wrench[1]);
  SetHand(i, C::kForceZ, h.wrench[2]);
  SetHand(i, C::kForce, Norm(h.wrench.data()));
  SetHand(i, C::kTorque, Norm(h.wrench.data() + 3));
  SetHand(i, C::kSpeed, 1e3 * Norm(h.real.twist.data()));
  const int dof = std::min<int>(h.arm_dof, kMaxArmJoints);
  d_.arm_dof[static_cast<std::size_t>(i)] = std::max(d_.arm_dof[static_cast<std::size_t>(i)], dof);
  for (int j = 0; j < dof; ++j)
    Set(ChannelOf(i, C::kJoint, j), kDegrees * h.q[static_cast<std::size_t>(j)]);
}

void RunCollector::Impl::AddPair(const TickRecord& record) {
  if (!record.ran || !record.hands[0].present || !record.hands[1].present) return;
  const Pose r0 = FromRecord(record.hands[0].real.pose), r1 = FromRecord(record.hands[1].real.pose);
  const Pose v0 = FromRecord(record.hands[0].virtual_.pose),
             v1 = FromRecord(record.hands[1].virtual_.pose);
  const double distance = std::abs((r1.p - r0.p).norm() - (v1.p - v0.p).norm());
  const double angle = RotationError(v0.q.conjugate() * v1.q, r0.q.conjugate() * r1.q).norm();
  Set(ChannelOf(RunChannel::kDistance), 1e3 * distance);
  Set(ChannelOf(RunChannel::kAngle), kDegrees * angle);
  Compare(&distance_, distance, record.tick);
  Compare(&angle_, angle, record.tick);
}

void RunCollector::Impl::AddActive(const TickRecord& record) {
  unsigned any = 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    const unsigned active = record.hands[i].at_lower | record.hands[i].at_upper;
    any |= active;
    for (std::size_t j = 0; j < kMaxArmJoints; ++j) d_.bound_ticks[i][j] += active >> j & 1U;
  }
  d_.bounded_ticks += any != 0;
  d_.row_ticks += record.qp_rows != 0;
}

void RunCollector::Impl::AddCobot(const TickRecord& record) {
  using C = RunChannel;
  if (std::isfinite(record.link_distance)) Set(ChannelOf(C::kLinkDistance), record.link_distance);
  d_.cobot_dof = std::min<int>(record.cobot_dof, kMaxCobotJoints);
  for (int j = 0; j < d_.cobot_dof; ++j)
    Set(ChannelOf(C::kCobotJoint, j),
        (d_.IsPrismatic(j) ? 1e3 : kDegrees) * record.cobot_q[static_cast<std::size_t>(j)]);
  if (!ran_) return;
  const std::array<double, 3>& p = record.object.pose.p;
  for (std::size_t k = 0; k < 3; ++k)
    Set(ChannelOf(C::kObjectX, static_cast<int>(k)), 1e3 * (p[k] - d_.object_start[k]));
  if (!record.ran) return;
  if (record.rendered) {
    const double slack = Norm(record.relative_slack.data());
    const double rotation = Norm(record.relative_slack.data() + 3);
    Set(ChannelOf(C::kSlack), 1e3 * slack);
    Set(ChannelOf(C::kSlackRotation), kDegrees * rotation);
    Set(ChannelOf(C::kLimitSlack), 1e3 * record.limit_slack);
    d_.slack_max = std::max(d_.slack_max, slack);
    d_.slack_rotation_max = std::max(d_.slack_rotation_max, rotation);
    d_.limit_slack_max = std::max(d_.limit_slack_max, record.limit_slack);
    d_.kkt_max = std::max(d_.kkt_max, record.kkt_residual);
    AddActive(record);
  }
  if (const auto off = GuidanceDistance(d_.info.scenario.guidance, p, d_.object_start))
    Set(ChannelOf(C::kGuidance), 1e3 * *off);
}

void RunCollector::Impl::AddEnergy(const TickRecord& record) {
  const bool moving = record.ran || record.state == RunState::kStopping;
  if (!ran_) return;
  for (int i = 0; i < kHands; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const HandRecord& h = record.hands[k];
    if (!h.present) continue;
    if (moving) d_.hand_port[k].Add(Power(h.wrench, h.real.twist), d_.dt);
    if (record.ran) {
      d_.virtual_port[k].Add(Power(h.wrench, h.virtual_.twist), d_.dt);
      d_.coupling_port[k].Add(Power(h.coupling, h.virtual_.twist), d_.dt);
    }
    SetHand(i, HandChannel::kEnergy, d_.hand_port[k].sum);
    SetHand(i, HandChannel::kEnergyVirtual, d_.virtual_port[k].sum);
    SetHand(i, HandChannel::kEnergyCoupling, d_.coupling_port[k].sum);
  }
  if (record.ran) d_.stored = record.energy - stored_start_;
  Set(ChannelOf(RunChannel::kStored), d_.stored);
}

void RunCollector::Impl::AddTiming(const TickRecord& record) {
  const double us = static_cast<double>(record.stage_us[static_cast<std::size_t>(Stage::kTick)]);
  Set(ChannelOf(RunChannel::kTick), us);
  if (record.ran) {
    Compare(&tick_, us, record.tick);
    const auto bin = static_cast<std::size_t>(RunData::kTickBins *
                                              std::clamp(std::log10(std::max(1.0, us)), 0.0, 8.0));
    if (bin >= d_.tick_counts.size()) d_.tick_counts.resize(bin + 1);
    ++d_.tick_counts[bin];
  }
  if (record.wall_ns != 0 && last_wall_ != 0)
    d_.jitter.Add(std::abs(static_cast<double>(record.wall_ns - last_wall_) * 1e-3 - 1e6 * d_.dt));
  last_wall_ = record.wall_ns;
  if (!record.ran) return;
  for (const HandRecord& h : record.hands) {
    if (!h.present || h.arm_dof == 0) continue;
    d_.sensor_age.Add(1e6 * h.sensor_age);
    d_.arm_age.Add(1e6 * h.arm_age);
  }
}

void RunCollector::Impl::AddPath(const TickRecord& record) {
  if (!record.ran || (record.tick - d_.origin) % path_ticks_ != 0) return;
  for (std::size_t k = 0; k < 3; ++k) {
    d_.object_path[k].push_back(static_cast<float>(record.object.pose.p[k]));
    for (std::size_t i = 0; i < kHands; ++i)
      d_.handle_paths[i][k].push_back(
          record.hands[i].present ? static_cast<float>(record.hands[i].real.pose.p[k]) : kNone);
  }
}

void RunCollector::Impl::Add(const TickRecord& record) {
  if (!began_) Begin(record);
  if (d_.records > 0 && record.tick <= d_.last) {
    ++d_.disordered;
    return;
  }
  if (d_.records > 0 && record.tick != d_.last + 1) {
    ++d_.gaps;
    d_.lost += record.tick - d_.last - 1;
    last_wall_ = 0;
    for (OscillationIndex& index : oscillation_) index.Break();
  }
  d_.last = record.tick;
  ++d_.records;
  if (record.ran && !ran_) {
    ran_ = true;
    d_.origin = record.tick;
    d_.object_start = record.object.pose.p;
    stored_start_ = record.energy;
  }
  summary_.Add(record);
  FollowMarkers(record.tick);
  FollowStates(record);
  FollowEvents(record);
  FollowStop(record);
  FollowInputs(record);
  values_.fill(kNone);
  for (int i = 0; i < kHands; ++i) AddHand(record, i);
  AddPair(record);
  AddCobot(record);
  AddEnergy(record);
  AddTiming(record);
  AddPath(record);
  d_.trace.Add(record.tick, values_.data());
  d_.parameters = record.parameters;
  d_.has_parameters = true;
}

RunData RunCollector::Impl::Finish() {
  FollowMarkers(std::numeric_limits<std::uint64_t>::max());
  d_.trace.Finish();
  d_.dissipated = -d_.stored;
  for (std::size_t i = 0; i < kHands; ++i)
    d_.dissipated += d_.virtual_port[i].sum + d_.coupling_port[i].sum;
  d_.summary = summary_.summary();
  d_.summary.loop = d_.info.loop;
  for (std::size_t i = 0; i < d_.stops.size(); ++i) {
    d_.stops[i].summary = d_.summary.stops[i];
    d_.stops[i].summary.time = d_.TimeOf(d_.stops[i].tick);
  }
  d_.summary.overruns = d_.summary.Get<std::uint64_t>("deadlines.late_ticks");
  d_.summary.records_dropped = d_.lost;
  return std::move(d_);
}

RunCollector::RunCollector(RunInfo info, const ReadOptions& options)
    : impl_(std::make_unique<Impl>(std::move(info), options)) {}
RunCollector::~RunCollector() = default;
void RunCollector::Add(const TickRecord& record) { impl_->Add(record); }
RunData RunCollector::Finish() { return impl_->Finish(); }

}  // namespace predictor
