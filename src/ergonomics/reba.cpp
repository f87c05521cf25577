#include "ergonomics/reba.h"

#include "ergonomics/joint_scores.h"

namespace predictor::ergonomics {
namespace {

// Rows: neck 1 … 3, trunk 1 … 5. Columns: legs 1 … 4.
constexpr std::string_view kRebaA[3][5] = {{"1234", "2345", "2456", "3567", "4678"},
                                           {"1234", "3456", "4567", "5678", "6789"},
                                           {"3356", "4567", "5678", "6789", "7899"}};
// Rows: upper arm 1 … 6. Columns: lower arm 1 and 2, each with wrist 1 … 3.
constexpr std::string_view kRebaB[6] = {"122123", "123234", "345455", "455567", "678788", "788899"};
// Rows: score A 1 … 12. Columns: score B 1 … 12.
constexpr std::string_view kRebaC[12] = {
    "111233456777", "122344566778", "233345677888", "344456788999", "444567889999", "66678899AAAA",
    "7778999AABBB", "8889AAAAABBB", "999AAABBBCCC", "AAABBBBCCCCC", "BBBBCCCCCCCC", "CCCCCCCCCCCC"};

int RebaNeck(const BodyPosture& body) {
  const bool bent =
      body.neck_flexion > Degrees(20) || body.neck_flexion < -kDeclaredThresholds.neutral;
  return 1 + bent +
         (Exceeds(body.neck_twist, kDeclaredThresholds.side_or_twist) ||
          Exceeds(body.neck_side_bend, kDeclaredThresholds.side_or_twist));
}

int RebaLegs(const BodyPosture& body) {
  const int knees = body.sitting                       ? 0
                    : body.knee_flexion > Degrees(60)  ? 2
                    : body.knee_flexion >= Degrees(30) ? 1
                                                       : 0;
  return (body.on_both_feet ? 1 : 2) + knees;
}

int RebaUpperArm(const ArmPosture& arm) {
  const bool out = Exceeds(arm.upper_arm_abduction, kDeclaredThresholds.abducted) ||
                   Exceeds(arm.upper_arm_rotation, kDeclaredThresholds.rotated);
  return std::max(
      1, UpperArmFlexionScore(arm.upper_arm_flexion) + arm.shoulder_raised + out - arm.supported);
}

int RebaWrist(const ArmPosture& arm) {
  const bool turned = Exceeds(arm.wrist_deviation, kDeclaredThresholds.side_or_twist) ||
                      Exceeds(arm.forearm_rotation, kDeclaredThresholds.near_end_of_twist);
  return 1 + Exceeds(arm.wrist_flexion, Degrees(15)) + turned;
}

int RebaLoad(const Exertion& exertion) {
  return (exertion.load > 10 ? 2 : exertion.load >= 5 ? 1 : 0) + exertion.shock;
}

}  // namespace

int RebaTableA(int neck, int trunk, int legs) {
  return Cell(kRebaA[neck - 1][trunk - 1], legs - 1);
}

int RebaTableB(int upper_arm, int lower_arm, int wrist) {
  return Cell(kRebaB[upper_arm - 1], 3 * (lower_arm - 1) + wrist - 1);
}

int RebaTableC(int score_a, int score_b) { return Cell(kRebaC[score_a - 1], score_b - 1); }

Action RebaAction(int reba) {
  if (reba <= 1) return {1, "The risk is negligible; no action is necessary."};
  if (reba <= 3) return {2, "The risk is low; action may be necessary."};
  if (reba <= 7) return {3, "The risk is medium; action is necessary."};
  if (reba <= 10) return {4, "The risk is high; action is necessary soon."};
  return {5, "The risk is very high; action is necessary now."};
}

RebaScores AssessReba(const BodyPosture& body, const ArmPosture& arm, const Exertion& exertion) {
  RebaScores s;
  s.neck = RebaNeck(body);
  s.trunk = TrunkFlexionScore(body.trunk_flexion) +
            (Exceeds(body.trunk_twist, kDeclaredThresholds.side_or_twist) ||
             Exceeds(body.trunk_side_bend, kDeclaredThresholds.side_or_twist));
  s.legs = RebaLegs(body);
  s.posture_a = RebaTableA(s.neck, s.trunk, s.legs);
  s.load = RebaLoad(exertion);
  s.score_a = s.posture_a + s.load;

  s.upper_arm = RebaUpperArm(arm);
  s.lower_arm = ElbowScore(arm.elbow_flexion);
  s.wrist = RebaWrist(arm);
  s.posture_b = RebaTableB(s.upper_arm, s.lower_arm, s.wrist);
  s.coupling = static_cast<int>(exertion.coupling);
  s.score_b = s.posture_b + s.coupling;

  s.score_c = RebaTableC(s.score_a, s.score_b);
  s.activity = exertion.held + exertion.repeated + exertion.large_rapid_change;
  s.reba = s.score_c + s.activity;
  s.action = RebaAction(s.reba);
  return s;
}

}  // namespace predictor::ergonomics
