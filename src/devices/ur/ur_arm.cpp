#include "devices/ur/ur_arm.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <string_view>
#include <utility>

#include "devices/fault_latch.h"
#include "devices/ur/rtde_connection.h"
#include "devices/ur/ur_connect.h"
#include "devices/ur/ur_script.h"
#include "devices/ur/ur_state.h"
#include "devices/wire/device_clock.h"

namespace predictor {
namespace {

constexpr double kDeaf = 0.1;  // longest time for which our program may miss commands [s]
constexpr double kStop = 0.5;  // longest duration of a stop [s]
constexpr int kRestarted =
    3;  // number of packages with an earlier time that shows that the clock was set back
constexpr double kFresh = 0.02;  // age up to which a package is recent enough for this [s]
constexpr double kPowerOff = 1;  // time in which a power-off request is executed, with margin [s]
// A value beyond the range of these arms' sensors cannot be a measurement.
constexpr double kMaxForce = 500;   // [N]
constexpr double kMaxTorque = 100;  // [N·m]

bool Measurement(const UrVector& wrench) noexcept {
  for (std::size_t i = 0; i < wrench.size(); ++i)
    if (!(std::abs(wrench[i]) <= (i < 3 ? kMaxForce : kMaxTorque))) return false;
  return true;
}

class UrArm final : public Arm {
 public:
  UrArm(UrSetup setup, bool listen, Network* network)
      : network_(network),
        listen_(listen),
        connection_(std::move(setup.connection)),
        dashboard_(std::move(setup.dashboard)),
        facts_(std::move(setup.facts)),
        host_(connection_->peer().host),
        outputs_(setup.outputs),
        extras_(setup.extras),
        inputs_(setup.inputs),
        period_(setup.write_period),
        counter_(setup.counter) {
    now_ = network->Now();
    Accept(setup.state);
  }
  UrArm(const UrArm&) = delete;
  UrArm& operator=(const UrArm&) = delete;
  ~UrArm() override {
    if (!listen_) Send(nullptr);
  }

  const DeviceFacts& facts() const override { return facts_; }

  Status Read(ArmReading* reading) noexcept override {
    using State = rtde::Connection::State;
    now_ = network_->Now();
    const State state =
        connection_->Drain([this](const rtde::Packet& packet) noexcept { return Take(packet); });
    if (state == State::kClosed) fault_.Set(UrFault::kClosed);
    if (state == State::kMalformed) fault_.Set(UrFault::kMalformed);
    ReadDashboard();
    Report(reading);
    return Now();
  }

  Status Write(const JointVector& v, bool motion) noexcept override {
    if (motion && (listen_ || v.size() != kUrJoints || !v.allFinite()))
      fault_.Set(UrFault::kCommand);
    if (listen_) return Now();
    const std::uint64_t now = network_->Now();
    const bool moves = motion && MayFollow(v, now);
    if (now < next_ && moves == moves_) return Now();
    // A tick that begins slightly early counts too.
    next_ = now + static_cast<std::uint64_t>(1e9 * (period_ - 0.0005));
    moves_ = moves;
    if (moves || !fault_.any()) counter_ = static_cast<std::int32_t>(Unsigned(counter_) + 1U);
    if (!Send(moves ? &v : nullptr)) fault_.Set(UrFault::kClosed);
    return Now();
  }

  void PowerOff(bool wanted) noexcept override {
    static constexpr std::string_view kLine = "power off\n";
    if (!wanted) power_ = Power::kWanted;
    if (!wanted || power_ != Power::kWanted) return;
    power_ = Power::kUnwanted;
    unwanted_since_ = network_->Now();
    // A stream may accept data although its connection is dead. Therefore, only the robot's mode
    // shows whether the request succeeded.
    if (dashboard_ && !dashboard_->Write(std::as_bytes(std::span(kLine)))) dashboard_lost_ = true;
  }

  std::string Trouble() const override {
    const UrFault now = fault_.any() ? fault_.first() : arm_fault_.load();
    if (now == UrFault::kNone && behind_ >= kRestarted)
      return host_ + " has restarted its clock, as after a reboot. Restart this program.";
    if (now == UrFault::kNone) return "";
    std::string text = host_ + " " + Sentence(now);
    if (fault_.worse() != UrFault::kNone)
      text += " Since then it " + std::string(Sentence(fault_.worse()));
    return text;
  }

 private:
  // kUnwanted means that power-off was requested. The robot then reports that its power is off or,
  // after a long time, that its power is still on.
  enum class Power : std::uint8_t { kWanted, kUnwanted, kCut, kKept };
  static constexpr int kMaxReads = 16;

  static std::uint32_t Unsigned(std::int32_t x) noexcept { return static_cast<std::uint32_t>(x); }

  // While the arm executes commands, its reported joints may be unreliable. The commands of the
  // stop that follows bring this arm to rest together with the other arm. The arm is not moved
  // again.
  bool MayFollow(const JointVector& v, std::uint64_t now) noexcept {
    if (!fault_.any()) stop_by_ = now + static_cast<std::uint64_t>(1e9 * kStop);
    if (!fault_.any()) return true;
    if (fault_.first() != UrFault::kNumbers || v.isZero(0)) stop_by_ = 0;
    return now < stop_by_;
  }
  Status Now() const noexcept {
    Status status;
    if (!fault_.any()) return status;
    status.cause = StopCause::kDevice;
    status.power_off = fault_.ends_without_power();
    return status;
  }

  // Returns false for a malformed packet.
  bool Take(const rtde::Packet& packet) noexcept {
    if (packet.type == rtde::PacketType::kText) return true;
    UrState state;
    if (packet.type != rtde::PacketType::kData ||
        !Decode(packet.payload, outputs_, extras_, &state))
      return false;
    if (!Plausible(state)) {
      fault_.Set(UrFault::kNumbers);
    } else if (state.timestamp < state_.timestamp) {
      ++behind_;
    } else if (state.timestamp > state_.timestamp) {
      // A packet with the same time-stamp as the last packet is a repetition and contains no new
      // information.
      Accept(state);
      if (!listen_) fault_.Set(RunFault(state));
      if (!listen_ && Deaf()) fault_.Set(UrFault::kDeaf);
    }
    return true;
  }

  void Accept(const UrState& state) noexcept {
    if (link_.taken > 0) CountSkipped(state.timestamp - state_.timestamp);
    ++link_.taken;
    behind_ = 0;
    clock_.Arrived(state.timestamp, now_);
    state_ = state;
    arm_fault_.store(ArmFault(state), std::memory_order_relaxed);
    ++sequence_;
    FollowPower();
  }

  // If a person switches the power on again after it was off, the arm does not count as having kept
  // its power.
  void FollowPower() noexcept {
    if (power_ == Power::kWanted || power_ == Power::kCut || clock_.Age(now_) >= kFresh) return;
    if (!Powered(state_))
      power_ = Power::kCut;
    else if (now_ - unwanted_since_ > static_cast<std::uint64_t>(1e9 * kPowerOff))
      power_ = Power::kKept;
  }

  // The answers are not needed. They are read because a closed connection must be detected before
  // it is used.
  void ReadDashboard() noexcept {
    std::array<std::byte, 256> unused;
    int size = dashboard_ && !dashboard_lost_ ? 1 : 0;
    for (int i = 0; i < kMaxReads && size > 0; ++i) size = dashboard_->Read(unused);
    if (size == Stream::kClosed) dashboard_lost_ = true;
  }

  // A controller omits packets if its client is too slow. Packets that the controller omitted while
  // this client was paused do not count as lost.
  void CountSkipped(double step) noexcept {
    constexpr double kPause = 1;  // [s]
    const double cycles = step * facts_.rate;
    if (step < kPause && cycles > 1.5) link_.lost += static_cast<std::uint64_t>(cycles - 0.5);
  }

  // Returns whether our program runs without braking, although it has missed commands for longer
  // than kDeaf.
  bool Deaf() const noexcept {
    const double behind = period_ * (Unsigned(counter_) - Unsigned(state_.echo));
    return behind > kDeaf && clock_.Age(now_) < kFresh &&
           state_.script != static_cast<std::int32_t>(UrScriptState::kStopping);
  }

  void Report(ArmReading* reading) const noexcept {
    reading->q = Eigen::Map<const Vector6>(state_.q.data());
    reading->v = Eigen::Map<const Vector6>(state_.v.data());
    reading->sequence = sequence_;
    reading->age = clock_.Age(now_);
    reading->link = link_;
    reading->fault = fault_.any() || arm_fault_.load() != UrFault::kNone;
    reading->no_power_off = dashboard_lost_;
    reading->keeps_power = power_ == Power::kKept;
    reading->inputs = state_.inputs;
    if (!facts_.own_wrench) return;
    WrenchReading& wrench = reading->wrench;
    wrench.F_S = Eigen::Map<const Wrench>(state_.wrench.data());
    wrench.sequence = sequence_;
    wrench.age = reading->age;
    wrench.saturated = !Measurement(state_.wrench);
  }

  // v contains velocities to follow, or nullptr commands the arm to rest.
  bool Send(const JointVector* v) noexcept {
    UrVector qd{};
    if (v != nullptr) std::copy_n(v->data(), kUrJoints, qd.begin());
    rtde::PacketWriter writer(rtde::PacketType::kData);
    return connection_->Send(UrCommand(&writer, inputs_, qd, counter_, v != nullptr));
  }

  Network* network_;
  bool listen_;
  std::unique_ptr<rtde::Connection> connection_;
  std::unique_ptr<Stream> dashboard_;  // may be null
  bool dashboard_lost_ = false;
  Power power_{};                     // starts as kWanted
  std::uint64_t unwanted_since_ = 0;  // [ns]
  DeviceFacts facts_;
  std::string host_;
  int outputs_;  // ID of the recipe
  UrExtras extras_;
  int inputs_;     // ID of the recipe
  double period_;  // period of the commands [s]
  std::int32_t counter_;
  UrState state_;
  DeviceClock clock_;
  std::uint64_t sequence_ = 0;
  LinkCounts link_;
  std::uint64_t now_ = 0, next_ = 0;  // [ns]
  std::uint64_t stop_by_ = 0;         // time by which the arm stands still [ns]
  bool moves_ = false;
  std::atomic<UrFault> arm_fault_ = UrFault::kNone;  // current fault
  std::atomic<int> behind_ = 0;  // packages since the newest one, all with an earlier time
  // Permanent. Other threads may call Trouble.
  FaultLatch<UrFault> fault_;
};

}  // namespace

std::unique_ptr<Arm> ConnectUr(const UrOptions& options, Network* network) {
  return std::make_unique<UrArm>(SetUpUr(options, network), options.listen, network);
}

}  // namespace predictor
