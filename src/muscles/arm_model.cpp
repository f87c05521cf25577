#include "muscles/arm_model.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

#include "core/sex.h"
#include "muscles/wrap.h"

namespace predictor::muscles {
namespace {

using person::ArmJoint;
using person::Of;

constexpr double kMetre = 1e-3;  // the table is in millimetres
constexpr double kReferenceMass = 75, kReferenceHeight = 1.75, kWomen = 0.7;

constexpr int LevelOf(Part part) {
  switch (part) {
    case Part::kUpperArm:
      return static_cast<int>(ArmJoint::kShoulderRotation);
    case Part::kUlna:
      return static_cast<int>(ArmJoint::kElbowFlexion);
    case Part::kRadius:
      return static_cast<int>(ArmJoint::kPronation);
    case Part::kHand:
      return static_cast<int>(ArmJoint::kWristDeviation);
    default:
      return -1;
  }
}

// The positions and axes of the joints of an arm, in the axes of a torso that stands upright.
struct ArmPlacement {
  std::array<Vector3, person::kArmJoints> p, axis;
  std::array<Matrix3, person::kArmJoints> R;
  Vector3 torso;
};

ArmPlacement PlaceArm(const person::BodyModel& body, int hand, const ArmVector& q) {
  person::BodyVector all = person::BodyVector::Zero();
  const int first = Of(hand, ArmJoint::kShoulderFlexion);
  all.segment<person::kArmJoints>(first) = q;
  const person::Placement at = person::Place(body, all);
  ArmPlacement arm;
  for (int i = 0; i < person::kArmJoints; ++i) {
    const auto from = static_cast<std::size_t>(first + i), to = static_cast<std::size_t>(i);
    arm.p[to] = at.p[from];
    arm.axis[to] = at.axis[from];
    arm.R[to] = at.R[from];
  }
  arm.torso = at.p[person::kTorsoTwist];
  return arm;
}

struct Point {
  Vector3 p;
  int level;
};

// Adds the length of the straight line between two points to `length`. Adds -∂l/∂q to the moment
// arms of the joints that move only one of these points.
void AddStraight(const ArmPlacement& arm, const Point& from, const Point& to, double* length,
                 ArmVector* moment_arm) {
  const Vector3 way = to.p - from.p;
  const double distance = way.norm();
  *length += distance;
  if (distance == 0 || from.level == to.level) return;
  const bool outward = to.level > from.level;
  const Point& moving = outward ? to : from;
  const Vector3 pull = (outward ? -1 : 1) / distance * way;
  for (int k = std::min(from.level, to.level) + 1; k <= moving.level; ++k) {
    const auto i = static_cast<std::size_t>(k);
    (*moment_arm)[k] += pull.dot(arm.axis[i].cross(moving.p - arm.p[i]));
  }
}

// Returns the contact with the obstacle between two points, and the joint level of the obstacle.
std::optional<Contact> ContactOf(const ArmPlacement& arm, Wrap wrap, double radius,
                                 const Vector3& from, const Vector3& to, int* level) {
  constexpr auto kRotation = static_cast<std::size_t>(ArmJoint::kShoulderRotation);
  constexpr auto kElbow = static_cast<std::size_t>(ArmJoint::kElbowFlexion);
  constexpr auto kTurn = static_cast<std::size_t>(ArmJoint::kPronation);
  *level = LevelOf(wrap >= Wrap::kForearmOuter ? Part::kRadius : Part::kUpperArm);
  switch (wrap) {
    case Wrap::kHead:
      return AroundBall(from, to, arm.p[0], radius);
    case Wrap::kHeadOuter:
      return AroundCylinder(from, to, arm.p[kRotation], arm.axis[kRotation], radius);
    case Wrap::kHeadInner:
      return AroundCylinder(from, to, arm.p[kRotation], -arm.axis[kRotation], radius);
    case Wrap::kElbowFront:
      return AroundCylinder(from, to, arm.p[kElbow], -arm.axis[kElbow], radius);
    case Wrap::kElbowBack:
      return AroundCylinder(from, to, arm.p[kElbow], arm.axis[kElbow], radius);
    case Wrap::kForearmOuter:
      return AroundCylinder(from, to, arm.p[kTurn], arm.axis[kTurn], radius);
    case Wrap::kForearmInner:
      return AroundCylinder(from, to, arm.p[kTurn], -arm.axis[kTurn], radius);
    default:
      return {};
  }
}

// Returns the strength of a group of the person's muscles, as a multiple of the mean. If no
// multiple is given for the group, the mean of the person's other multiples is used (D).
double StrengthOf(const BodySpec& spec, MuscleGroup group) {
  const auto& given = spec.strength;
  switch (group) {
    case MuscleGroup::kElbowFlexors:
      return given[0];
    case MuscleGroup::kElbowExtensors:
      return given[1];
    case MuscleGroup::kShoulderFlexors:
      return given[2];
    case MuscleGroup::kShoulderExtensors:
      return given[3];
    default:
      return (given[0] + given[1] + given[2] + given[3]) / 4;
  }
}

// Returns, for each joint, the end of its working range that bit i of `corner` selects (D).
ArmVector WorkingCorner(int corner) {
  constexpr double kRange[person::kArmJoints][2] = {{0, 90},   {0, 60},   {-30, 45}, {0, 130},
                                                    {-70, 70}, {-45, 45}, {-15, 25}};
  ArmVector q;
  for (int i = 0; i < person::kArmJoints; ++i)
    q[i] = kRange[i][corner >> i & 1] * std::numbers::pi / 180;
  return q;
}

}  // namespace

ArmModel::ArmModel(const BodySpec& spec, int hand, std::shared_ptr<const ArmPaths> paths)
    : body_(spec),
      hand_(hand),
      paths_(std::move(paths)),
      scale_(body_.anthropometry().upper_arm.length / kTableUpperArm) {
  const double strength = spec.mass * spec.height / (kReferenceMass * kReferenceHeight) / scale_ *
                          (spec.sex == Sex::kFemale ? kWomen : 1);
  for (int i = 0; i < kMuscles; ++i) {
    const MuscleSpec& table = MuscleTable()[static_cast<std::size_t>(i)];
    MuscleParameters& muscle = muscles_[static_cast<std::size_t>(i)];
    if (paths_) {
      muscle = paths_->muscle(i);
      muscle.tendon_slack *= scale_;
    } else {
      muscle = {.max_force = table.max_force,
                .fibre_length = kMetre * table.fibre_length,
                .pennation = table.pennation * std::numbers::pi / 180};
      PlaceMuscle(i);
    }
    muscle.max_force *= strength * StrengthOf(spec, table.group);
    muscle.fibre_length *= scale_;
  }
  if (!paths_) SetTendons();
}

void ArmModel::PlaceMuscle(int i) {
  const person::Anthropometry& a = body_.anthropometry();
  const double upper = kMetre * a.upper_arm.length / kTableUpperArm;
  const double fore = kMetre * a.forearm.length / kTableForearm;
  const double hand = kMetre * a.hand.length / kTableHand;
  const double mirror = hand_ == 0 ? -1 : 1;  // the table describes a right arm
  Line& line = lines_[static_cast<std::size_t>(i)];
  for (const PathPoint& point : MuscleTable()[static_cast<std::size_t>(i)].path) {
    if (point.part == Part::kNone) break;
    Node& node = line.nodes[static_cast<std::size_t>(line.count++)];
    node.level = LevelOf(point.part);
    const bool at_forearm = point.part == Part::kUlna || point.part == Part::kRadius;
    const double scale = at_forearm ? fore : point.part == Part::kHand ? hand : upper;
    node.p = scale * Vector3(point.x, mirror * point.y, point.z);
    // The frame of the pronation is at the wrist.
    if (point.part == Part::kRadius) node.p.z() += a.forearm.length;
    if (point.part == Part::kTorso)
      node.p += body_.joint(Of(hand_, ArmJoint::kShoulderFlexion)).offset;
    node.wrap = point.wrap;
    node.radius = point.radius * (point.wrap >= Wrap::kForearmOuter ? fore : upper);
  }
}

void ArmModel::SetTendons() {
  MuscleVector longest = MuscleVector::Zero();
  for (int corner = 0; corner < 1 << person::kArmJoints; ++corner)
    longest = longest.cwiseMax(LinesAt(WorkingCorner(corner)).length);
  for (int i = 0; i < kMuscles; ++i) {
    MuscleParameters& muscle = muscles_[static_cast<std::size_t>(i)];
    const double thickness = muscle.fibre_length * std::sin(muscle.pennation);
    const double fibre = kLongestFibre * muscle.fibre_length;
    muscle.tendon_slack =
        std::max(0.0, longest[i] - std::sqrt(fibre * fibre - thickness * thickness));
  }
}

MuscleLines ArmModel::LinesAt(const ArmVector& q) const noexcept {
  if (!paths_) return OwnLinesAt(q);
  MuscleLines lines = paths_->LinesAt(q);
  lines.length *= scale_;
  lines.moment_arm *= scale_;
  return lines;
}

MuscleLines ArmModel::OwnLinesAt(const ArmVector& q) const noexcept {
  const ArmPlacement arm = PlaceArm(body_, hand_, q);
  const auto place = [&](const Node& node) -> Point {
    if (node.level < 0) return {arm.torso + node.p, -1};
    const auto i = static_cast<std::size_t>(node.level);
    return {arm.p[i] + arm.R[i] * node.p, node.level};
  };
  MuscleLines lines;
  for (int m = 0; m < kMuscles; ++m) {
    const Line& line = lines_[static_cast<std::size_t>(m)];
    double length = 0;
    ArmVector moment_arm = ArmVector::Zero();
    Point from = place(line.nodes[0]);
    for (int n = 1; n < line.count; ++n) {
      const Node& node = line.nodes[static_cast<std::size_t>(n)];
      const Point to = place(node);
      int level = 0;
      if (const auto contact = ContactOf(arm, node.wrap, node.radius, from.p, to.p, &level)) {
        // The path is the shortest one, so its length does not change to first order when the ends
        // of the contact slide. The ends of the contact are treated as points that are fixed to the
        // obstacle.
        AddStraight(arm, from, {contact->begin, level}, &length, &moment_arm);
        length += contact->length;
        from = {contact->end, level};
      }
      AddStraight(arm, from, to, &length, &moment_arm);
      from = to;
    }
    lines.length[m] = length;
    lines.moment_arm.col(m) = moment_arm;
  }
  return lines;
}

MuscleForces ArmModel::ForcesAt(const MuscleLines& lines, const ArmVector& v) const noexcept {
  MuscleForces forces;
  const MuscleVector rate = -(lines.moment_arm.transpose() * v);
  for (int i = 0; i < kMuscles; ++i) {
    const Fibre fibre = FibreOf(muscle(i), lines.length[i], rate[i]);
    const TendonForces of = ForcesOf(muscle(i), fibre);
    forces.active[i] = of.active;
    forces.passive[i] = of.passive;
    forces.fibre_length[i] = fibre.length;
  }
  return forces;
}

}  // namespace predictor::muscles
