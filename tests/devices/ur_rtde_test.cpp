#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/random.h"
#include "devices/ur/rtde.h"
#include "devices/ur/ur_connect.h"
#include "devices/ur/ur_state.h"

namespace predictor {
namespace {

using rtde::PacketType;
using Bytes = std::vector<std::byte>;

// Parses hexadecimal text such as "00 05 56".
Bytes Hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i < text.size(); i += 3)
    bytes.push_back(static_cast<std::byte>(std::stoi(text.substr(i, 2), nullptr, 16)));
  return bytes;
}

Bytes Written(rtde::PacketWriter* writer) {
  const auto bytes = writer->Finish();
  return {bytes.begin(), bytes.end()};
}

struct Seen {
  PacketType type;
  Bytes payload;
  bool operator==(const Seen&) const = default;
};

// Passes these pieces to the parser one after the other.
std::vector<Seen> Parse(const std::vector<std::span<const std::byte>>& pieces,
                        bool* broken = nullptr) {
  auto parser = std::make_unique<rtde::PacketParser>();
  std::vector<Seen> seen;
  for (auto piece : pieces) {
    while (!piece.empty() && !parser->broken()) {
      const auto room = parser->Room();
      const std::size_t n = std::min(room.size(), piece.size());
      std::copy_n(piece.begin(), n, room.begin());
      parser->Filled(n);
      piece = piece.subspan(n);
      rtde::Packet packet;
      while (parser->Next(&packet))
        seen.push_back({packet.type, {packet.payload.begin(), packet.payload.end()}});
    }
  }
  if (broken != nullptr) *broken = parser->broken();
  return seen;
}

// The expected bytes are those that ur_rtde 1.6.5 sent and received.
TEST(Rtde, RequestsAreAsCaptured) {
  EXPECT_EQ(rtde::AskVersion(), Hex("00 05 56 00 02"));
  EXPECT_EQ(rtde::AskControllerVersion(), Hex("00 03 76"));
  EXPECT_EQ(rtde::AskStart(), Hex("00 03 53"));
  EXPECT_EQ(rtde::AskPause(), Hex("00 03 50"));
}

TEST(Rtde, RecipesAreARateAndNames) {
  const std::vector<rtde::Field> recipe = {{"timestamp", "DOUBLE"}, {"actual_q", "VECTOR6D"}};
  // The request contains 500.0, followed by the names as text.
  EXPECT_EQ(rtde::AskOutputs(500, recipe),
            Hex("00 1d 4f 40 7f 40 00 00 00 00 00 "
                "74 69 6d 65 73 74 61 6d 70 2c 61 63 74 75 61 6c 5f 71"));
  EXPECT_EQ(rtde::AskInputs(recipe),
            Hex("00 15 49 74 69 6d 65 73 74 61 6d 70 2c 61 63 74 75 61 6c 5f 71"));
}

TEST(Rtde, DataAreAsCaptured) {
  rtde::PacketWriter writer(PacketType::kData);
  writer.Put(std::uint8_t{13}).Put(std::int32_t{9}).Put(0.1);
  for (int i = 0; i < 7; ++i) writer.Put(0.0);
  const Bytes bytes = Written(&writer);
  ASSERT_EQ(bytes.size(), 0x48U);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 16),
            Hex("00 48 55 0d 00 00 00 09 3f b9 99 99 99 99 99 9a"));
}

// The captured packet, which begins with 00 70 55 01, contains the time, six joints, six velocities
// and runtime_state.
TEST(Rtde, SizesOfTypesGiveTheCapturedPackage) {
  const std::vector<rtde::Field> recipe = {{"timestamp", "DOUBLE"},
                                           {"actual_q", "VECTOR6D"},
                                           {"actual_qd", "VECTOR6D"},
                                           {"runtime_state", "UINT32"}};
  EXPECT_EQ(rtde::kHeaderSize + 1 + rtde::SizeOf(recipe), 0x70U);
  EXPECT_EQ(rtde::SizeOf("BOOL"), 1U);
  EXPECT_EQ(rtde::SizeOf("VECTOR3D"), 24U);
  EXPECT_EQ(rtde::SizeOf("VECTOR6INT32"), 24U);
  EXPECT_EQ(rtde::SizeOf("NOT_FOUND"), 0U);
}

TEST(Rtde, AnswersAreAsCaptured) {
  const auto seen =
      Parse({Hex("00 04 56 01 00 13 76 00 00 00 05 00 00 00 0c 00 00 00 00 00 00 00 "
                 "00 00 04 53 01")});
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[0], (Seen{PacketType::kVersion, Hex("01")}));
  EXPECT_EQ(seen[1].type, PacketType::kControllerVersion);
  BigEndianReader version(seen[1].payload);
  EXPECT_EQ(version.Get<std::uint32_t>(), 5U);
  EXPECT_EQ(version.Get<std::uint32_t>(), 12U);
  EXPECT_EQ(seen[2], (Seen{PacketType::kStart, Hex("01")}));
}

Bytes AnyPackets(RandomStream* random, int count) {
  const std::string types = "VvMUOISP";
  Bytes all;
  for (int i = 0; i < count; ++i) {
    rtde::PacketWriter writer(static_cast<PacketType>(types[random->Next() % types.size()]));
    for (auto n = random->Next() % 60; n > 0; --n)
      writer.Put(static_cast<std::uint8_t>(random->Next()));
    const Bytes one = Written(&writer);
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

TEST(Rtde, StreamCutAtAnyByteGivesTheSamePackets) {
  RandomStream random(1, "rtde");
  const Bytes all = AnyPackets(&random, 20);
  const auto whole = Parse({all});
  ASSERT_EQ(whole.size(), 20U);
  const std::span<const std::byte> bytes(all);
  for (std::size_t cut = 1; cut < all.size(); ++cut)
    ASSERT_EQ(Parse({bytes.first(cut), bytes.subspan(cut)}), whole) << cut;
  std::vector<std::span<const std::byte>> single;
  for (std::size_t i = 0; i < all.size(); ++i) single.push_back(bytes.subspan(i, 1));
  EXPECT_EQ(Parse(single), whole);
}

TEST(Rtde, LongStreamsFit) {
  RandomStream random(2, "rtde");
  const Bytes all = AnyPackets(&random, 2000);  // much larger than the parser's buffer
  EXPECT_EQ(Parse({all}).size(), 2000U);
}

TEST(Rtde, ImpossibleSizesBreakTheStream) {
  for (const char* head : {"00 00 55", "00 01 55", "00 02 55", "10 01 55", "ff ff 55"}) {
    bool broken = false;
    Bytes bytes = Hex(head);
    const Bytes good = rtde::AskStart();
    bytes.insert(bytes.end(), good.begin(), good.end());
    EXPECT_TRUE(Parse({bytes}, &broken).empty()) << head;
    EXPECT_TRUE(broken) << head;
  }
}

TEST(Rtde, InvalidTypesBreakTheStream) {
  bool broken = false;
  Parse({Hex("00 03 00")}, &broken);
  EXPECT_TRUE(broken);
  Parse({Hex("48 54 54 50 2f 31 2e 31")}, &broken);  // HTTP/1.1
  EXPECT_TRUE(broken);
}

TEST(Rtde, LargestPacketPassesAndALargerOneIsNotWritten) {
  const auto packet = [](std::size_t payload) {
    rtde::PacketWriter writer(PacketType::kText);
    for (std::size_t i = 0; i < payload; ++i) writer.Put(std::uint8_t{7});
    return Written(&writer);
  };
  const Bytes largest = packet(rtde::kMaxPacket - rtde::kHeaderSize);
  EXPECT_EQ(Parse({largest, largest}).size(), 2U);
  EXPECT_TRUE(packet(rtde::kMaxPacket - rtde::kHeaderSize + 1).empty());
}

TEST(Rtde, AnyBytesAreSurvived) {
  RandomStream random(3, "rtde");
  for (int run = 0; run < 2000; ++run) {
    Bytes bytes = AnyPackets(&random, 4);
    for (int flips = 0; flips < 3; ++flips)
      bytes[random.Next() % bytes.size()] = static_cast<std::byte>(random.Next());
    for (const Seen& seen : Parse({bytes})) {
      rtde::TextMessage text;
      rtde::RecipeAnswer answer;
      UrState state;
      static_cast<void>(rtde::Decode(seen.payload, &text));
      static_cast<void>(rtde::Decode(seen.payload, &answer));
      EXPECT_FALSE(Decode(seen.payload, 1, {true, false}, &state));  // all are too short
    }
  }
}

TEST(Rtde, TextMessagesHaveTwoTextsAndALevel) {
  rtde::TextMessage text;
  const Bytes bytes = Hex("02 68 69 03 61 62 63 01");
  ASSERT_TRUE(rtde::Decode(bytes, &text));
  EXPECT_EQ(text.text, "hi");
  EXPECT_EQ(text.source, "abc");
  EXPECT_EQ(text.level, 1);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(rtde::Decode(std::span(bytes).first(size), &text)) << size;
}

TEST(Rtde, RefusalsNameTheValueAndTheRemedy) {
  const std::vector<rtde::Field> recipe = {{"a", "DOUBLE"}, {"b", "INT32"}};
  const auto refusal = [&](int id, const std::string& types) {
    return rtde::Refusal(recipe, {id, types});
  };
  EXPECT_EQ(refusal(1, "DOUBLE,INT32"), "");
  EXPECT_NE(refusal(1, "DOUBLE,IN_USE").find("b is in use"), std::string::npos);
  EXPECT_NE(refusal(1, "NOT_FOUND,INT32").find("does not support a"), std::string::npos);
  EXPECT_NE(refusal(1, "DOUBLE,UINT32").find("is of type UINT32, not INT32"), std::string::npos);
  EXPECT_NE(refusal(1, "DOUBLE").find("1 types for 2 names"), std::string::npos);
  EXPECT_NE(refusal(1, "").find("0 types for 2 names"), std::string::npos);
  EXPECT_NE(refusal(0, "DOUBLE,INT32").find("refuses"), std::string::npos);
}

TEST(Rtde, CommandIsSixVelocitiesCounterAndCommand) {
  rtde::PacketWriter writer(PacketType::kData);
  const auto bytes = UrCommand(&writer, 3, {0.1, 0, 0, 0, 0, -0.1}, -2, true);
  ASSERT_EQ(bytes.size(), rtde::kHeaderSize + 1 + rtde::SizeOf(UrInputs(0)));
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 12), Hex("00 3c 55 03 3f b9 99 99 99 99 99 9a"));
  EXPECT_EQ(Bytes(bytes.end() - 16, bytes.end()),
            Hex("bf b9 99 99 99 99 99 9a ff ff ff fe 00 00 00 01"));
}

TEST(Rtde, StateIsTakenInTheRecipesOrderAndNoOtherSize) {
  for (const UrExtras extras : {UrExtras{},
                                {true, false, false},
                                {false, true, false},
                                {false, false, true},
                                {true, true, true}}) {
    rtde::PacketWriter writer(PacketType::kData);
    writer.Put(std::uint8_t{1}).Put(12.5);
    for (int i = 0; i < 12; ++i) writer.Put(0.25 * i);
    writer.Put(std::int32_t{7}).Put(3U).Put(1U).Put(2U).Put(0.5).Put(std::uint64_t{1} << 17);
    for (int i = 0; i < 6; ++i) writer.Put(10.0 + i);
    writer.Put(std::int32_t{-5}).Put(std::int32_t{2});
    for (int i = 0; extras.tool_offset && i < 6; ++i) writer.Put(20.0 + i);
    for (int i = 0; extras.wrench && i < 6; ++i) writer.Put(-1.0 * i);
    for (int i = 0; extras.payload && i < 4; ++i) writer.Put(0.4 + i);
    const Bytes bytes = Written(&writer);
    const auto payload = std::span(bytes).subspan(rtde::kHeaderSize);
    ASSERT_EQ(payload.size(), 1 + rtde::SizeOf(UrOutputs(0, extras)));
    UrState state;
    ASSERT_TRUE(Decode(payload, 1, extras, &state));
    EXPECT_EQ(state.timestamp, 12.5);
    EXPECT_EQ(state.q[5], 1.25);
    EXPECT_EQ(state.v[0], 1.5);
    EXPECT_EQ(state.robot_mode, 7);
    EXPECT_EQ(state.robot_bits, 3U);
    EXPECT_EQ(state.safety_bits, 1U);
    EXPECT_EQ(state.runtime, 2U);
    EXPECT_EQ(state.echo, -5);
    EXPECT_EQ(state.script, 2);
    EXPECT_EQ(state.slider, 0.5);
    EXPECT_EQ(state.inputs, std::uint64_t{1} << 17);
    EXPECT_EQ(state.wrench[5], extras.wrench ? -5.0 : 0.0);
    EXPECT_EQ(state.tool[5], 15);
    EXPECT_EQ(state.tool_offset[5], extras.tool_offset ? 25 : 0);
    EXPECT_EQ(state.payload, extras.payload ? 0.4 : 0.0);
    EXPECT_EQ(state.payload_cog[2], extras.payload ? 3.4 : 0.0);
    EXPECT_FALSE(Decode(payload, 2, extras, &state));
    EXPECT_FALSE(Decode(payload, 1, {!extras.wrench, extras.payload, extras.tool_offset}, &state));
    EXPECT_FALSE(Decode(payload, 1, {extras.wrench, !extras.payload, extras.tool_offset}, &state));
    EXPECT_FALSE(Decode(payload, 1, {extras.wrench, extras.payload, !extras.tool_offset}, &state));
    EXPECT_FALSE(Decode(payload.first(payload.size() - 1), 1, extras, &state));
  }
}

TEST(UrState, WithImpossibleNumbersIsNotUsed) {
  UrState state;
  EXPECT_TRUE(Plausible(state));
  state.timestamp = 9e8;
  EXPECT_TRUE(Plausible(state));
  for (const double never : {1e300, -1e300, 1e12, std::nan(""), HUGE_VAL}) {
    state = {};
    state.timestamp = never;
    EXPECT_FALSE(Plausible(state)) << never;
    state = {};
    state.q[5] = never;
    EXPECT_FALSE(Plausible(state)) << never;
    state = {};
    state.v[0] = never;
    EXPECT_FALSE(Plausible(state)) << never;
  }
}

// The bits are numbered as in the RTDE guide.
TEST(UrState, EachBitThatKeepsAnArmFromMovingIsAFault) {
  UrState well;
  well.robot_mode = 7;
  EXPECT_EQ(ArmFault(well), UrFault::kNone);
  const std::vector<std::pair<int, UrFault>> bits = {
      {2, UrFault::kProtectiveStop}, {3, UrFault::kSafetyFault},   {4, UrFault::kSafeguardStop},
      {5, UrFault::kEmergencyStop},  {6, UrFault::kEmergencyStop}, {7, UrFault::kEmergencyStop},
      {8, UrFault::kSafetyFault},    {9, UrFault::kSafetyFault},   {10, UrFault::kSafetyFault}};
  for (const auto& [bit, fault] : bits) {
    UrState state = well;
    state.safety_bits = 1U | 1U << bit;  // bit 0: normal
    EXPECT_EQ(ArmFault(state), fault) << bit;
    EXPECT_EQ(RunFault(state), fault) << bit;
  }
  for (const int mode : {-1, 0, 3, 5, 6, 8}) {
    UrState state = well;
    state.robot_mode = mode;
    EXPECT_EQ(ArmFault(state), UrFault::kUnpowered) << mode;
  }
}

TEST(UrState, ANanSpeedSliderIsNotAtItsEnd) {
  UrState state;
  for (const double whole : {0.995, 1.0}) {
    state.slider = whole;
    EXPECT_FALSE(SlowedDown(state)) << whole;
  }
  for (const double less : {0.994, 0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    state.slider = less;
    EXPECT_TRUE(SlowedDown(state)) << less;
  }
}

// The state of the arm is unknown, or a person has pressed its stop button.
TEST(UrState, EndsWithoutPowerIfTheArmMustNotBeHeld) {
  for (int fault = 0; fault <= static_cast<int>(UrFault::kCommand); ++fault) {
    const auto f = static_cast<UrFault>(fault);
    const bool ends = f == UrFault::kClosed || f == UrFault::kMalformed || f == UrFault::kDeaf ||
                      f == UrFault::kEmergencyStop || f == UrFault::kSafetyFault;
    EXPECT_EQ(EndsWithoutPower(f), ends) << Sentence(f);
  }
}

}  // namespace
}  // namespace predictor
