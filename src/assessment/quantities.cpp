#include "assessment/quantities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "assessment/joint_quantities.h"
#include "core/person_state.h"

namespace predictor::assessment {
namespace {

constexpr Unit kDegree = {"rad", "°", kDegrees, 0};
constexpr Unit kForce = {"N", "N", 1, 1};
constexpr Unit kCompression = {"N", "N", 1, 0};
constexpr Unit kMoment = {"N·m", "N·m", 1, 1};
constexpr Unit kCentimetre = {"m", "cm", 100, 1};
constexpr Unit kPercent = {"", "%", 100, 0};

template <int Hand>
double Force(const Moment& m) {
  return m.sample.body.hands[Hand].present ? m.sample.body.hands[Hand].F_D_W.head<3>().norm() : 0;
}
template <int Hand>
double Elevation(const Moment& m) {
  return m.frame.angles.arms[Hand].upper_arm_elevation;
}
template <int Hand>
double Elbow(const Moment& m) {
  return m.frame.angles.arms[Hand].elbow_flexion;
}
template <int Hand>
double Wrist(const Moment& m) {
  return std::abs(m.frame.angles.arms[Hand].wrist_flexion);
}
template <int Hand>
double Abduction(const Moment& m) {
  return m.frame.angles.arms[Hand].upper_arm_abduction;
}
template <int Hand>
double ShoulderUse(const Moment& m) {
  return m.frame.shoulder_use[Hand];
}
template <int Hand>
double ElbowUse(const Moment& m) {
  return m.frame.elbow_use[Hand];
}

constexpr const char* kHandsGroup = "Hands";
constexpr const char* kBack = "Lower back (L5/S1)";
constexpr const char* kStrength = "Share of mean strength";
constexpr const char* kTrunk = "Trunk and neck";
constexpr const char* kArms = "Arms";

constexpr QuantityKind kQuantities[] = {
    {"hands.left.force_n", kHandsGroup, "left force", kForce, Origin::kMeasured, Force<0>, 0, "",
     0},
    {"hands.right.force_n", kHandsGroup, "right force", kForce, Origin::kMeasured, Force<1>, 0, "",
     1},
    {"lower_back.compression_n", kBack, "compression", kCompression, Origin::kModelled,
     [](const Moment& m) { return m.frame.loads.l5s1.compression; }, kCompressionLimit,
     kCompressionLimitName},
    {"lower_back.shear_n", kBack, "shear", kCompression, Origin::kModelled,
     [](const Moment& m) { return m.frame.loads.l5s1.shear; }, kShearLimit, kShearLimitName},
    {"lower_back.flexion_moment_nm", kBack, "extensor moment", kMoment, Origin::kModelled,
     [](const Moment& m) { return m.frame.loads.l5s1.flexion_moment; }},
    {"lower_back.moment_by_hands_nm", kBack, "moment caused by the hands", kMoment,
     Origin::kModelled, [](const Moment& m) { return LiftMoment(m.frame); }},
    {"strength.left_shoulder", kStrength, "left shoulder flexion", kPercent, Origin::kModelled,
     ShoulderUse<0>, 0, "", 0},
    {"strength.right_shoulder", kStrength, "right shoulder flexion", kPercent, Origin::kModelled,
     ShoulderUse<1>, 0, "", 1},
    {"strength.left_elbow", kStrength, "left elbow", kPercent, Origin::kModelled, ElbowUse<0>, 0,
     "", 0},
    {"strength.right_elbow", kStrength, "right elbow", kPercent, Origin::kModelled, ElbowUse<1>, 0,
     "", 1},
    {"trunk.flexion_rad", kTrunk, "trunk flexion", kDegree, Origin::kModelled,
     [](const Moment& m) { return m.frame.angles.trunk_flexion; }},
    {"trunk.side_bend_rad", kTrunk, "trunk side bend", kDegree, Origin::kModelled,
     [](const Moment& m) { return std::abs(m.frame.angles.trunk_side_bend); }},
    {"trunk.twist_rad", kTrunk, "trunk twist", kDegree, Origin::kModelled,
     [](const Moment& m) { return std::abs(m.frame.angles.trunk_twist); }},
    {"neck.flexion_rad", kTrunk, "neck flexion", kDegree, Origin::kModelled,
     [](const Moment& m) { return m.frame.angles.neck_flexion; }},
    {"legs.knee_flexion_rad", "Legs", "larger knee flexion", kDegree, Origin::kModelled,
     [](const Moment& m) {
       return std::max(m.frame.angles.knee_flexion[0], m.frame.angles.knee_flexion[1]);
     }},
    {"arms.left.elevation_rad", kArms, "left upper arm elevation", kDegree, Origin::kModelled,
     Elevation<0>, 0, "", 0},
    {"arms.right.elevation_rad", kArms, "right upper arm elevation", kDegree, Origin::kModelled,
     Elevation<1>, 0, "", 1},
    {"arms.left.abduction_rad", kArms, "left upper arm abduction", kDegree, Origin::kModelled,
     Abduction<0>, 0, "", 0},
    {"arms.right.abduction_rad", kArms, "right upper arm abduction", kDegree, Origin::kModelled,
     Abduction<1>, 0, "", 1},
    {"arms.left.elbow_flexion_rad", kArms, "left elbow flexion", kDegree, Origin::kModelled,
     Elbow<0>, 0, "", 0},
    {"arms.right.elbow_flexion_rad", kArms, "right elbow flexion", kDegree, Origin::kModelled,
     Elbow<1>, 0, "", 1},
    {"arms.left.wrist_flexion_rad", kArms, "left wrist bend", kDegree, Origin::kModelled, Wrist<0>,
     0, "", 0},
    {"arms.right.wrist_flexion_rad", kArms, "right wrist bend", kDegree, Origin::kModelled,
     Wrist<1>, 0, "", 1},
    {"balance.margin_m", "Balance", "pressure to edge of feet", kCentimetre, Origin::kModelled,
     [](const Moment& m) { return m.frame.loads.balance.margin; }, 0, "", -1, Bad::kLow},
};

constexpr WorksheetKind kWorksheets[] = {
    {"RULA", 7, [](const Frame& f) { return f.rula.grand; }, ergonomics::RulaAction},
    {"REBA", 15, [](const Frame& f) { return f.reba.reba; }, ergonomics::RebaAction},
    {"OWAS", 4, [](const Frame& f) { return f.owas.category; }, ergonomics::OwasAction},
};

}  // namespace

const char* Name(Origin origin) {
  constexpr const char* kNames[] = {"measured", "modelled", "standard"};
  return kNames[static_cast<std::size_t>(origin)];
}

const char* Name(Origin origin, bool simulated) {
  return simulated && origin == Origin::kMeasured ? "simulated sensor" : Name(origin);
}

std::span<const QuantityKind> Quantities() {
  static const std::vector<QuantityKind> kAll = [] {
    std::vector<QuantityKind> all(std::begin(kQuantities), std::end(kQuantities));
    for (const auto& more : {JointQuantities(), MuscleQuantities()})
      all.insert(all.end(), more.begin(), more.end());
    return all;
  }();
  return kAll;
}
std::span<const WorksheetKind> Worksheets() { return kWorksheets; }

}  // namespace predictor::assessment
