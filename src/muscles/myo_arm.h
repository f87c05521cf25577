// Reads MyoArm, an arm model in MuJoCo's format with a moving shoulder girdle, as an alternative to
// the built-in paths and strengths of the muscles.
//
// MyoArm (package myo-sim 0.2.4, Apache-2.0) is not part of this program. Its clavicle and scapula
// follow the elevation of the upper arm through equality constraints, q_dep = polynomial(q_indep).
// A muscle that originates at the scapula therefore changes its length in two ways when the
// shoulder turns, and its moment arm is the sum of both:
//     R = R_indep + Σ R_dep ∂q_dep/∂q_indep
#pragma once

#include <filesystem>
#include <memory>

#include "muscles/arm_model.h"

namespace predictor::muscles {

// `model` is either the folder with MyoArm's parts, which is myo_sim/models of the package, or a
// single MJCF file that contains the whole arm. In this file, the names may end with _r. The shapes
// of the bones are not loaded.
//
// The joints of the two models correspond in the following way. At the shoulder, the upper arm has
// the same orientation relative to the torso in both models. MyoArm describes this orientation by
// three angles: the plane of elevation, the elevation and the rotation. If the upper arm hangs
// vertically, the shoulder girdle is assumed not to move. Elbow, pronation and wrist have the same
// angles in both models, except that the wrist's deviation has the opposite sign. Fingers and thumb
// are in the middle of their ranges, because the hand holds a bar (D).
//
// Each of our muscles consists of one or several muscles of MyoArm. The forces of these muscles of
// MyoArm are added, and their lengths are averaged with the forces as weights. Palmaris longus and
// the muscles of thumb and palm are left out (D). Optimal fibre length and tendon length follow
// from the operating range of MuJoCo's muscle: l0 = Δlengthrange/Δrange, slack = lengthrange[0] -
// range[0] l0.
//
// In myo-sim 0.2.4, a point of the middle deltoid is on the inner side of the upper arm. It is
// moved to the outer side, where the source of MyoArm has it.
//
// Throws InputError if the model cannot be read or lacks a joint, a muscle or its tendon.
std::shared_ptr<const ArmPaths> LoadMyoArm(const std::filesystem::path& model);

}  // namespace predictor::muscles
