// REBA, Rapid Entire Body Assessment (Hignett & McAtamney 2000), for one arm.
//
// The tables agree cell by cell with two copies of the worksheet (tested) and with our
// recollection. The table values increase monotonically with every score (verified). Other public
// code contains invented tables. The definitions of group A were compared with a stored handbook
// chapter (verified). The thresholds of measured angles are a design choice (posture.h).
//
// The method is not suitable for judging the risk of an individual, or for choosing between designs
// with the same score.
#pragma once

#include "ergonomics/posture.h"

namespace predictor::ergonomics {

// The scores, in the order of the worksheet.
struct RebaScores {
  // A: neck, trunk, legs
  int neck = 0;       // 1 … 3
  int trunk = 0;      // 1 … 5
  int legs = 0;       // 1 … 4
  int posture_a = 0;  // table A
  int load = 0;       // 0 … 3
  int score_a = 0;    // row of table C
  // B: arm and wrist
  int upper_arm = 0;  // 1 … 6
  int lower_arm = 0;  // 1 … 2
  int wrist = 0;      // 1 … 3
  int posture_b = 0;  // table B
  int coupling = 0;   // 0 … 3
  int score_b = 0;    // column of table C
  // Result
  int score_c = 0;   // table C
  int activity = 0;  // 0 … 3
  int reba = 0;      // 1 … 15
  Action action;     // level 1 … 5
};

// Returns the scores of the posture with this arm. A person's score is the higher of the two arms'
// scores. Does not allocate.
RebaScores AssessReba(const BodyPosture& body, const ArmPosture& arm, const Exertion& exertion);

// These functions return cells of the printed tables. The arguments must be within the axes of the
// tables.
int RebaTableA(int neck, int trunk, int legs);
int RebaTableB(int upper_arm, int lower_arm, int wrist);
int RebaTableC(int score_a, int score_b);

// Returns the action for a REBA score of 1 … 15.
Action RebaAction(int reba);

}  // namespace predictor::ergonomics
