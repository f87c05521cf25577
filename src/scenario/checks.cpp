#include "scenario/checks.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "scenario/action_time.h"
#include "scenario/actions/action.h"
#include "scenario/fields.h"
#include "scenario/formulation.h"
#include "scenario/located.h"
#include "scenario/operating_rules.h"
#include "scenario/perturbation.h"

namespace predictor {
namespace {

constexpr double kMaxHandleDistance = 0.3;  // maximum distance of a handle's origin from its body
                                            // [m]

constexpr double kMaxShift = 10;            // maximum displacement of the scene [m]
constexpr double kMaxMovableDistance = 10;  // of a movable object from the origin of W [m]
constexpr double kMaxDensity = 23000;       // above that of osmium, 22 590 [kg/m³]

class Checker {
 public:
  Checker(const Scenario& scenario, const YamlNode& root, Problems* problems)
      : s_(scenario), root_(root), problems_(problems) {}

  void Object() const;
  void Environment() const;
  void Fixture(std::size_t i) const;
  void Movable(std::size_t i) const;
  void Simulation() const;
  void Handles() const;
  void Device() const;
  void Operator() const;
  void Embodied() const;
  void Script() const;
  void Limits() const;
  void Formulation() const;
  void Controller() const;
  void Events() const;
  void Perturbation() const;

 private:
  // Reports a problem if `good` is false. The message consists of the path and `sentence`: "<path>
  // is ...".
  void Unless(bool good, const std::string& path, const std::string& sentence) const {
    if (!good) problems_->Add(PlaceOf(path, root_), path + " " + sentence);
  }
  // Checks the triangle inequality: no principal moment of a body exceeds the sum of the other two.
  void Inertia(const Vector3& moments, const std::string& path) const {
    const double most = moments.maxCoeff();
    Unless(most <= moments.sum() - most + 1e-12 * most, path,
           "is [" + FormatNumber(moments.x()) + ", " + FormatNumber(moments.y()) + ", " +
               FormatNumber(moments.z()) +
               "] kg·m², which is physically impossible: the largest moment must " +
               "be at most the sum of the two others.");
  }
  // Checks that `a` is below `b`.
  void Below(double a, const std::string& path_a, double b, const std::string& path_b,
             const std::string& unit) const {
    Unless(a < b, path_a,
           "is " + FormatNumber(a) + " " + unit + "; it must be below " + path_b + ", which is " +
               FormatNumber(b) + " " + unit + ".");
  }
  void Body(const std::string& model, const std::optional<PrimitiveSpec>& primitive,
            const std::string& path) const;
  void RangeUnits(JointType joint) const;
  void Action(std::size_t i) const;
  void ActionOverlap(const std::vector<ActionSpan>& spans, std::size_t i) const;

  const Scenario& s_;
  const YamlNode& root_;
  Problems* problems_;
};

// Returns the distance of a point in O from a primitive's body [m], or 0 if the point is inside the
// body.
double DistanceFrom(const PrimitiveSpec& body, const Vector3& p) {
  if (body.shape == Shape::kSphere) return std::max(0.0, p.norm() - body.size.x());
  if (body.shape == Shape::kBox) {
    return (p.cwiseAbs() - body.size / 2).cwiseMax(0).norm();
  }
  const double radial = std::max(0.0, p.head<2>().norm() - body.size.x());
  return std::hypot(radial, std::max(0.0, std::abs(p.z()) - body.size.y() / 2));
}

double VolumeOf(const PrimitiveSpec& body) {  // [m³]
  const Vector3& size = body.size;
  if (body.shape == Shape::kBox) return size.prod();
  if (body.shape == Shape::kSphere) return 4.0 / 3 * M_PI * std::pow(size.x(), 3);
  return M_PI * size.x() * size.x() * size.y();
}

void Checker::RangeUnits(JointType joint) const {
  for (int i = 0; i < 2; ++i) {
    const std::string path = "object.attachment.range." + std::to_string(i);
    const YamlNode* node = NodeAt(path, root_);
    const bool slides = joint == JointType::kPrismatic;
    if (node == nullptr || !node->text.ends_with(slides ? " deg" : " m")) continue;
    Unless(false, path,
           "is " + Quote(node->text) +
               (slides ? ", but the joint is prismatic. Give its position in m."
                       : ", but the joint is not prismatic. Give its angle in rad or deg."));
  }
}

// Checks a body that is either a model or a primitive.
void Checker::Body(const std::string& model, const std::optional<PrimitiveSpec>& primitive,
                   const std::string& path) const {
  Unless(!model.empty() || primitive, path,
         "has neither a model nor a primitive. Give " + path + ".model, a URDF, or " + path +
             ".primitive.");
  Unless(model.empty() || !primitive, path + ".primitive",
         "is given together with " + path + ".model. Remove one of them.");
  if (!primitive) return;
  const int used = primitive->shape == Shape::kBox        ? 3
                   : primitive->shape == Shape::kCylinder ? 2
                                                          : 1;
  Unless(primitive->size.head(used).minCoeff() > 0, path + ".primitive.size",
         "has a zero among the first " + std::to_string(used) + " entries, the dimensions of a " +
             NamesOf(primitive->shape)[static_cast<std::size_t>(primitive->shape)] +
             ". The dimensions must be greater than 0.");
  Unless(primitive->size.tail(3 - used).isZero(0), path + ".primitive.size",
         "has more than the " + std::to_string(used) + (used == 1 ? " dimension" : " dimensions") +
             " of a " + NamesOf(primitive->shape)[static_cast<std::size_t>(primitive->shape)] +
             ", and the others have no effect. Write 0 in their place.");
  if (primitive->inertia) Inertia(*primitive->inertia, path + ".primitive.inertia");
}

void Checker::Object() const {
  const ObjectSpec& object = s_.object;
  Body(object.model, object.primitive, "object");
  const AttachmentSpec& joint = object.attachment;
  const bool has_axis = joint.joint == JointType::kRevolute || joint.joint == JointType::kPrismatic;
  Unless(!has_axis || joint.axis.norm() > 1e-3, "object.attachment.axis",
         "is zero. This vector must have a direction, for example [0, 0, 1].");
  if (joint.range) {
    RangeUnits(joint.joint);
    Below((*joint.range)[0], "object.attachment.range.0", (*joint.range)[1],
          "object.attachment.range.1", "");
  }
}

void Checker::Fixture(std::size_t i) const {
  const FixtureSpec& fixture = s_.environment.fixtures[i];
  const std::string path = "environment.fixtures." + std::to_string(i);
  const int used = Dimensions(fixture.shape);
  Unless(fixture.size.head(used).minCoeff() > 0, path + ".size",
         "has a zero among the first " + std::to_string(used) + " entries, the dimensions of a " +
             NameOf(fixture.shape) + ". The dimensions must be greater than 0.");
  Unless(!fixture.keep_out || fixture.touches == FixtureSpec().touches, path + ".touches",
         "has no effect on a keep-out volume, with which only the cobot collides. Remove touches, "
         "or keep_out.");
  Unless(fixture.stiffness || fixture.damping == 0, path + ".damping",
         "is given without a stiffness. Give " + path +
             ".stiffness in N/m too, or damping_ratio instead of damping.");
  for (std::size_t other = 0; other < i && !fixture.name.empty(); ++other)
    Unless(fixture.name != s_.environment.fixtures[other].name, path + ".name",
           "is " + Quote(fixture.name) + ", as that of environment.fixtures." +
               std::to_string(other) + ". Choose another name.");
}

void Checker::Movable(std::size_t i) const {
  const MovableSpec& movable = s_.environment.objects[i];
  const std::string path = "environment.objects." + std::to_string(i);
  Body(movable.model, movable.primitive, path);
  Unless(!movable.name.empty(), path + ".name", "is empty. Give the object a name.");
  for (std::size_t other = 0; other < i && !movable.name.empty(); ++other)
    Unless(movable.name != s_.environment.objects[other].name, path + ".name",
           "is " + Quote(movable.name) + ", as that of environment.objects." +
               std::to_string(other) + ". Choose another name.");
  Unless(movable.xyz.norm() <= kMaxMovableDistance, path + ".xyz",
         "is " + FormatNumber(std::round(movable.xyz.norm() * 1000) / 1000) +
             " m from the origin of W; it must be at most " + FormatNumber(kMaxMovableDistance) +
             " m. Give metres.");
  if (!movable.primitive) return;
  const double volume = VolumeOf(*movable.primitive);
  Unless(!(volume > 0) || movable.primitive->mass <= kMaxDensity * volume, path + ".primitive.mass",
         "is " + FormatNumber(movable.primitive->mass) + " kg, more than " +
             FormatNumber(std::round(kMaxDensity * volume * 1000) / 1000) +
             " kg, which the densest metal of this size would weigh. Give the mass in kg and the "
             "size in m.");
}

// Weight compensation and people rely on gravity that points down in the rig too.
void Checker::Environment() const {
  for (std::size_t i = 0; i < s_.environment.fixtures.size(); ++i) Fixture(i);
  for (std::size_t i = 0; i < s_.environment.objects.size(); ++i) Movable(i);
  if (!s_.environment.shift) return;
  const std::string path = "environment.shift.";
  const PoseSpec& shift = *s_.environment.shift;
  for (int i = 0; i < 2; ++i)
    Unless(shift.rpy[i] == 0, path + "rpy." + std::to_string(i),
           "is " + FormatNumber(shift.rpy[i]) +
               " rad, but the scene can only be turned about the vertical, because gravity points "
               "down for the arms too. Give [0, 0, yaw]. If an arm is tilted, give its base.rpy.");
  Unless(shift.xyz.norm() <= kMaxShift, path + "xyz",
         "is " + FormatNumber(shift.xyz.norm()) + " m long; it must be at most " +
             FormatNumber(kMaxShift) + " m. Give metres.");
}

// The engine DART allocates memory in each step, and each step waits for another process.
void Checker::Simulation() const {
  Unless(s_.simulation.engine == EngineKind::kMujoco || !RulesFor(s_).needs_person,
         "simulation.engine",
         "is dart, but the arms are real. DART is not fast enough for real arms, because its steps "
         "allocate memory and wait for another process. Set simulation.engine: mujoco.");
  Unless(s_.simulation.engine == EngineKind::kMujoco || s_.environment.objects.empty(),
         "simulation.engine",
         "is dart, whose world has no movable objects. Set simulation.engine: mujoco, or remove "
         "environment.objects.");
}

void Checker::Handles() const {
  Unless(s_.left_handle || s_.right_handle, "handles",
         "is empty. Give handles.left, handles.right or both.");
  for (int hand = 0; hand < kHands; ++hand) {
    const std::string path = std::string("handles.") + HandName(hand);
    if (!s_.Has(hand)) continue;
    const std::string& link = s_.handle(hand).link;
    Unless(link.empty() || !s_.object.model.empty(), path + ".link",
           "is " + Quote(link) + ", but object.model is empty, and a primitive has no links. " +
               "Remove this key.");
    if (!s_.object.primitive) continue;
    const double distance = DistanceFrom(*s_.object.primitive, s_.handle(hand).pose.xyz);
    Unless(distance <= kMaxHandleDistance, path + ".xyz",
           "is " + FormatNumber(distance) +
               " m away from the object. A handle must be on the object, at " + "most " +
               FormatNumber(kMaxHandleDistance) + " m from its surface.");
  }
}

void Checker::Device() const {
  const double max_speed = RulesFor(s_).max_handle_speed;
  Unless(s_.safety.handle_speed <= max_speed, "safety.handle_speed",
         "is " + FormatNumber(s_.safety.handle_speed) + " m/s; with real arms it must be at most " +
             FormatNumber(max_speed) + " m/s.");
  for (int hand = 0; hand < kHands; ++hand) {
    const std::string name = HandName(hand);
    const std::string arm = DeviceArmKey(hand), handle = "handles." + name;
    const std::optional<ArmSpec>& spec = hand == 0 ? s_.device.left : s_.device.right;
    if (spec) Inertia(spec->payload.inertia, arm + ".payload.inertia");
    if (s_.mode == Mode::kDirect) continue;  // this mode needs no arms
    Unless(spec || !s_.Has(hand), arm,
           "is missing, but " + handle + " needs an arm. Add the arm, remove the handle, or set " +
               "mode: direct.");
    Unless(!spec || s_.Has(hand), arm, "has no handle. Add " + handle + ", or remove the arm.");
  }
  const auto& [type, left, right] = s_.device;
  const bool has_pairs = !s_.rendering.link_pairs.empty() || !left || !right;
  for (const auto& [key, spec] :
       {std::pair{"device.arms.left.elbow", &left}, std::pair{"device.arms.right.elbow", &right}})
    Unless(has_pairs || !(*spec)->elbow.empty(), key,
           "is missing. Give the link that must keep its distance from the other arm's elbow, or "
           "give rendering.link_pairs.");
}

void Checker::Operator() const {
  Unless(s_.duration > 0 || s_.operator_.type == "browser", "duration",
         "is 0, which means that only a person at the page can end the run. Give the length in "
         "seconds, or set operator.type: browser.");
  const bool needs_person = RulesFor(s_).needs_person;
  const bool is_person = s_.operator_.type == "person";
  Unless(!needs_person || is_person, "operator.type",
         "is " + s_.operator_.type + ", but the arms are real (device.type is " +
             Quote(s_.device.type) +
             ", set by the scenario or by --machine), so a person must hold them. Set " +
             "operator.type: person, or add --set operator.type=person.");
  Unless(needs_person || !is_person, "operator.type",
         "is person, but there are no real arms to hold. Set operator.type: virtual or browser, " +
             std::string("or give the arms with --machine FILE."));
  Embodied();
}

// An embodied operator needs a body, which replaces some parameters of the hand.
void Checker::Embodied() const {
  const OperatorSpec& person = s_.operator_;
  if (!person.embodied) return;
  Unless(person.type == "virtual", "operator.embodied",
         "is true, but operator.type is " + person.type +
             ". Only the virtual operator is simulated on a body. Remove operator.embodied.");
  Unless(person.body && person.stance, "operator.embodied",
         "is true, but the operator's body or its place is not known. Add operator.body: {height, "
         "mass, sex} and operator.stance: {ground, facing}.");
  Unless(person.hand.stiffness == HandSpec().stiffness, "operator.hand.stiffness",
         "has no effect, because operator.embodied is true: the stiffness follows from the "
         "posture. Remove this key, or change operator.body.stiffness.");
}

void Checker::Script() const {
  const std::vector<ActionSpan> spans = SpansOf(s_.operator_.script);
  for (std::size_t i = 0; i < s_.operator_.script.size(); ++i) {
    Action(i);
    ActionOverlap(spans, i);
  }
}

// Checks one entry: its hand must exist, and its action must accept its parameters.
void Checker::Action(std::size_t i) const {
  const ActionSpec& entry = s_.operator_.script[i];
  if (!FindAction(entry.action)) return;  // already refused while reading
  const YamlNode* hand = entry.parameters.Find("hand");
  const std::string which = hand ? hand->text : "both";
  const bool is_absent =
      (which == "left" && !s_.left_handle) || (which == "right" && !s_.right_handle);
  Unless(!is_absent, "operator.script." + std::to_string(i) + ".hand",
         "is " + which + ", but the scenario has no handles." + which +
             ". Give the other hand or both.");
  try {
    MakeAction(entry, static_cast<int>(i));
  } catch (const InputError& error) {
    problems_->Add(PlaceOf(error.key(), root_), error.what());
  }
}

// The entries of a script must be in chronological order. Two entries that move the object must not
// overlap. Two entries that rotate it must not overlap either. A push, a grip or a release may
// occur at any time.
void Checker::ActionOverlap(const std::vector<ActionSpan>& spans, std::size_t i) const {
  const auto& script = s_.operator_.script;
  const std::string path = "operator.script." + std::to_string(i);
  const auto motion = [](const ActionSpec& a) {
    const ActionKind* kind = FindAction(a.action);
    return kind ? kind->motion : ActionMotion::kNone;
  };
  for (std::size_t j = 0; j < i; ++j) {
    const bool exclude =
        motion(script[i]) != ActionMotion::kNone && motion(script[i]) == motion(script[j]);
    const std::string other = "operator.script." + std::to_string(j);
    const std::string start = "is " + FormatNumber(script[i].start) + " s, before " + other;
    if (j + 1 == i && script[i].start < script[j].start) {
      return Unless(false, path + ".start",
                    start + " starts. Write the script in chronological order.");
    }
    if (exclude && script[i].start < spans[j].end - 1e-9) {
      return Unless(false, path + ".start",
                    start + " ends at " + FormatNumber(spans[j].end) +
                        " s. Start this action later, or shorten the other action.");
    }
  }
}

void Checker::Limits() const {
  const RenderingSpec& rendering = s_.rendering;
  Below(rendering.joint_security, "rendering.joint_security", rendering.joint_influence,
        "rendering.joint_influence", "rad");
  Below(rendering.security_distance, "rendering.security_distance", rendering.influence_distance,
        "rendering.influence_distance", "m");
  const OscillationSpec& oscillation = s_.safety.oscillation;
  Below(oscillation.low, "safety.oscillation.low", oscillation.high, "safety.oscillation.high",
        "Hz");
  Below(oscillation.high, "safety.oscillation.high", s_.rate / 2, "half of rate", "Hz");
}

// Values that the selected formulation does not use must be zero or have their defaults.
void Checker::Formulation() const {
  const RepairSet repairs = RepairsOf(s_.rendering);
  const auto unused = [&](Repair repair, const std::string& path, double value, double standard) {
    const RepairEntry& entry = RepairTable()[static_cast<std::size_t>(repair)];
    Unless(repairs.Has(repair) || value == 0 || value == standard, path,
           "has no effect, because the selected formulation has no " + std::string(entry.name) +
               ". Remove this key, or change rendering.formulation_except.");
  };
  unused(Repair::kLead, "rendering.lead", s_.rendering.lead.value_or(0), 0);
  const CouplingSpec& given = s_.coupling;
  const CouplingSpec standard;
  const auto coupling = [&](const char* key, double CouplingSpec::*value) {
    unused(Repair::kCoupling, std::string("coupling.") + key, given.*value, standard.*value);
  };
  coupling("stiffness", &CouplingSpec::stiffness);
  coupling("damping", &CouplingSpec::damping);
  coupling("rotation_stiffness", &CouplingSpec::rotation_stiffness);
  coupling("rotation_damping", &CouplingSpec::rotation_damping);
  coupling("speed_damping", &CouplingSpec::speed_damping);
  Unless(repairs.HasAll() || !RulesFor(s_).needs_repairs, "rendering.formulation",
         "lacks repairs that protect a person. With real arms, rendering.formulation must be "
         "repaired, without formulation_except.");
}

// A recording contains a controller's torque only once per tick.
void Checker::Controller() const {
  const ParameterKind* kind = FindKind(Controllers(), s_.cobot.controller.type);
  if (kind == nullptr || kind->place == ControllerPlace::kProgram) return;
  Unless(s_.rate == 1000, "rate",
         "is " + FormatNumber(s_.rate) + " Hz, but cobot.controller.type " + Quote(kind->name) +
             " needs 1000 Hz. Set rate: 1000; cobot.control.rate may be lower.");
}

// A run stops at safety.force, so an event that waits for a larger force never begins.
void Checker::Events() const {
  for (std::size_t i = 0; i < s_.events.size(); ++i)
    if (const std::optional<double>& force = s_.events[i].trigger.force)
      Unless(*force < s_.safety.force, "events." + std::to_string(i) + ".trigger.force",
             "is " + FormatNumber(*force) + " N, but a run stops at safety.force, " +
                 FormatNumber(s_.safety.force) + " N, so the event would never begin. Reduce it.");
}

// The force that a displacement exerts on a person is predicted from the scenario's model of the
// hand. The model may be wrong, so the run also measures this force.
void Checker::Perturbation() const {
  if (!s_.perturbation) return;
  const PerturbationSpec& p = *s_.perturbation;
  Unless(p.consent, "perturbation.consent",
         "is false. Tell the person that the handles will move by a few millimetres and ask "
         "whether this is acceptable. Then set this key to true, or set perturbation: null.");
  Unless(
      s_.mode == Mode::kEmulate, "perturbation",
      "displaces the handles of haptic arms, but mode: direct has none. Set perturbation: null.");
  Unless(p.normal.norm() > 1e-3, "perturbation.normal",
         "is zero. This vector must have a direction, for example [0, 0, 1].");
  Below(p.speed, "perturbation.speed", s_.safety.handle_speed, "safety.handle_speed", "m/s");
  const double force = PerturbationForce(p, s_.operator_.hand);
  Unless(force <= p.force, "perturbation.amplitude",
         "is " + FormatNumber(p.amplitude) + " m. The scenario's hand would resist with up to " +
             FormatNumber(force) + " N, more than perturbation.force, " + FormatNumber(p.force) +
             " N. Reduce this force, or increase perturbation.ramp.");
}

}  // namespace

void CheckScenario(const Scenario& scenario, const YamlNode& root, Problems* problems) {
  const Checker checker(scenario, root, problems);
  checker.Object();
  checker.Environment();
  checker.Simulation();
  checker.Handles();
  checker.Device();
  checker.Operator();
  checker.Script();
  checker.Limits();
  checker.Formulation();
  checker.Controller();
  checker.Events();
  checker.Perturbation();
}

}  // namespace predictor
