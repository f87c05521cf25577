// RULA, Rapid Upper Limb Assessment (McAtamney & Corlett 1993), for one arm.
//
// The tables agree cell by cell with public copies (tested) and with our recollection. The table
// values increase monotonically with every score (verified). Some copies differ in one cell of
// table A. An older worksheet is also in circulation. It has smaller values in some cells of table
// A, and limits of 15° for the upper arm. The force score follows the text of the paper (verified
// in a stored copy). In contrast, a common worksheet assigns 3 instead of 2 to an intermittent load
// above 10 kg. "Static" means that a posture is held for one minute, as in the paper. In contrast,
// a common worksheet requires ten minutes. Thresholds of measured angles are a design choice
// (posture.h).
//
// RULA is not suitable for judging the risk of a person, the effect of different loads in the same
// posture, or the trend over a shift.
#pragma once

#include "ergonomics/posture.h"

namespace predictor::ergonomics {

// The scores, in the order of the worksheet.
struct RulaScores {
  // A: arm and wrist
  int upper_arm = 0;      // 1 … 6
  int lower_arm = 0;      // 1 … 3
  int wrist = 0;          // 1 … 4
  int wrist_twist = 0;    // 1 … 2
  int posture_a = 0;      // table A
  int muscle = 0;         // 0 … 1, the same for A and B
  int force = 0;          // 0 … 3, the same for A and B
  int wrist_and_arm = 0;  // row of table C
  // B: neck, trunk, legs
  int neck = 0;             // 1 … 6
  int trunk = 0;            // 1 … 6
  int legs = 0;             // 1 … 2
  int posture_b = 0;        // table B
  int neck_trunk_legs = 0;  // column of table C
  // Result
  int grand = 0;  // 1 … 7
  Action action;  // level 1 … 4
};

// Returns the scores of the posture with this arm. A person's score is the worse of the two arms'
// scores. Does not allocate.
RulaScores AssessRula(const BodyPosture& body, const ArmPosture& arm, const Exertion& exertion);

// These functions return the printed tables, for values within their axes.
int RulaTableA(int upper_arm, int lower_arm, int wrist, int wrist_twist);
int RulaTableB(int neck, int trunk, int legs);
// For larger values, the last row (8) or the last column (7) is used.
int RulaTableC(int wrist_and_arm, int neck_trunk_legs);

// Returns the action for a grand score of 1 … 7.
Action RulaAction(int grand);

}  // namespace predictor::ergonomics
