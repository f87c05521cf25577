// Tests the fake arm's control with commands that our driver would never send.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "devices/franka/fci.h"
#include "devices/franka_rig.h"
#include "support/constants.h"

namespace predictor {
namespace {

// A client that answers each state of the arm with a given command.
class Client {
 public:
  explicit Client(std::uint16_t version) : version_(version), rig_(Options(version)) {
    datagrams_ = rig_.network.Open({FrankaRig::kHost, 0}, 0);
    stream_ = rig_.network.Connect({FrankaRig::kHost, 1337}, 1);
    fci::RequestBuffer buffer;
    stream_->Write(fci::EncodeConnect(version, 0, datagrams_->port(), &buffer));
    Pass();
    stream_->Write(fci::EncodeMove(version, 1, &buffer));
    while (state_.mode != fci::RobotMode::kMove) Pass();
  }

  // Answers the last state and waits for the next one.
  void Command(const fci::Joints& v, bool finished = false) {
    fci::CommandBuffer buffer;
    datagrams_->Send(fci::EncodeVelocity(version_, state_.message_id, v, finished, &buffer));
    Pass();
  }
  void Command(int joint, double v) {
    fci::Joints all{};
    all[static_cast<std::size_t>(joint)] = v;
    Command(all);
  }
  void Pass() {
    rig_.network.Pass(1e-3);
    std::array<std::byte, 4096> bytes;
    for (int n = 0; (n = datagrams_->Receive(bytes)) > 0;)
      ASSERT_TRUE(fci::Decode(version_, std::span(bytes).first(static_cast<unsigned>(n)), &state_));
    const int n = stream_->Read(reader_.room());
    if (n > 0) reader_.Arrived(static_cast<std::size_t>(n));
    while (reader_.Next(&answer_)) {
    }
  }
  const fci::RobotState& state() const { return state_; }
  fci::MoveStatus status() const { return fci::MoveStatusOf(answer_.status(), version_); }
  FrankaRig& rig() { return rig_; }

 private:
  static FakeFrankaOptions Options(std::uint16_t version) {
    FakeFrankaOptions options;
    options.version = version;
    return options;
  }

  std::uint16_t version_;
  FrankaRig rig_;
  std::unique_ptr<Datagrams> datagrams_;
  std::unique_ptr<Stream> stream_;
  fci::AnswerReader reader_;
  fci::Answer answer_;
  fci::RobotState state_;
};

class FakeFrankaControl : public testing::TestWithParam<std::uint16_t> {
 protected:
  FakeFrankaControl() : client_(GetParam()) {}
  void ExpectReflex(const std::string& words) {
    EXPECT_EQ(client_.state().mode, fci::RobotMode::kReflex);
    EXPECT_EQ(fci::ErrorWords(client_.state().errors), words);
    EXPECT_EQ(fci::ErrorWords(client_.state().reflex_reason), words);
    EXPECT_EQ(client_.status(), fci::MoveStatus::kReflexAborted);
    EXPECT_EQ(client_.state().generator, fci::MotionGeneratorMode::kIdle);
  }
  const FrankaJointLimit& limit(std::size_t joint) const {
    return FrankaLimitsOf(GetParam())[joint];
  }
  Client client_;
};

TEST_P(FakeFrankaControl, TakesAMotionToItsEnd) {
  for (int i = 1; i <= 100; ++i) client_.Command(0, 1e-4 * i);
  for (int i = 100; i >= 0; --i) client_.Command(0, 1e-4 * i);
  EXPECT_EQ(client_.state().mode, fci::RobotMode::kMove);
  client_.Command(fci::Joints{}, true);
  EXPECT_EQ(client_.state().mode, fci::RobotMode::kIdle);
  EXPECT_EQ(client_.status(), fci::MoveStatus::kSuccess);
}

TEST_P(FakeFrankaControl, StopsAtAJump) {
  client_.Command(2, 0.5);
  ExpectReflex(
      "joint motion generator velocity discontinuity, joint motion generator acceleration "
      "discontinuity");
}

TEST_P(FakeFrankaControl, StopsAtAnAccelerationBeyondItsLimit) {
  const double a = limit(0).acceleration;
  double v = 0;
  client_.Command(0, v += 0.4 * a * 1e-3);
  client_.Command(0, v += 0.8 * a * 1e-3);
  EXPECT_EQ(client_.state().mode, fci::RobotMode::kMove);
  client_.Command(0, v += 1.1 * a * 1e-3);
  ExpectReflex("joint motion generator velocity discontinuity");
}

TEST_P(FakeFrankaControl, StopsAtAJerkBeyondItsLimit) {
  client_.Command(0, 0.6 * limit(0).acceleration * 1e-3);
  ExpectReflex("joint motion generator acceleration discontinuity");
}

TEST_P(FakeFrankaControl, StopsAtItsVelocityLimit) {
  // The motion starts in the middle of the range.
  const double a = 0.4 * limit(0).acceleration;
  double v = 0;
  while (v + a * 1e-3 < limit(0).velocity) client_.Command(0, v += a * 1e-3);
  EXPECT_EQ(client_.state().mode, fci::RobotMode::kMove);
  client_.Command(0, v += 1.2 * a * 1e-3);
  ExpectReflex("joint motion generator velocity limits violation");
}

TEST_P(FakeFrankaControl, StopsAtTheEndOfAJointsRange) {
  double v = 0;
  for (int i = 0; i < 8000 && client_.state().mode == fci::RobotMode::kMove; ++i) {
    // The arm moves as fast as the limit near the end of the range permits, until it exceeds the
    // limit.
    const double fastest = 0.9 * std::min(0.3, limit(1).FastestDown(client_.state().q_d[1] - 0.05));
    v = std::max(-std::max(fastest, 0.02), v - 1e-3);
    client_.Command(1, v);
  }
  EXPECT_EQ(client_.state().mode, fci::RobotMode::kReflex);
  EXPECT_NE(fci::ErrorWords(client_.state().errors).find("limits violation"), std::string::npos);
  EXPECT_NEAR(client_.state().q[1], limit(1).lower, 0.02);
}

TEST_P(FakeFrankaControl, CannotReadNan) {
  client_.Command(0, kNan);
  EXPECT_EQ(client_.status(), fci::MoveStatus::kInputErrorAborted);
  EXPECT_NE(client_.state().mode, fci::RobotMode::kMove);
}

TEST_P(FakeFrankaControl, ContinuesAtConstantAccelerationWithoutCommands) {
  for (int i = 1; i <= 50; ++i) client_.Command(0, 1e-3 * i);
  for (int i = 0; i < 19; ++i) {
    client_.Pass();
    EXPECT_NEAR(client_.state().dq_d[0], 1e-3 * (51 + i), 1e-6);
  }
  EXPECT_EQ(client_.state().mode, fci::RobotMode::kMove);
  client_.Pass();
  ExpectReflex("communication constraints violation");
}

TEST_P(FakeFrankaControl, TakesNoCommandForAnOlderState) {
  fci::CommandBuffer buffer;
  client_.Command(0, 1e-3);
  const auto lost = client_.rig().fake.lost_commands();
  client_.rig().fake.ReceivedDatagram(
      1337, 1, fci::EncodeVelocity(GetParam(), client_.state().message_id - 1, {}, false, &buffer));
  client_.Pass();
  EXPECT_EQ(client_.rig().fake.lost_commands(), lost + 1);
}

INSTANTIATE_TEST_SUITE_P(Versions, FakeFrankaControl,
                         testing::Values(fci::kPandaVersion, fci::kResearch3Version),
                         [](const auto& version) { return ControllerName(version.param); });

TEST(FakeFrankaDescription, HasTheElementsThatLibfrankaReads) {
  const std::string text = FrankaDescription();
  int joints = 0;
  for (std::size_t at = 0;
       (at = text.find("<position_based_velocity_limits", at)) != std::string::npos; ++at)
    ++joints;
  EXPECT_EQ(joints, 7);
}

}  // namespace
}  // namespace predictor
