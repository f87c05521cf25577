#include "assessment/joint_quantities.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "assessment/output.h"

namespace predictor::assessment {
namespace {

using person::ArmJoint;

constexpr Unit kTorqueUnit = {"N·m", "N·m", 1, 1};
constexpr Unit kStiffnessUnit = {"N·m/rad", "N·m/rad", 1, 0};
constexpr Unit kShareUnit = {"", "%", 100, 1};

// Names of a joint in paths and tables, in the order of person::ArmJoint.
struct JointNames {
  const char *path, *label;
};
constexpr JointNames kJoints[person::kArmJoints] = {
    {"shoulder_flexion", "shoulder flexion"},   {"shoulder_abduction", "shoulder abduction"},
    {"shoulder_rotation", "shoulder rotation"}, {"elbow_flexion", "elbow flexion"},
    {"forearm_pronation", "forearm pronation"}, {"wrist_flexion", "wrist flexion"},
    {"wrist_deviation", "wrist deviation"},
};

// Keeps a text for the whole program, because QuantityKind contains pointers to texts. Quantities()
// builds its table only once, so the number of texts does not grow.
const char* Kept(std::string text) {
  static std::deque<std::string> texts;
  return texts.emplace_back(std::move(text)).c_str();
}

template <int Hand, int Joint>
double Torque(const Moment& m) {
  return std::abs(TorqueOf(m.frame, Hand, static_cast<ArmJoint>(Joint)));
}
template <int Hand, int Joint>
double Overload(const Moment& m) {
  return std::abs(OverloadOf(m.frame, Hand, static_cast<ArmJoint>(Joint)));
}
template <int Hand, int Joint>
double Stiffness(const Moment& m) {
  return m.frame.muscles[Hand].joint_stiffness[Joint];
}
template <int Hand>
double ShoulderCapable(const Moment& m) {
  return m.frame.shoulder_capable[Hand];
}
template <int Hand>
double ElbowCapable(const Moment& m) {
  return m.frame.elbow_capable[Hand];
}

struct JointColumn {
  const char *path, *group;
  Unit unit;
  Bad bad = Bad::kHigh;
  bool nominal_only = false;
};
constexpr JointColumn kTorqueColumn = {"torque_nm", kJointTorques, kTorqueUnit};
constexpr JointColumn kOverloadColumn = {"torque_by_hands_nm", "Part caused by the hands",
                                         kTorqueUnit};
constexpr JointColumn kCapableColumn = {"people_strong_enough", "People strong enough", kShareUnit,
                                        Bad::kLow};
constexpr JointColumn kStiffnessColumn = {"stiffness_nm_per_rad", "Joint stiffness", kStiffnessUnit,
                                          Bad::kLow, true};

QuantityKind JointKindOf(int hand, int joint, const JointColumn& column,
                         double (*of)(const Moment&)) {
  const JointNames& names = kJoints[joint];
  const std::string side = hand == 0 ? "left" : "right";
  QuantityKind kind = {Kept("joints." + side + "." + names.path + "." + column.path),
                       column.group,
                       Kept(side + " " + names.label),
                       column.unit,
                       Origin::kModelled,
                       of};
  kind.hand = hand;
  kind.bad = column.bad;
  kind.nominal_only = column.nominal_only;
  kind.of_joint = true;
  return kind;
}

// The values of left and right arm follow each other, so that a plot shows both in one panel.
template <int... Joints>
std::vector<QuantityKind> AllOf(std::integer_sequence<int, Joints...>) {
  constexpr int kShoulder = static_cast<int>(ArmJoint::kShoulderFlexion);
  constexpr int kElbow = static_cast<int>(ArmJoint::kElbowFlexion);
  std::vector<QuantityKind> kinds;
  const auto add = [&](int joint, const JointColumn& column, double (*left)(const Moment&),
                       double (*right)(const Moment&)) {
    kinds.push_back(JointKindOf(0, joint, column, left));
    kinds.push_back(JointKindOf(1, joint, column, right));
  };
  (add(Joints, kTorqueColumn, Torque<0, Joints>, Torque<1, Joints>), ...);
  (add(Joints, kOverloadColumn, Overload<0, Joints>, Overload<1, Joints>), ...);
  add(kShoulder, kCapableColumn, ShoulderCapable<0>, ShoulderCapable<1>);
  add(kElbow, kCapableColumn, ElbowCapable<0>, ElbowCapable<1>);
  (add(Joints, kStiffnessColumn, Stiffness<0, Joints>, Stiffness<1, Joints>), ...);
  return kinds;
}

std::string JointCell(const QuantityResult& q) {
  std::string cell = ValueText(*q.kind, q.tail());
  if (q.tail_interval) cell += " (" + RangeText(*q.kind, q.tail_interval) + ")";
  return cell;
}

}  // namespace

std::vector<QuantityKind> JointQuantities() {
  return AllOf(std::make_integer_sequence<int, person::kArmJoints>());
}

std::vector<std::vector<std::string>> JointTable(const Assessment& a) {
  std::vector<std::vector<std::string>> rows = {{"Joint"}};
  std::string group;
  for (const QuantityResult& q : a.quantities) {
    if (!q.kind->of_joint) continue;
    if (group != q.kind->group) {
      group = q.kind->group;
      rows[0].push_back(WithUnit(group, q.kind->unit));
    }
    auto row = std::ranges::find(rows, q.kind->label, [](const auto& cells) { return cells[0]; });
    if (row == rows.end()) row = rows.insert(row, {q.kind->label});
    row->resize(rows[0].size() - 1, "–");
    row->push_back(JointCell(q));
  }
  for (auto& row : rows) row.resize(rows[0].size(), "–");
  return rows;
}

std::string JointTableWords() {
  return "Torques: magnitudes that are exceeded for 5 % of the time. Share of people and "
         "stiffness: values that are exceeded for 95 % of the time. In parentheses: 90 % intervals "
         "over 64 possible postures and bodies. The strengths are means of people of the "
         "operator's sex, and are recalled, not verified.";
}

}  // namespace predictor::assessment
