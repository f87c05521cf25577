#include "devices/franka/franka_arm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/format.h"
#include "devices/franka/connection.h"
#include "devices/franka/fault_record.h"
#include "devices/franka/rate_limiter.h"
#include "devices/franka/robot_clock.h"

namespace predictor {
namespace {

using fci::Fault;
using fci::Joints;

// The arm abandons a motion after this time without commands, and the driver abandons a motion
// after this time without states.
constexpr double kSilence = fci::RateLimiter::kCoasting;  // [s]
// Longest time in which the arm starts or ends a motion.
constexpr double kPatience = 1;  // [s]
// Maximum number of datagrams that are read in one tick.
constexpr int kMaxDatagrams = 64;
// Largest number of states by which a new state may be ahead of the last state. The number
// corresponds to a quarter of an hour, which is longer than any pause. If a state further ahead
// were accepted, all later states would count as old.
constexpr std::int64_t kMaxAhead = 1'000'000;
// Largest difference between the commanded velocity and the reported velocity that the rounding of
// floats can cause.
constexpr double kSameVelocity = 1e-5;  // [rad/s]
// Within this number of cycles, the arm hardly deviates from its command.
constexpr std::uint64_t kShortGap = 2;

// A pose that is far from the flange pose of every model. It is used if the arm does not report the
// pose of its flange.
const Pose kNowhere = {Vector3::Constant(std::numeric_limits<double>::quiet_NaN()), {}};

// Describes the thresholds of the arm's own reflexes. The robot does not report these thresholds.
// Therefore, only thresholds that this program sets are known.
std::string CollisionRemark(const std::optional<FrankaCollision>& c) {
  if (!c)
    return "The collision thresholds that are set in Desk apply. The arm does not report these "
           "thresholds. To set them here, add connection.collision to the machine file.";
  return Formatted(
      "The arm's own reflex stops the arm above %.0f N or %.0f N·m at its stiffness frame, or "
      "above an external torque of %.0f N·m at a joint (connection.collision, set before the arm "
      "moves).",
      c->force[0], c->force[3], c->torque[0]);
}

DeviceFacts Facts(const FrankaOptions& options, const Address& address, const fci::Connection& c) {
  DeviceFacts facts;
  facts.name = c.version == fci::kPandaVersion ? "Franka Panda" : "Franka Research 3";
  facts.name += " at " + address.ToString() + ", interface version " + std::to_string(c.version) +
                " (states of " + std::to_string(c.state_size) +
                " bytes); driver never run on hardware";
  facts.joints = fci::kJoints;
  facts.rate = 1000;
  facts.own_wrench = true;
  facts.watchdog = fci::RateLimiter::kCoasting;
  for (const fci::JointLimit& limit : fci::PublishedLimits(c.version)) {
    facts.velocity.push_back(options.limits * limit.velocity);
    facts.acceleration.push_back(options.limits * limit.acceleration);
  }
  facts.payload = ReportedPayload{c.state.compensated_mass, c.state.compensated_center};
  facts.payload_taken_off = true;
  facts.flange = ReportedFlange{Eigen::Map<const Eigen::VectorXd>(c.state.q.data(), fci::kJoints),
                                c.state.X_OF.value_or(kNowhere), "link8"};
  facts.remarks.push_back(CollisionRemark(options.collision));
  return facts;
}

class Driver final : public FrankaArm {
 public:
  Driver(const FrankaOptions& options, fci::Connection connection, Network* network)
      : address_{options.host, options.port},
        X_SF_(options.X_FS.Inverse()),
        network_(network),
        facts_(Facts(options, address_, connection)),
        version_(connection.version),
        stream_(std::move(connection.stream)),
        datagrams_(std::move(connection.datagrams)),
        next_id_(connection.next_id),
        state_(connection.state),
        limiter_(fci::PublishedLimits(version_), options.limits) {
    answered_ = state_.message_id;
    rests_since_ = network_->Now();
    clock_.Heard(state_.message_id, network_->Now());
    TakeWrench();
  }

  const DeviceFacts& facts() const override { return facts_; }
  Status Read(ArmReading* reading) noexcept override;
  Status Write(const JointVector& v, bool motion) noexcept override;
  std::string Trouble() const override { return trouble_.any() ? trouble_.Describe(address_) : ""; }
  FrankaCounts counts() const noexcept override {
    FrankaCounts counts = counts_;
    counts.strangers = datagrams_->strangers();
    return counts;
  }

 private:
  enum class Phase { kIdle, kStarting, kMoving, kFinishing };

  void ReadAnswers() noexcept;
  void TakeAnswer(const fci::Answer& answer) noexcept;
  void ReadStates() noexcept;
  bool TakeState(std::span<const std::byte> bytes) noexcept;
  void TakeWrench() noexcept;
  void Judge() noexcept;
  void Fill(ArmReading* reading) const noexcept;
  void Enter(Phase phase) noexcept;
  void Advance(bool motion) noexcept;
  void StartMotion() noexcept;
  void AnswerState(const JointVector& v, bool motion) noexcept;
  bool CatchUp(const Joints& asked) noexcept;
  bool RestsSoon(const Joints& asked) const noexcept;
  double Since(std::uint64_t time) const noexcept {
    return 1e-9 * static_cast<double>(network_->Now() - time);
  }
  bool Moves() const noexcept;
  bool InMotion() const noexcept;
  bool Generating() const noexcept {
    return state_.generator == fci::MotionGeneratorMode::kJointVelocity;
  }
  Status PresentStatus() const noexcept {
    Status status;
    if (!trouble_.any()) return status;
    status.cause = StopCause::kDevice;
    status.power_off = trouble_.ends_without_power();
    return status;
  }

  Address address_;
  Pose X_SF_;  // pose of the flange in the sensor's frame
  Network* network_;
  DeviceFacts facts_;
  std::uint16_t version_;
  std::unique_ptr<Stream> stream_;
  std::unique_ptr<Datagrams> datagrams_;
  fci::AnswerReader answers_;
  std::uint32_t next_id_;
  fci::FaultRecord trouble_;
  FrankaCounts counts_;

  fci::RobotState state_;  // the newest state
  fci::RobotClock clock_;
  std::uint64_t heard_ = 0;  // arrival of the last state [ns]; 0: none since the connection
  std::uint64_t sequence_ = 1;
  Wrench F_S_ = Wrench::Zero();
  std::uint64_t wrench_id_ = 0;  // ID of the state with the last wrench
  std::uint64_t wrench_sequence_ = 0;

  Phase phase_ = Phase::kIdle;
  std::uint64_t since_ = 0;     // start of the phase [ns]
  std::uint64_t rests_since_;   // time since which the arm has been commanded to rest but still
                                // moves [ns]
  std::uint32_t move_id_ = 0;   // ID of the motion request
  bool move_ended_ = false;     // the robot has answered that the motion is over
  bool finished_ = false;       // the end of the motion was requested
  std::uint64_t answered_ = 0;  // ID of the last state that was answered
  bool commanded_ = false;      // a command was sent in this motion
  fci::RateLimiter limiter_;
  fci::WayBack way_back_;
  bool waits_ = false;  // the arm is not accelerated, because commands were lost
  Joints asked_{};      // requested velocities of the last command [rad/s]
};

Status Driver::Read(ArmReading* reading) noexcept {
  if (heard_ == 0) heard_ = network_->Now();
  ReadAnswers();
  ReadStates();
  Judge();
  Fill(reading);
  return PresentStatus();
}

void Driver::ReadAnswers() noexcept {
  fci::Answer answer;
  for (int pieces = 0; pieces < kMaxDatagrams; ++pieces) {
    const int n = stream_->Read(answers_.room());
    if (n == Stream::kClosed) trouble_.Set(Fault::kClosed);
    if (n <= 0) return;
    answers_.Arrived(static_cast<std::size_t>(n));
    while (answers_.Next(&answer)) TakeAnswer(answer);
    if (answers_.broken()) trouble_.Set(Fault::kNonsense);
    if (answers_.broken()) return;
  }
}

// After connecting, the driver sends only motion requests.
void Driver::TakeAnswer(const fci::Answer& answer) noexcept {
  if (phase_ == Phase::kIdle || answer.header.id != move_id_) return trouble_.Set(Fault::kNonsense);
  const fci::MoveStatus status = fci::MoveStatusOf(answer.status(), version_);
  if (status == fci::MoveStatus::kMotionStarted) return;
  if (status == fci::MoveStatus::kSuccess && finished_) {
    move_ended_ = true;
    return;
  }
  trouble_.Set(Fault::kMove, static_cast<int>(status));
}

void Driver::ReadStates() noexcept {
  std::array<std::byte, sizeof(fci::PandaState) + 1> bytes;
  bool fresh = false;
  for (int i = 0; i < kMaxDatagrams; ++i) {
    const int n = datagrams_->Receive(bytes);
    if (n == 0) break;
    const std::size_t size = std::min(static_cast<std::size_t>(std::max(n, 0)), bytes.size());
    fresh = TakeState(std::span<const std::byte>(bytes).first(size)) || fresh;
  }
  if (!fresh) return;
  heard_ = network_->Now();
  clock_.Heard(state_.message_id, heard_);
  TakeWrench();
}

bool Driver::TakeState(std::span<const std::byte> bytes) noexcept {
  fci::RobotState next;
  if (!fci::Decode(version_, bytes, &next)) {
    ++counts_.malformed;
    return false;
  }
  // The difference wraps around in the same way as the IDs.
  const auto ahead = static_cast<std::int64_t>(next.message_id - state_.message_id);
  if (ahead <= 0) {
    ++counts_.old_states;
    return false;
  }
  if (ahead > kMaxAhead) {
    ++counts_.malformed;
    return false;
  }
  ++counts_.states;
  counts_.missed_states += static_cast<std::uint64_t>(ahead - 1);
  sequence_ += static_cast<std::uint64_t>(ahead);
  state_ = std::move(next);
  return true;
}

// The wrench that the handle exerts on the sensor is the negative of the wrench that the robot
// reports. Near a singular pose, the robot has no estimate and reports zero.
void Driver::TakeWrench() noexcept {
  if (state_.F_K_K.isZero(0)) return;
  const Pose X_SK = X_SF_ * state_.X_FK;
  const Matrix3 R_SK = X_SK.R();
  Wrench F_K_S;
  F_K_S << R_SK * -state_.F_K_K.head<3>(), R_SK * -state_.F_K_K.tail<3>();
  F_S_ = ShiftWrench(F_K_S, X_SK.p);
  wrench_id_ = state_.message_id;
  wrench_sequence_ = sequence_;
}

void Driver::Judge() noexcept {
  using fci::RobotMode;
  if (Since(heard_) > kSilence) trouble_.Set(Fault::kSilent);
  const bool may_move = phase_ != Phase::kIdle && state_.mode == RobotMode::kMove;
  if (state_.mode != RobotMode::kIdle && !may_move)
    trouble_.Set(Fault::kMode, static_cast<int>(state_.mode));
  if (state_.errors.any()) trouble_.Set(Fault::kError);
  if (!trouble_.any()) return;
  if (state_.errors.any()) trouble_.Name(state_.errors);
  if (state_.mode == RobotMode::kReflex) trouble_.Name(state_.reflex_reason);
}

void Driver::Fill(ArmReading* reading) const noexcept {
  const std::uint64_t now = network_->Now();
  reading->q.resize(fci::kJoints);
  reading->v.resize(fci::kJoints);
  for (int i = 0; i < fci::kJoints; ++i) {
    reading->q[i] = state_.q[static_cast<std::size_t>(i)];
    reading->v[i] = state_.dq[static_cast<std::size_t>(i)];
  }
  reading->sequence = sequence_;
  reading->age = clock_.Age(state_.message_id, now);
  reading->fault = trouble_.any();
  reading->in_motion = InMotion();
  reading->waits = phase_ != Phase::kMoving;
  reading->link = {counts_.states, counts_.missed_states + counts_.lost_commands,
                   counts_.malformed + datagrams_->strangers()};
  reading->wrench = {};
  if (wrench_sequence_ == 0) return;
  reading->wrench.F_S = F_S_;
  reading->wrench.sequence = wrench_sequence_;
  reading->wrench.age = clock_.Age(wrench_id_, now);
}

// Returns whether the robot reports motion. After a lost command, the robot would continue this
// motion.
bool Driver::Moves() const noexcept {
  const auto& v = state_.dq_d;
  return std::any_of(v.begin(), v.end(), [](double x) { return std::abs(x) > kSameVelocity; });
}

// Returns whether the last command was different from zero, or whether the arm reports motion.
bool Driver::InMotion() const noexcept {
  return !trouble_.any() && (Moves() || !limiter_.AtRest());
}

Status Driver::Write(const JointVector& v, bool motion) noexcept {
  // Without this condition, the program would wait forever until the arm is at rest.
  if (!(v.isZero(0) && InMotion())) rests_since_ = network_->Now();
  if (Since(rests_since_) > kPatience) trouble_.Set(Fault::kNoEnd);
  if (!trouble_.any()) Advance(motion);
  if (!trouble_.any()) AnswerState(v, motion);
  return PresentStatus();
}

void Driver::Enter(Phase phase) noexcept {
  phase_ = phase;
  since_ = network_->Now();
}

void Driver::Advance(bool motion) noexcept {
  switch (phase_) {
    case Phase::kIdle:
      if (motion) StartMotion();
      return;
    case Phase::kStarting:
      if (Generating() && state_.mode == fci::RobotMode::kMove) return Enter(Phase::kMoving);
      if (Since(since_) > kPatience) trouble_.Set(Fault::kNoStart);
      return;
    case Phase::kMoving:
      if (!Generating())
        return trouble_.Set(Fault::kMove, static_cast<int>(fci::MoveStatus::kAborted));
      if (!motion && limiter_.AtRest()) Enter(Phase::kFinishing);
      return;
    case Phase::kFinishing:
      if (move_ended_ && !Generating() && state_.mode == fci::RobotMode::kIdle)
        return Enter(Phase::kIdle);
      if (Since(since_) > kPatience) trouble_.Set(Fault::kNoEnd);
      return;
  }
}

void Driver::StartMotion() noexcept {
  fci::RequestBuffer buffer;
  move_id_ = next_id_++;
  move_ended_ = finished_ = commanded_ = false;
  limiter_.Start({}, {});
  way_back_ = {};
  waits_ = false;
  asked_ = {};
  if (!stream_->Write(fci::EncodeMove(version_, move_id_, &buffer))) trouble_.Set(Fault::kClosed);
  Enter(Phase::kStarting);
}

// Answers only the newest state, and only once. In a millisecond without a state, the driver sends
// no command, and the robot continues its motion.
void Driver::AnswerState(const JointVector& v, bool motion) noexcept {
  const bool moves = phase_ == Phase::kMoving || phase_ == Phase::kFinishing;
  if (!moves || !Generating() || state_.message_id == answered_) return;
  Joints asked{};
  if (motion && phase_ == Phase::kMoving && v.size() == fci::kJoints && v.allFinite())
    for (std::size_t i = 0; i < fci::kJoints; ++i) asked[i] = v[static_cast<int>(i)];
  const bool missed = CatchUp(asked);
  asked_ = asked;
  // Adds the motion of the return path, which may briefly require a higher speed.
  const Joints left = way_back_.Next();
  for (std::size_t i = 0; i < fci::kJoints; ++i) asked[i] += left[i];
  limiter_.Next(asked, state_.q_d, missed && !way_back_.active());
  const bool finish = phase_ == Phase::kFinishing && limiter_.AtRest();
  finished_ = finished_ || finish;
  fci::CommandBuffer buffer;
  // A command that could not be sent counts as lost.
  static_cast<void>(datagrams_->Send(
      fci::EncodeVelocity(version_, state_.message_id, limiter_.v(), finish, &buffer)));
  answered_ = state_.message_id;
  commanded_ = true;
  ++counts_.commands;
}

// Returns whether the requested velocity reaches zero before a return path would end.
bool Driver::RestsSoon(const Joints& asked) const noexcept {
  double square = 0, falling = 0;
  for (std::size_t i = 0; i < fci::kJoints; ++i) {
    square += asked[i] * asked[i];
    falling += asked[i] * (asked_[i] - asked[i]);
  }
  return falling * fci::WayBack::kTime >= square * fci::RateLimiter::kDt;
}

// Checks whether states or commands were lost since the last command. After such a loss, the next
// command must continue from the state that the robot reports. `asked` is the velocity that the
// next command requests.
bool Driver::CatchUp(const Joints& asked) noexcept {
  if (!commanded_) return false;
  constexpr double dt = fci::RateLimiter::kDt;
  const std::uint64_t ticks = state_.message_id - answered_;
  const bool gap = ticks > 1;
  bool differs = false;
  for (std::size_t i = 0; i < fci::kJoints; ++i)
    differs = differs || std::abs(state_.dq_d[i] - limiter_.v()[i]) > kSameVelocity;
  if (differs) limiter_.Start(state_.dq_d, state_.ddq_d);
  // The arm needs a return path in two cases: it deviated from its command, or it was not
  // accelerated while more commands could have been lost.
  const bool waited = waits_ && !differs && !gap && !RestsSoon(asked);
  if ((differs && ticks > kShortGap) || waited) {
    Joints v{}, a{};
    for (std::size_t i = 0; i < fci::kJoints; ++i) {
      const double rate = (asked[i] - asked_[i]) / (static_cast<double>(ticks) * dt);
      v[i] = (waited ? limiter_.v()[i] : state_.dq_d[i]) - (asked[i] - rate * dt);
      a[i] = (waited ? limiter_.a()[i] : state_.ddq_d[i]) - rate;
    }
    way_back_.Begin(v, a);
  }
  if (differs && !gap) ++counts_.lost_commands;
  waits_ = (differs || gap) && !way_back_.active();
  return differs || gap;
}

}  // namespace

std::unique_ptr<FrankaArm> ConnectFranka(const FrankaOptions& options, Network* network) {
  return std::make_unique<Driver>(options, fci::Connect(options, network), network);
}

}  // namespace predictor
