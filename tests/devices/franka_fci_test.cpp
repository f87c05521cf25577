#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/random.h"
#include "devices/franka/fci.h"

namespace predictor::fci {
namespace {

struct Field {
  const char* name;
  int count;
};
// The fields before the modes have the same order as in research_interface/robot/rbk_types.h.
const std::vector<Field> kSignals = {{"O_T_EE", 16},
                                     {"O_T_EE_d", 16},
                                     {"F_T_EE", 16},
                                     {"EE_T_K", 16},
                                     {"F_T_NE", 16},
                                     {"NE_T_EE", 16},
                                     {"m_ee", 1},
                                     {"I_ee", 9},
                                     {"F_x_Cee", 3},
                                     {"m_load", 1},
                                     {"I_load", 9},
                                     {"F_x_Cload", 3},
                                     {"elbow", 2},
                                     {"elbow_d", 2},
                                     {"tau_J", 7},
                                     {"tau_J_d", 7},
                                     {"dtau_J", 7},
                                     {"q", 7},
                                     {"q_d", 7},
                                     {"dq", 7},
                                     {"dq_d", 7},
                                     {"ddq_d", 7},
                                     {"joint_contact", 7},
                                     {"cartesian_contact", 6},
                                     {"joint_collision", 7},
                                     {"cartesian_collision", 6},
                                     {"tau_ext_hat_filtered", 7},
                                     {"O_F_ext_hat_K", 6},
                                     {"K_F_ext_hat_K", 6},
                                     {"O_dP_EE_d", 6},
                                     {"O_ddP_O", 3},
                                     {"elbow_c", 2},
                                     {"delbow_c", 2},
                                     {"ddelbow_c", 2},
                                     {"O_T_EE_c", 16},
                                     {"O_dP_EE_c", 6},
                                     {"O_ddP_EE_c", 6},
                                     {"theta", 7},
                                     {"dtheta", 7}};

// Returns the offset of a field, after the message id and all earlier fields.
std::size_t Place(const std::string& name, std::size_t real) {
  std::size_t at = 8;
  for (const Field& field : kSignals) {
    if (name == field.name) return at;
    at += real * static_cast<std::size_t>(field.count);
  }
  return name == "end" ? at : 0;
}

struct Layout {
  std::uint16_t version;
  std::size_t size, real, accelerometers;
};
constexpr Layout kLayouts[] = {{5, 2373, 8, 0}, {10, 1233, 4, 0}, {10, 1377, 4, 36}};

// A state whose numbers are written one by one at their offsets.
class Written {
 public:
  explicit Written(const Layout& layout) : layout_(layout), bytes_(layout.size) {
    for (int i = 0; i < 4; ++i) {
      Put("O_T_EE", 5 * i, 1);
      Put("F_T_EE", 5 * i, 1);
      Put("EE_T_K", 5 * i, 1);
    }
    Byte(modes() + 1, 3);
    Byte(modes() + 84, 1);
  }
  void Id(std::uint64_t id) { std::memcpy(bytes_.data(), &id, 8); }
  void Put(const char* field, int i, double value) {
    const std::size_t at = Place(field, layout_.real) + layout_.real * static_cast<std::size_t>(i);
    const auto single = static_cast<float>(value);
    if (layout_.real == 8)
      std::memcpy(bytes_.data() + at, &value, 8);
    else
      std::memcpy(bytes_.data() + at, &single, 4);
  }
  void Byte(std::size_t at, int value) {
    bytes_[at] = static_cast<std::byte>(static_cast<unsigned char>(value));
  }
  std::size_t modes() const { return Place("end", layout_.real) + 4 * layout_.accelerometers; }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  Layout layout_;
  std::vector<std::byte> bytes_;
};

TEST(FrankaPackets, EndWhereTheirSizesSay) {
  // The fields end with two modes, two lists of 41 errors, one mode, and the success rate.
  for (const Layout& l : kLayouts) {
    EXPECT_EQ(Place("end", l.real) + 4 * l.accelerometers + 2 + 82 + 1 + l.real, l.size);
    EXPECT_TRUE(IsStateSize(l.version, l.size));
    EXPECT_FALSE(IsStateSize(l.version, l.size - 1));
    EXPECT_FALSE(IsStateSize(7, l.size));
  }
  EXPECT_FALSE(IsStateSize(5, 1377));
  EXPECT_FALSE(IsStateSize(10, 2373));
}

TEST(FrankaPackets, LieWhereThePublishedHeadersPutThem) {
  EXPECT_EQ(offsetof(Signals<float>, q), Place("q", 4));
  EXPECT_EQ(offsetof(Signals<float>, ddq_d), Place("ddq_d", 4));
  EXPECT_EQ(offsetof(Signals<float>, K_F_ext_hat_K), Place("K_F_ext_hat_K", 4));
  EXPECT_EQ(offsetof(Signals<float>, dtheta), Place("dtheta", 4));
  EXPECT_EQ(offsetof(Signals<double>, q_d), Place("q_d", 8));
  EXPECT_EQ(offsetof(Signals<double>, EE_T_K), Place("EE_T_K", 8));
  EXPECT_EQ(offsetof(Signals<double>, O_ddP_EE_c), Place("O_ddP_EE_c", 8));
}

TEST(FrankaState, IsReadFromItsPlacesInEachLayout) {
  for (const Layout& l : kLayouts) {
    Written w(l);
    w.Id(0x0102030405060708);
    for (int i = 0; i < 7; ++i) {
      w.Put("q", i, 0.1 * i);
      w.Put("dq", i, 0.2 * i);
      w.Put("q_d", i, 0.3 * i);
      w.Put("dq_d", i, -0.4 * i);
      w.Put("ddq_d", i, 0.5 * i);
    }
    for (int i = 0; i < 6; ++i) w.Put("K_F_ext_hat_K", i, 1 + i);
    w.Put("F_T_EE", 14, 0.1);
    w.Put("EE_T_K", 12, 0.2);
    w.Put("O_T_EE", 13, 0.4);
    w.Put("m_ee", 0, 0.75);
    w.Put("m_load", 0, 1.5);
    w.Byte(w.modes(), 2);
    w.Byte(w.modes() + 1, 0);
    w.Byte(w.modes() + 2 + 25, 1);
    w.Byte(w.modes() + 2 + 41 + 3, 1);
    w.Byte(w.modes() + 84, 4);
    RobotState s;
    ASSERT_TRUE(Decode(l.version, w.bytes(), &s)) << l.size;
    EXPECT_EQ(s.message_id, 0x0102030405060708U);
    for (std::size_t i = 0; i < 7; ++i) {
      const auto x = static_cast<double>(i);
      EXPECT_NEAR(s.q[i], 0.1 * x, 1e-6);
      EXPECT_NEAR(s.dq[i], 0.2 * x, 1e-6);
      EXPECT_NEAR(s.q_d[i], 0.3 * x, 1e-6);
      EXPECT_NEAR(s.dq_d[i], -0.4 * x, 1e-6);
      EXPECT_NEAR(s.ddq_d[i], 0.5 * x, 1e-6);
    }
    EXPECT_NEAR((s.F_K_K - Wrench(1, 2, 3, 4, 5, 6)).norm(), 0, 1e-6);
    EXPECT_NEAR((s.X_FK.p - Vector3(0.2, 0, 0.1)).norm(), 0, 1e-6);
    ASSERT_TRUE(s.X_OF);
    EXPECT_NEAR((s.X_OF->p - Vector3(0, 0.4, -0.1)).norm(), 0, 1e-6);
    EXPECT_NEAR(s.compensated_mass, 2.25, 1e-6);
    EXPECT_EQ(s.generator, MotionGeneratorMode::kJointVelocity);
    EXPECT_EQ(s.controller, ControllerMode::kJointImpedance);
    EXPECT_EQ(s.mode, RobotMode::kReflex);
    EXPECT_EQ(ErrorWords(s.errors), "communication constraints violation");
    EXPECT_EQ(ErrorWords(s.reflex_reason), "joint velocity violation");
  }
}

TEST(FrankaState, ThatIsImpossibleIsRefusedAndChangesNothing) {
  constexpr double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), -1e30, 400};
  for (const Layout& l : kLayouts) {
    for (const char* field : {"q", "dq", "q_d", "dq_d", "ddq_d"}) {
      for (const double bad : kBad) {
        Written w(l);
        w.Put(field, 6, bad);
        RobotState s;
        s.message_id = 77;
        EXPECT_FALSE(Decode(l.version, w.bytes(), &s)) << field << bad;
        EXPECT_EQ(s.message_id, 77U);
      }
    }
    for (const std::size_t mode : {std::size_t{0}, std::size_t{1}, std::size_t{84}}) {
      Written w(l);
      w.Byte(w.modes() + mode, 7);
      RobotState s;
      EXPECT_FALSE(Decode(l.version, w.bytes(), &s));
    }
    Written w(l);
    RobotState s;
    EXPECT_TRUE(Decode(l.version, w.bytes(), &s));
    EXPECT_FALSE(Decode(l.version, std::span(w.bytes()).first(l.size - 1), &s));
  }
}

TEST(FrankaState, HasNoWrenchIfItsFramesAreInvalid) {
  for (const Layout& l : kLayouts) {
    for (const char* frame : {"F_T_EE", "EE_T_K"}) {
      for (const double bad : {2.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        Written w(l);
        w.Put("K_F_ext_hat_K", 0, 5);
        w.Put(frame, 0, bad);
        RobotState s;
        ASSERT_TRUE(Decode(l.version, w.bytes(), &s));
        EXPECT_TRUE(s.F_K_K.isZero(0)) << frame << bad;
      }
    }
  }
}

TEST(FrankaState, HasNoFlangeIfItsFramesAreInvalid) {
  for (const Layout& l : kLayouts)
    for (const char* frame : {"O_T_EE", "F_T_EE", "EE_T_K"}) {
      Written w(l);
      w.Put(frame, 0, 2);
      RobotState s;
      ASSERT_TRUE(Decode(l.version, w.bytes(), &s));
      EXPECT_EQ(s.X_OF.has_value(), frame == std::string("EE_T_K")) << frame;
    }
}

// Arbitrary bytes must be either read or refused. The sanitizers check the memory accesses.
TEST(FrankaState, OfAnyBytesIsReadOrRefused) {
  RandomStream random(5, "states");
  for (int round = 0; round < 2000; ++round) {
    const Layout& l = kLayouts[random.Next() % 3];
    std::vector<std::byte> bytes(random.Next() % 8 == 0 ? random.Next() % 3000 : l.size);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random.Next() & 0xFF);
    RobotState s;
    if (!Decode(l.version, bytes, &s)) continue;
    for (const double q : s.q) EXPECT_LE(std::abs(q), 7);
  }
}

TEST(FrankaCommand, HoldsVelocitiesAndTheStateItAnswers) {
  const Joints v = {0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7};
  CommandBuffer buffer;
  for (const std::uint16_t version : {std::uint16_t{5}, std::uint16_t{10}}) {
    const auto bytes = EncodeVelocity(version, 0x1122334455667788, v, true, &buffer);
    ASSERT_EQ(bytes.size(), version == 5 ? 370U : 371U);
    EXPECT_EQ(bytes[0], std::byte{0x88});
    double read[7];
    std::memcpy(read, bytes.data() + 8 + 56, sizeof read);  // after the id and seven positions
    for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(read[i], v[i]);
    EXPECT_EQ(bytes[8 + 38 * 8 + 1], std::byte{1});  // after 38 numbers and an elbow's flag
    const auto going = EncodeVelocity(version, 1, v, false, &buffer);
    EXPECT_EQ(going[8 + 38 * 8 + 1], std::byte{0});
  }
}

// These bytes were sent by pylibfranka 0.21.3 when it connected to an emulator. They are u32
// command, u32 id, u32 size, u16 version and u16 port. The two bytes of the port are not compared.
TEST(FrankaRequest, ToConnectIsThatOfLibfranka) {
  RequestBuffer buffer;
  const auto bytes = EncodeConnect(10, 0, 0x1234, &buffer);
  const std::vector<int> expected = {0, 0, 0, 0, 0, 0, 0, 0, 16, 0, 0, 0, 10, 0, 0x34, 0x12};
  ASSERT_EQ(bytes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(std::to_integer<int>(bytes[i]), expected[i]) << i;
}

TEST(FrankaRequest, ToMoveNamesItsModes) {
  RequestBuffer buffer;
  for (const std::uint16_t version : {std::uint16_t{5}, std::uint16_t{10}}) {
    const auto bytes = EncodeMove(version, 9, &buffer);
    ASSERT_EQ(bytes.size(), version == 5 ? 12U + 56U : 12U + 113U);
    const std::vector<int> expected = {1, 0, 0, 0, 9, 0, 0, 0, version == 5 ? 68 : 125, 0, 0, 0,
                                       0, 0, 0, 0, 1, 0, 0, 0};
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(std::to_integer<int>(bytes[i]), expected[i]) << i;
  }
}

TEST(FrankaRequest, NumbersDifferBetweenTheVersions) {
  EXPECT_EQ(Number(Command::kSetCollisionBehavior, 5), 4U);
  EXPECT_EQ(Number(Command::kSetCollisionBehavior, 10), 3U);
  EXPECT_EQ(Number(Command::kAutomaticErrorRecovery, 5), 12U);
  EXPECT_EQ(Number(Command::kAutomaticErrorRecovery, 10), 10U);
  EXPECT_EQ(Number(Command::kGetRobotModel, 10), 11U);
  EXPECT_FALSE(Number(Command::kGetRobotModel, 5));
}

TEST(FrankaMoveStatus, IsNamedByEachVersionsNumber) {
  EXPECT_EQ(MoveStatusOf(0, 5), MoveStatus::kSuccess);
  EXPECT_EQ(MoveStatusOf(2, 5), MoveStatus::kPreempted);
  EXPECT_EQ(MoveStatusOf(3, 5), MoveStatus::kNotPossible);
  EXPECT_EQ(MoveStatusOf(6, 5), MoveStatus::kReflexAborted);
  EXPECT_EQ(MoveStatusOf(9, 5), MoveStatus::kAborted);
  EXPECT_EQ(MoveStatusOf(10, 5), MoveStatus::kUnknown);
  EXPECT_EQ(MoveStatusOf(3, 10), MoveStatus::kPreemptedBySafetyFunction);
  EXPECT_EQ(MoveStatusOf(5, 10), MoveStatus::kNotPossible);
  EXPECT_EQ(MoveStatusOf(8, 10), MoveStatus::kReflexAborted);
  EXPECT_EQ(MoveStatusOf(9, 10), MoveStatus::kEmergencyAborted);
  EXPECT_EQ(MoveStatusOf(12, 10), MoveStatus::kUnknown);
  EXPECT_EQ(MoveStatusOf(255, 10), MoveStatus::kUnknown);
}

std::vector<std::byte> MakeAnswer(std::uint32_t command, std::uint32_t id, std::size_t body) {
  std::vector<std::byte> bytes(sizeof(Header) + body);
  const Header header{command, id, static_cast<std::uint32_t>(bytes.size())};
  std::memcpy(bytes.data(), &header, sizeof header);
  for (std::size_t i = 0; i < body; ++i) bytes[sizeof header + i] = static_cast<std::byte>(i + 1);
  return bytes;
}

TEST(FrankaAnswers, CutAnywhereAreTheSame) {
  std::vector<std::byte> stream;
  const std::vector<std::size_t> bodies = {1, 3, 20'000, 2, 600, 1};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto answer = MakeAnswer(7, static_cast<std::uint32_t>(i), bodies[i]);
    stream.insert(stream.end(), answer.begin(), answer.end());
  }
  RandomStream random(3, "pieces");
  for (const std::size_t most :
       {std::size_t{1}, std::size_t{5}, std::size_t{13}, std::size_t{512}}) {
    AnswerReader reader;
    std::uint32_t next = 0;
    Answer answer;
    for (std::size_t at = 0; at < stream.size();) {
      const auto room = reader.room();
      ASSERT_GT(room.size(), 0U);
      const std::size_t n = std::min({room.size(), stream.size() - at, 1 + random.Next() % most});
      std::copy_n(stream.begin() + static_cast<std::ptrdiff_t>(at), n, room.begin());
      reader.Arrived(n);
      at += n;
      while (reader.Next(&answer)) {
        EXPECT_EQ(answer.header.id, next++);
        EXPECT_EQ(answer.status(), 1);
      }
    }
    EXPECT_EQ(next, bodies.size());
    EXPECT_FALSE(reader.broken());
  }
}

TEST(FrankaAnswers, OfImpossibleSizesBreakTheStream) {
  for (const std::uint32_t size : {0U, 11U, 12U, 0xFFFFFFFFU}) {
    AnswerReader reader;
    const Header header{1, 2, size};
    std::memcpy(reader.room().data(), &header, sizeof header);
    reader.Arrived(sizeof header);
    Answer answer;
    EXPECT_FALSE(reader.Next(&answer));
    EXPECT_TRUE(reader.broken()) << size;
  }
}

}  // namespace
}  // namespace predictor::fci
