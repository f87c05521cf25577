// Tests the mappings from channels to parts of the body.
#include "tracks/body_track.h"

#include <cmath>
#include <numbers>

#include "core/format.h"
#include "tracks/files.h"

namespace predictor::tracks {
namespace {

class Mapping : public Files {
 protected:
  // Loads a mapping of a.csv, which contains that table.
  BodyTrack Load(const std::string& yaml, const std::string& table) const {
    Write("a.csv", table);
    return LoadBodyTrack(Write("map.yaml", "file: a.csv\n" + yaml));
  }
};

const char* const kHalfSecond = "time,A.x [mm],A.y [mm],A.z [mm],B.x [mm],B.y [mm],B.z [mm]\n";

TEST_F(Mapping, PutsTheMeanOfMarkersIntoTheWorld) {
  // The frame of the file is at (1, 2, 0) in W and is rotated by 90° about z.
  const BodyTrack track =
      Load("frame: {xyz: [1, 2, 0], rpy: [0, 0, 90 deg]}\nhead: {markers: [A, B]}\n",
           std::string(kHalfSecond) + "0,100,0,1500,300,0,1700\n1,200,0,1500,,0,1700\n");
  ASSERT_TRUE(track.head);
  EXPECT_TRUE(track.head->p[0].isApprox(Vector3(1, 2.2, 1.6), 1e-12)) << track.head->p[0];
  EXPECT_FALSE(track.head->p[1].allFinite());  // B is missing, so the mean is unknown
}

TEST_F(Mapping, FollowsMarkersOnTheSidesOfAHead) {
  // The head looks along the y axis of the file's frame. The eyes are 0.1 m in front of the markers
  // of the head and 0.05 m below them.
  std::string table = "time";
  for (const char* name : {"F", "B", "L", "R"})
    for (const char* axis : {".x", ".y", ".z"}) table += std::string(",") + name + axis + " [m]";
  table +=
      "\n0,0,0.1,1.7,0,-0.1,1.7,-0.08,0,1.7,0.08,0,1.7\n1,0,0.1,1.7,0,-0.1,1.7,-0.08,0,1.7,0.08,0,"
      "1.7\n";
  const BodyTrack track = Load(
      "head: {markers: [L, R], front: [F], back: [B], left: [L], right: [R], xyz: [0.1, 0, "
      "-0.05]}\n",
      table);
  EXPECT_TRUE(track.head->p[0].isApprox(Vector3(0, 0.1, 1.65), 1e-12)) << track.head->p[0];
  const Matrix3 R = track.head->q[0].toRotationMatrix();
  EXPECT_TRUE(R.col(0).isApprox(Vector3::UnitY(), 1e-12));
  EXPECT_TRUE(R.col(2).isApprox(Vector3::UnitZ(), 1e-12));
}

TEST_F(Mapping, InterpolatesOverShortGapsOnly) {
  std::string table = "time,head.p.x [m],head.p.y [m],head.p.z [m]\n";
  for (const double t : {0.0, 0.04, 0.2, 0.22, 0.24})
    table += Formatted("%g,%g,0,%s\n", t, t, t == 0.22 ? "" : "1.6");
  const BodyTrack track = LoadBodyTrack(Write("plain.csv", table));
  EXPECT_NEAR(track.head->PositionAt(0.01)->x(), 0.01, 1e-12);
  EXPECT_FALSE(track.head->PositionAt(-0.01));
  EXPECT_FALSE(track.head->PositionAt(0.1));
  EXPECT_TRUE(track.head->PositionAt(0.2));
  EXPECT_FALSE(track.head->PositionAt(0.21));  // the later sample is missing
  EXPECT_FALSE(track.head->PositionAt(0.25));
  EXPECT_FALSE(track.head->RotationAt(0.01));
}

// The wrench of the hand acts on a sensor 0.1 m to the side of the handle's origin.
TEST_F(Mapping, TurnsAndShiftsAWrench) {
  std::string head =
      "time,p.x [m],p.y [m],p.z [m],q.w,q.x,q.y,q.z,f.x [N],f.y [N],f.z [N],"
      "m.x [N m],m.y [N m],m.z [N m],grip\n";
  const double half = std::sqrt(0.5);  // 90° about z
  for (const double t : {0.0, 0.01, 0.02})
    head += Formatted("%g,1,0,1,%.17g,0,0,%.17g,10,0,0,0,0,1,%d\n", t, half, half, t > 0.005);
  const BodyTrack track = Load(
      "left_hand: {position: [p], rotation: [q], force: [f], torque: [m], axes: hand, on: hand, "
      "about: [0, 0.1, 0], holds: grip}\n",
      head);
  const HandTrack& hand = *track.hands[0];
  const Wrench F = *hand.WrenchAt(0.01);
  EXPECT_TRUE(F.head<3>().isApprox(Vector3(0, -10, 0), 1e-12)) << F;
  // The sensor's moment of -1 and the moment (-0.1, 0, 0) × (0, -10, 0) = (0, 0, 1) of the force
  // add up to zero.
  EXPECT_NEAR(F[5], 0, 1e-12);
  EXPECT_FALSE(hand.HoldsAt(0.001));
  EXPECT_TRUE(hand.HoldsAt(0.015));
}

TEST_F(Mapping, CarriesOtherNumbers) {
  std::string table = "time,pulse [1/min],head.p.x [m],head.p.y [m],head.p.z [m]\n";
  for (int i = 0; i < 5; ++i) table += Formatted("%d,%d,0,0,1.6\n", i, 60 + i);
  const BodyTrack track = LoadBodyTrack(Write("plain.csv", table));
  ASSERT_EQ(track.signals.size(), 1u);
  EXPECT_EQ(track.signals[0].name, "pulse");
  EXPECT_EQ(track.signals[0].unit, "1/min");
  EXPECT_NEAR(track.signals[0].At(1.5, 0.01), 61.5, 1e-12);
  EXPECT_TRUE(std::isnan(track.signals[0].At(6, 0.01)));
  const SignalTrack fast{"emg", "mV", {0, 0.001, 0.002, 0.003}, {1, 2, 3, 6}};
  EXPECT_NEAR(fast.At(0.0015, 0.01), 3, 1e-12);  // the mean
}

TEST_F(Mapping, ReportsErrors) {
  const std::string table = std::string(kHalfSecond) + "0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n";
  const auto error = [&](const std::string& yaml) { return ErrorOf([&] { Load(yaml, table); }); };
  ExpectWords(error("head: {markers: [C]}\n"), {"a.csv", "C.x"});
  ExpectWords(error("head: {}\n"), {"map.yaml:2", "head", "position or markers"});
  ExpectWords(error("head: {position: [A.x, A.y]}\n"), {"head.position has 2 names"});
  ExpectWords(error("haed: {markers: [A]}\n"), {"map.yaml:2", "haed", "head"});
  ExpectWords(error("head: {markers: [A], xyz: [0.1, 0, 0]}\n"), {"xyz", "rotation"});
  ExpectWords(error("clock: auto\nhead: {markers: [A]}\n"),
              {"map.yaml:2", "clock is auto", "hand"});
  ExpectWords(error("offset: 3\n"), {"maps nothing"});
  ExpectWords(error("unit: inch\nhead: {markers: [A]}\n"), {"\"inch\"", "unit of length"});
  ExpectWords(error("left_hand: {markers: [A], torque: [B]}\n"), {"needs a force"});
  ExpectWords(error("left_hand: {markers: [A], rotation: [A.x, A.y, A.z, B.x]}\n"),
              {"quaternion", "length"});
}

TEST_F(Mapping, RefusesAPositionWithoutUnitAndAPartThatWasNeverSeen) {
  ExpectWords(
      ErrorOf([&] { Load("head: {position: [x, y, z]}\n", "time,x,y,z\n0,1,2,3\n1,1,2,3\n"); }),
      {"unit", "\"x\"", "unit: mm"});
  ExpectWords(ErrorOf([&] {
                Load("head: {position: [x, y, z]}\nunit: m\n", "time,x,y,z\n0,1,,3\n1,1,nan,3\n");
              }),
              {"head is missing at every time"});
  ExpectWords(ErrorOf([&] { LoadBodyTrack(Write("a.trc", "x")); }), {"mapping"});
}

}  // namespace
}  // namespace predictor::tracks
