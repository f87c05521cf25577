// Tests RULA, REBA and OWAS with postures scored by hand, the order within the tables, and
// symmetry.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <string>

#include "core/random.h"
#include "ergonomics/owas.h"
#include "ergonomics/reba.h"
#include "ergonomics/reference_postures.h"
#include "ergonomics/rula.h"
#include "support/allocation_guard.h"

namespace predictor::ergonomics {
namespace {

std::map<std::string, int> Named(const RulaScores& s) {
  return {{"upper_arm", s.upper_arm},
          {"lower_arm", s.lower_arm},
          {"wrist", s.wrist},
          {"wrist_twist", s.wrist_twist},
          {"posture_a", s.posture_a},
          {"muscle", s.muscle},
          {"force", s.force},
          {"wrist_and_arm", s.wrist_and_arm},
          {"neck", s.neck},
          {"trunk", s.trunk},
          {"legs", s.legs},
          {"posture_b", s.posture_b},
          {"neck_trunk_legs", s.neck_trunk_legs},
          {"grand", s.grand},
          {"level", s.action.level}};
}

std::map<std::string, int> Named(const RebaScores& s) {
  return {{"neck", s.neck},           {"trunk", s.trunk},         {"legs", s.legs},
          {"posture_a", s.posture_a}, {"load", s.load},           {"score_a", s.score_a},
          {"upper_arm", s.upper_arm}, {"lower_arm", s.lower_arm}, {"wrist", s.wrist},
          {"posture_b", s.posture_b}, {"coupling", s.coupling},   {"score_b", s.score_b},
          {"score_c", s.score_c},     {"activity", s.activity},   {"reba", s.reba},
          {"level", s.action.level}};
}

void ExpectScores(const std::map<std::string, int>& by_hand, std::map<std::string, int> computed,
                  const std::string& posture) {
  for (const auto& [score, value] : by_hand) {
    ASSERT_TRUE(computed.contains(score)) << posture << ": " << score;
    EXPECT_EQ(computed[score], value) << posture << ": " << score;
  }
}

TEST(PostureScores, AreThoseThatWereScoredByHand) {
  const auto postures = ReadPostures("reference_postures.txt");
  ASSERT_GE(postures.size(), 10u);
  for (const ReferencePosture& p : postures) {
    EXPECT_GE(std::min(p.rula.size(), p.reba.size()), 6u) << p.name;
    ExpectScores(p.rula, Named(AssessRula(p.body, p.arm, p.exertion)), p.name + ", RULA");
    ExpectScores(p.reba, Named(AssessReba(p.body, p.arm, p.exertion)), p.name + ", REBA");
  }
}

TEST(PostureScores, AreThoseOfPublishedExamples) {
  const auto postures = ReadPostures("published_postures.txt");
  ASSERT_EQ(postures.size(), 7u);
  for (const ReferencePosture& p : postures) {
    EXPECT_GE(p.rula.size() + p.reba.size(), 4u) << p.name;
    ExpectScores(p.rula, Named(AssessRula(p.body, p.arm, p.exertion)), p.name + ", RULA");
    ExpectScores(p.reba, Named(AssessReba(p.body, p.arm, p.exertion)), p.name + ", REBA");
  }
}

// Compares the scores with four published examples: phase 4 of
// text-id.123dok.com/document/nzw0r4ngy, a pushed water bottle in wyeokwv4q, an exercise
// (fdocuments.es/document/ejercicio-reba), and a welder (scribd.com/document/509190964). Their
// stored texts contain the scores of the body parts, but not the angles.
TEST(PostureScores, CombineAsInPublishedExamples) {
  EXPECT_EQ(RulaTableC(4 + 1 + 0, 4 + 1 + 0), 6);
  EXPECT_EQ(RulaAction(6).level, 3);
  EXPECT_EQ(RebaTableB(2, 1, 2), 2);
  EXPECT_EQ(RebaTableC(5, 2 + 1), 4);
  EXPECT_EQ(RebaTableB(4, 2, 2), 6);
  EXPECT_EQ(RebaTableC(4 + 2, 6 + 3), 10);
  EXPECT_EQ(RebaAction(10 + 1).level, 5);
  EXPECT_EQ(RebaTableA(1, 4, 3), 6);
  EXPECT_EQ(RebaTableB(4, 1, 2), 5);
  EXPECT_EQ(RebaTableC(6 + 3, 5 + 3), 11);
}

// Tests the load classes that do not occur in the scored postures (McAtamney & Corlett 1993).
TEST(Rula, ScoresLoadsAsThePaperDoes) {
  const auto force = [](double load, bool held) {
    Exertion exertion;
    exertion.load = load;
    exertion.held = held;
    return AssessRula({}, {}, exertion).force;
  };
  EXPECT_EQ(force(1.9, false), 0);
  EXPECT_EQ(force(2, false), 1);
  EXPECT_EQ(force(10, false), 1);
  EXPECT_EQ(force(10, true), 2);
  EXPECT_EQ(force(10.1, false), 2);
  EXPECT_EQ(force(10.1, true), 3);
}

// Calls `table` with all indices 1 … size of each axis. A step along an axis must never lower the
// result.
template <std::size_t kAxes>
void ExpectMonotone(const std::array<int, kAxes>& size, const std::array<bool, kAxes>& ordinal,
                    const std::function<int(const std::array<int, kAxes>&)>& table) {
  std::array<int, kAxes> at;
  at.fill(1);
  int cells = 0;
  while (true) {
    ++cells;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      if (!ordinal[axis] || at[axis] == size[axis]) continue;
      auto next = at;
      ++next[axis];
      EXPECT_GE(table(next), table(at)) << "axis " << axis << ", cell " << cells;
    }
    std::size_t axis = 0;
    while (axis < kAxes && at[axis] == size[axis]) at[axis++] = 1;
    if (axis == kAxes) return;
    ++at[axis];
  }
}

TEST(Rula, TablesAreMonotone) {
  ExpectMonotone<4>({6, 3, 4, 2}, {true, true, true, true},
                    [](const auto& i) { return RulaTableA(i[0], i[1], i[2], i[3]); });
  ExpectMonotone<3>({6, 6, 2}, {true, true, true},
                    [](const auto& i) { return RulaTableB(i[0], i[1], i[2]); });
  ExpectMonotone<2>({9, 8}, {true, true}, [](const auto& i) { return RulaTableC(i[0], i[1]); });
  EXPECT_EQ(RulaTableC(99, 99), 7);
}

TEST(Reba, TablesAreMonotone) {
  ExpectMonotone<3>({3, 5, 4}, {true, true, true},
                    [](const auto& i) { return RebaTableA(i[0], i[1], i[2]); });
  ExpectMonotone<3>({6, 2, 3}, {true, true, true},
                    [](const auto& i) { return RebaTableB(i[0], i[1], i[2]); });
  ExpectMonotone<2>({12, 12}, {true, true}, [](const auto& i) { return RebaTableC(i[0], i[1]); });
}

// Another public implementation (rs9000/ergonomics) prints these sub-scores for both sides of a
// person.
TEST(Reba, AgreesWithAnotherImplementation) {
  EXPECT_EQ(RebaTableA(2, 2, 2), 4);
  EXPECT_EQ(RebaTableB(1, 2, 3), 3);
  EXPECT_EQ(RebaTableC(4, 3), 4);
  EXPECT_EQ(RebaTableB(1, 2, 2), 2);
  EXPECT_EQ(RebaTableC(4, 2), 4);
}

TEST(Owas, TableIsMonotoneInArmsAndLoad) {
  ExpectMonotone<4>({4, 3, 7, 3}, {false, true, false, true}, [](const auto& i) {
    return AssessOwas(static_cast<OwasBack>(i[0]), static_cast<OwasArms>(i[1]),
                      static_cast<OwasLegs>(i[2]), static_cast<OwasLoad>(i[3]))
        .category;
  });
}

TEST(Owas, MarksTheOneCellInWhichItsSourcesDiffer) {
  int contested = 0;
  for (int cell = 0; cell < 4 * 3 * 7 * 3; ++cell)
    contested +=
        AssessOwas(static_cast<OwasBack>(1 + cell / 63), static_cast<OwasArms>(1 + cell / 21 % 3),
                   static_cast<OwasLegs>(1 + cell / 3 % 7), static_cast<OwasLoad>(1 + cell % 3))
            .contested;
  EXPECT_EQ(contested, 1);
}

// If a person is upright, no action is needed. If a person is bent and twisted, on bent knees and
// with a heavy load, action is needed immediately.
TEST(Owas, ClassifiesMeasuredPostures) {
  BodyPosture body;
  ArmPosture low, high;
  high.over_shoulder = true;
  EXPECT_EQ(AssessOwas(body, low, low, 5).category, 1);
  body.trunk_flexion = Degrees(30);
  EXPECT_EQ(AssessOwas(body, low, low, 5).back, OwasBack::kBent);
  body.trunk_twist = Degrees(-30);
  body.knee_flexion = Degrees(45);
  const OwasScore worst = AssessOwas(body, high, low, 25);
  EXPECT_EQ(worst.back, OwasBack::kBentAndTwisted);
  EXPECT_EQ(worst.arms, OwasArms::kOneAboveShoulder);
  EXPECT_EQ(worst.legs, OwasLegs::kStandingOnBentKnees);
  EXPECT_EQ(worst.load, OwasLoad::kAbove20Kg);
  EXPECT_EQ(worst.category, 4);
  EXPECT_EQ(AssessOwas(body, low, low, 10).load, OwasLoad::kTo20Kg);
  EXPECT_EQ(AssessOwas(body, low, low, 20).load, OwasLoad::kTo20Kg);
}

ReferencePosture Random(RandomStream* random) {
  const auto angle = [&](double range) { return Degrees(range * (2 * random->Uniform() - 1)); };
  const auto flag = [&] { return random->Uniform() < 0.5; };
  ReferencePosture p;
  p.body = {angle(60), angle(30), angle(45), angle(100), angle(30),
            angle(45), angle(90), flag(),    flag()};
  p.arm = {angle(150), angle(90), angle(90), angle(140), angle(90), angle(60),
           angle(40),  flag(),    flag(),    flag(),     flag()};
  p.exertion = {30 * random->Uniform(),
                flag(),
                flag(),
                flag(),
                flag(),
                static_cast<Coupling>(random->Next() % 4)};
  return p;
}

BodyPosture Mirrored(BodyPosture body) {
  for (double* angle :
       {&body.neck_side_bend, &body.neck_twist, &body.trunk_side_bend, &body.trunk_twist})
    *angle = -*angle;
  return body;
}

TEST(PostureScores, OfAMirroredPersonAreTheSame) {
  RandomStream random(1, "mirror");
  for (int i = 0; i < 1000; ++i) {
    const ReferencePosture p = Random(&random), other = Random(&random);
    const BodyPosture mirrored = Mirrored(p.body);
    EXPECT_EQ(Named(AssessRula(p.body, p.arm, p.exertion)),
              Named(AssessRula(mirrored, p.arm, p.exertion)));
    EXPECT_EQ(Named(AssessReba(p.body, p.arm, p.exertion)),
              Named(AssessReba(mirrored, p.arm, p.exertion)));
    EXPECT_EQ(AssessOwas(p.body, p.arm, other.arm, p.exertion.load).category,
              AssessOwas(mirrored, other.arm, p.arm, p.exertion.load).category);
  }
}

// Every posture must have scores within the worksheet, even one that no body could take.
TEST(PostureScores, StayWithinTheirScales) {
  RandomStream random(2, "scales");
  std::array<int, 8> grands{};
  std::array<int, 16> rebas{};
  for (int i = 0; i < 20000; ++i) {
    const ReferencePosture p = Random(&random);
    ++grands.at(static_cast<std::size_t>(AssessRula(p.body, p.arm, p.exertion).grand));
    ++rebas.at(static_cast<std::size_t>(AssessReba(p.body, p.arm, p.exertion).reba));
  }
  EXPECT_EQ(grands[0], 0);
  EXPECT_EQ(rebas[0], 0);
  EXPECT_GT(grands[7], 0);
  EXPECT_GT(rebas[13], 0);
}

TEST(PostureScores, DoNotAllocate) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  RandomStream random(3, "allocation");
  const ReferencePosture p = Random(&random);
  int sum = 0;
  const test::AllocationGuard guard;
  sum += AssessRula(p.body, p.arm, p.exertion).grand;
  sum += AssessReba(p.body, p.arm, p.exertion).reba;
  sum += AssessOwas(p.body, p.arm, p.arm, p.exertion.load).category;
  EXPECT_EQ(guard.count(), 0);
  EXPECT_GT(sum, 2);
}

}  // namespace
}  // namespace predictor::ergonomics
