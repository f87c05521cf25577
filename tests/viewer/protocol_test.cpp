#include "viewer/protocol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/soak.h"

namespace predictor::viewer {
namespace {

template <class T>
T Parsed(const char* text) {
  const auto request = ParsePageRequest(text);
  if (!request || !std::holds_alternative<T>(*request)) {
    ADD_FAILURE() << text;
    return {};
  }
  return std::get<T>(*request);
}

TEST(Protocol, UnderstandsEveryMessage) {
  using Kind = HelloRequest::Kind;
  const auto hello = Parsed<HelloRequest>(R"({"type": "hello", "code": "abc"})");
  EXPECT_EQ(hello.kind, Kind::kCode);
  EXPECT_EQ(hello.secret, "abc");
  EXPECT_EQ(Parsed<HelloRequest>(R"({"type":"hello","pin":"493027"})").kind, Kind::kPin);
  EXPECT_EQ(Parsed<HelloRequest>(R"({"type":"hello","token":"x"})").kind, Kind::kToken);
  Parsed<HeartbeatRequest>(R"({"type": "heartbeat"})");
  const auto lease = Parsed<LeaseRequest>(R"({"type":"lease","what":"operator","take":true})");
  EXPECT_EQ(lease.what, LeaseKind::kOperator);
  EXPECT_TRUE(lease.take);
  Parsed<StopRequest>(R"({"type": "stop"})");
  EXPECT_EQ(Parsed<CommandRequest>(R"({"type":"command","command":"reset"})").command,
            InputKind::kReset);
  const auto parameter =
      Parsed<ParameterRequest>(R"({"type":"parameter","parameter":"torque","value":2})");
  EXPECT_EQ(parameter.parameter, Parameter::kTorqueThreshold);
  EXPECT_EQ(parameter.value, 2);
  const auto hand = Parsed<HandRequest>(
      R"({"type":"hand","hand":"right","grip":true,"p":[1,2,3],"q":[0.999,0,0,0]})");
  EXPECT_EQ(hand.hand, 1);
  EXPECT_TRUE(hand.grip);
  EXPECT_EQ(hand.p, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(hand.q[0], 1);
  EXPECT_EQ(Parsed<PingRequest>(R"({"type":"ping","page_ms":12.5})").page_ms, 12.5);
  EXPECT_EQ(Parsed<LatencyRequest>(
                R"({"type":"latency","offset_ms":-1e9,"received_ms":2,"rendered_ms":3})")
                .rendered_ms,
            3);
  EXPECT_TRUE(Parsed<ImmersiveRequest>(R"({"type":"immersive","active":true})").active);
  const auto head =
      Parsed<ImmersiveRequest>(R"({"type":"immersive","active":true,"p":[1,2,3],"q":[1,0,0,0]})");
  EXPECT_TRUE(head.has_head);
  EXPECT_EQ(head.p[2], 3);
  EXPECT_FALSE(head.registration.has_value());
  const auto measured = Parsed<ImmersiveRequest>(
      R"({"type":"immersive","active":true,"p":[1,2,3],"q":[1,0,0,0],"posed":"9007199254740993",)"
      R"("registration":{"yaw":-1,"t":[4,5,6],"residual":0.002}})");
  EXPECT_EQ(measured.posed_ns, 9007199254740993u);
  EXPECT_EQ(measured.registration->t[2], 6);
  EXPECT_EQ(measured.registration->residual, 0.002);
}

TEST(Protocol, UnderstandsNothingElse) {
  const char* wrong[] = {
      "",
      "stop",
      "[]",
      "{}",
      "null",
      R"({"type":"Stop"})",
      R"({"type":["stop"]})",
      R"({"type":"stop"}})",
      R"({"type":"stop")",
      R"({"type":"hello"})",
      R"({"type":"hello","code":"a","pin":"b"})",
      R"({"type":"hello","code":5})",
      R"({"type":"hello","code":"012345678901234567890123456789012345678901234567890123456789012345678901234567890"})",
      R"({"type":"lease","what":"everything","take":true})",
      R"({"type":"lease","what":"control","take":1})",
      R"({"type":"command","command":"stop now"})",
      R"({"type":"command"})",
      R"({"type":"parameter","parameter":"gravity","value":1})",
      R"({"type":"parameter","parameter":"force","value":"1"})",
      R"({"type":"parameter","parameter":"force","value":1e999})",
      R"({"type":"parameter","parameter":"force","value":NaN})",
      R"({"type":"parameter","parameter":"force","value":1e7})",
      R"({"type":"hand","hand":"left","grip":true,"p":[1,2],"q":[1,0,0,0]})",
      R"({"type":"hand","hand":"left","grip":true,"p":[1,2,1e3],"q":[1,0,0,0]})",
      R"({"type":"hand","hand":"left","grip":true,"p":[1,2,3],"q":[0,0,0,0]})",
      R"({"type":"hand","hand":"left","grip":true,"p":[1,2,3],"q":[1,1,0,0]})",
      R"({"type":"hand","hand":"left","grip":true,"p":{"x":1},"q":[1,0,0,0]})",
      R"({"type":"hand","hand":"third","grip":true,"p":[1,2,3],"q":[1,0,0,0]})",
      R"({"type":"ping"})",
      R"({"type":"immersive","active":true,"p":[1,2,3]})",
      R"({"type":"immersive","active":true,"drawn":"12x"})",
      R"({"type":"immersive","active":true,"drawn":""})",
      R"({"type":"immersive","active":true,"drawn":"99999999999999999999"})",
      R"({"type":"immersive","active":true,"drawn":1e300})",
      R"({"type":"immersive","active":true,"drawn":[]})",
      R"({"type":"immersive","active":true,"posed":true})",
      R"({"type":"immersive","active":true,"registration":[]})",
      R"({"type":"immersive","active":true,"registration":{"yaw":1,"t":[0,0,0]}})",
      R"({"type":"immersive","active":true,"registration":{"yaw":1,"t":[0,0],"residual":0}})",
      R"({"type":"immersive","active":true,"registration":{"yaw":11,"t":[0,0,0],"residual":0}})",
      R"({"type":"immersive","active":true,"registration":{"yaw":1,"t":[0,0,1e9],"residual":0}})",
      R"({"type":"immersive","active":true,"registration":{"yaw":1,"t":[0,0,0],"residual":-1}})",
      R"({"type":"immersive","active":true,"registration":{"yaw":1,"t":[0,0,0],"residual":null}})",
      R"({"type":"immersive","active":"yes"})"};
  for (const char* text : wrong) EXPECT_FALSE(ParsePageRequest(text)) << text;
  EXPECT_FALSE(ParsePageRequest(R"({"type":"stop","x":")" + std::string(1100, 'x') + "\"}"));
  EXPECT_FALSE(ParsePageRequest(std::string(1024, '[')));
}

// The floating-point numbers of a page cannot represent every time exactly. Such a time is sent as
// a string of digits.
TEST(Protocol, ReadsTimesAsNumbersAndAsDigits) {
  const auto drawn = [](const std::string& value) {
    const auto request =
        ParsePageRequest(R"({"type":"immersive","active":true,"drawn":)" + value + "}");
    return request ? std::get<ImmersiveRequest>(*request).drawn_ns : 1;
  };
  EXPECT_EQ(drawn("123456789012"), 123456789012u);
  EXPECT_EQ(drawn("\"9007199254740993\""), 9007199254740993u);
  EXPECT_EQ(drawn("9007199254740993"), 9007199254740993u);
  EXPECT_EQ(drawn("-5"), 0u);
  EXPECT_EQ(drawn("0"), 0u);
}

// Any input must result either in no request or in a request whose values are within bounds.
TEST(Protocol, SoakSurvivesAnyBytes) {
  std::mt19937 random(1);
  const std::string seeds[] = {
      R"({"type":"hand","hand":"left","grip":true,"p":[1,2,3],"q":[1,0,0,0]})",
      R"({"type":"parameter","parameter":"force","value":20})",
      R"({"type":"hello","token":"abcdef"})"};
  for (long i = 0; i < Count(20'000, 2'000'000); ++i) {
    std::string text = seeds[random() % 3];
    for (auto k = random() % 6; k > 0; --k) {
      const std::size_t at = random() % text.size();
      if (random() % 2)
        text[at] = static_cast<char>(random());
      else
        text.insert(at, 1, "0123456789e+-.[]{}\",:\\u"[random() % 23]);
    }
    const auto request = ParsePageRequest(text);
    if (!request) continue;
    if (const auto* hand = std::get_if<HandRequest>(&*request)) {
      double norm = 0;
      for (const double x : hand->q) norm += x * x;
      ASSERT_NEAR(norm, 1, 1e-9) << text;
      for (const double x : hand->p) ASSERT_LE(std::abs(x), 100) << text;
      ASSERT_LE(hand->hand, 1);
    }
    if (const auto* parameter = std::get_if<ParameterRequest>(&*request)) {
      ASSERT_LE(std::abs(parameter->value), 1e6) << text;
    }
  }
}

TEST(Protocol, WritesWhatThePageReads) {
  Leases leases;
  EXPECT_EQ(LeasesText(leases, 2),
            R"({"type":"leases","control":null,"operator":null,"clients":2})");
  leases.Take(LeaseKind::kOperator, 4, 0);
  EXPECT_EQ(LeasesText(leases, 1), R"({"type":"leases","control":null,"operator":4,"clients":1})");
  EXPECT_EQ(PongText(1234.5, 5), R"({"type":"pong","page_ms":1234.5,"server_ns":5})");
  EXPECT_EQ(RefusedText("No."), R"({"type":"refused","reason":"No."})");
  EXPECT_EQ(NoticeText("Kept."), R"({"type":"notice","text":"Kept."})");
  EXPECT_EQ(DeniedText("command", "No."), R"({"type":"denied","what":"command","reason":"No."})");
  EXPECT_EQ(FrameJson()[0].dump(), R"({"name":"tick","offset":0,"type":"u64","count":1})");
}

}  // namespace
}  // namespace predictor::viewer
