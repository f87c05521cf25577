#include "ergonomics/rula.h"

#include "ergonomics/joint_scores.h"

namespace predictor::ergonomics {
namespace {

// Rows: upper arm 1 … 6, lower arm 1 … 3. Columns: wrist 1 … 4, each with twist 1 and 2.
constexpr std::string_view kRulaA[6][3] = {
    {"12222333", "22223333", "23333344"}, {"23333444", "33333444", "34444455"},
    {"33444455", "34444455", "44444555"}, {"44444555", "44444555", "44455566"},
    {"55555667", "56666777", "66677778"}, {"77777889", "88888999", "99999999"}};
// Rows: neck 1 … 6. Columns: trunk 1 … 6, each with legs 1 and 2.
constexpr std::string_view kRulaB[6] = {"132334556677", "232345556777", "333445566777",
                                        "555667777788", "777778888888", "888888899999"};
// Rows: wrist and arm 1 … 8. Columns: neck, trunk and legs 1 … 7.
constexpr std::string_view kRulaC[8] = {"1233455", "2234455", "3334456", "3334566",
                                        "4445677", "4456677", "5566777", "5567777"};

int RulaWrist(const ArmPosture& arm) {
  const double flexion = std::abs(arm.wrist_flexion);
  const int bent = flexion > Degrees(15) ? 3 : flexion > kDeclaredThresholds.neutral ? 2 : 1;
  return bent + Exceeds(arm.wrist_deviation, kDeclaredThresholds.side_or_twist);
}

int RulaNeck(const BodyPosture& body) {
  const double flexion = body.neck_flexion;
  const int bent = flexion < -kDeclaredThresholds.neutral ? 4
                   : flexion > Degrees(20)                ? 3
                   : flexion > Degrees(10)                ? 2
                                                          : 1;
  return bent + Exceeds(body.neck_twist, kDeclaredThresholds.side_or_twist) +
         Exceeds(body.neck_side_bend, kDeclaredThresholds.side_or_twist);
}

int RulaForce(const Exertion& exertion) {
  if (exertion.shock) return 3;
  if (exertion.load < 2) return 0;
  return 1 + (exertion.load > 10) + (exertion.held || exertion.repeated);
}

}  // namespace

int RulaTableA(int upper_arm, int lower_arm, int wrist, int wrist_twist) {
  return Cell(kRulaA[upper_arm - 1][lower_arm - 1], 2 * (wrist - 1) + wrist_twist - 1);
}

int RulaTableB(int neck, int trunk, int legs) {
  return Cell(kRulaB[neck - 1], 2 * (trunk - 1) + legs - 1);
}

int RulaTableC(int wrist_and_arm, int neck_trunk_legs) {
  return Cell(kRulaC[std::min(wrist_and_arm, 8) - 1], std::min(neck_trunk_legs, 7) - 1);
}

Action RulaAction(int grand) {
  if (grand <= 2)
    return {1, "The posture is acceptable if it is not held or repeated for long periods."};
  if (grand <= 4) return {2, "Investigate further; changes may be needed."};
  if (grand <= 6) return {3, "Investigate further and make changes soon."};
  return {4, "Investigate and make changes immediately."};
}

RulaScores AssessRula(const BodyPosture& body, const ArmPosture& arm, const Exertion& exertion) {
  RulaScores s;
  s.upper_arm = std::max(1, UpperArmFlexionScore(arm.upper_arm_flexion) + arm.shoulder_raised +
                                Exceeds(arm.upper_arm_abduction, kDeclaredThresholds.abducted) -
                                arm.supported);
  s.lower_arm = ElbowScore(arm.elbow_flexion) + arm.across_or_out;
  s.wrist = RulaWrist(arm);
  s.wrist_twist = Exceeds(arm.forearm_rotation, kDeclaredThresholds.near_end_of_twist) ? 2 : 1;
  s.posture_a = RulaTableA(s.upper_arm, s.lower_arm, s.wrist, s.wrist_twist);
  s.muscle = exertion.held || exertion.repeated;
  s.force = RulaForce(exertion);
  s.wrist_and_arm = s.posture_a + s.muscle + s.force;

  s.neck = RulaNeck(body);
  s.trunk = TrunkFlexionScore(body.trunk_flexion) +
            Exceeds(body.trunk_twist, kDeclaredThresholds.side_or_twist) +
            Exceeds(body.trunk_side_bend, kDeclaredThresholds.side_or_twist);
  s.legs = body.on_both_feet ? 1 : 2;
  s.posture_b = RulaTableB(s.neck, s.trunk, s.legs);
  s.neck_trunk_legs = s.posture_b + s.muscle + s.force;

  s.grand = RulaTableC(s.wrist_and_arm, s.neck_trunk_legs);
  s.action = RulaAction(s.grand);
  return s;
}

}  // namespace predictor::ergonomics
