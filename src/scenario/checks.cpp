#include "scenario/checks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "scenario/action_time.h"
#include "scenario/fields.h"

namespace predictor {
namespace {

constexpr double kMostRealHandleSpeed = 0.5;  // of a scenario for real arms [m/s]
constexpr double kMostHandleDistance = 0.3;   // of a handle's origin from the body it is on [m]

class Checker {
 public:
  Checker(const Scenario& scenario, const YamlNode& root, Problems* problems)
      : s_(scenario), root_(root), problems_(problems) {}

  void Object() const;
  void Handles() const;
  void Device() const;
  void Operator() const;
  void Script() const;
  void Trajectory() const;
  void Limits() const;

 private:
  // `sentence` follows the path: "<path> is ...".
  void Unless(bool good, const std::string& path, const std::string& sentence) const {
    if (!good) problems_->Add(PlaceOf(path, root_), path + " " + sentence);
  }
  // The triangle rule: no body has one principal moment above the sum of the two others.
  void Inertia(const Vector3& moments, const std::string& path) const {
    const double most = moments.maxCoeff();
    Unless(most <= moments.sum() - most + 1e-12 * most, path,
           "is [" + FormatNumber(moments.x()) + ", " + FormatNumber(moments.y()) + ", " +
               FormatNumber(moments.z()) + "] kg·m², which no body has: the largest moment must " +
               "be at most the sum of the two others.");
  }
  // `a` must be below `b`.
  void Below(double a, const std::string& path_a, double b, const std::string& path_b,
             const std::string& unit) const {
    Unless(a < b, path_a,
           "is " + FormatNumber(a) + " " + unit + "; it must be below " + path_b + ", which is " +
               FormatNumber(b) + " " + unit + ".");
  }
  void Action(std::size_t i) const;
  void ActionOverlap(std::size_t i) const;

  const Scenario& s_;
  const YamlNode& root_;
  Problems* problems_;
};

// Distance of a point in O from a primitive's body; 0 inside [m].
double DistanceFrom(const PrimitiveSpec& body, const Vector3& p) {
  if (body.shape == Shape::kSphere) return std::max(0.0, p.norm() - body.size.x());
  if (body.shape == Shape::kBox) {
    return (p.cwiseAbs() - body.size / 2).cwiseMax(0).norm();
  }
  const double radial = std::max(0.0, p.head<2>().norm() - body.size.x());
  return std::hypot(radial, std::max(0.0, std::abs(p.z()) - body.size.y() / 2));
}

void Checker::Object() const {
  const ObjectSpec& object = s_.object;
  Unless(!object.model.empty() || object.primitive, "object",
         "has neither a model nor a primitive. Give object.model, a URDF, or object.primitive.");
  Unless(object.model.empty() || !object.primitive, "object.primitive",
         "stands beside object.model. Keep one of the two.");
  if (object.primitive) {
    const PrimitiveSpec& body = *object.primitive;
    const int used = body.shape == Shape::kBox ? 3 : body.shape == Shape::kCylinder ? 2 : 1;
    Unless(body.size.head(used).minCoeff() > 0, "object.primitive.size",
           "has an entry 0 m among the first " + std::to_string(used) +
               ", which are the dimensions of a " +
               NamesOf(body.shape)[static_cast<std::size_t>(body.shape)] +
               "; they must be above 0.");
    if (body.inertia) Inertia(*body.inertia, "object.primitive.inertia");
  }
  const AttachmentSpec& joint = object.attachment;
  const bool has_axis = joint.joint == JointType::kRevolute || joint.joint == JointType::kPrismatic;
  Unless(!has_axis || joint.axis.norm() > 1e-3, "object.attachment.axis",
         "is zero; it must point somewhere, as in [0, 0, 1].");
  if (joint.range) {
    Below((*joint.range)[0], "object.attachment.range.0", (*joint.range)[1],
          "object.attachment.range.1", "");
  }
}

void Checker::Handles() const {
  Unless(s_.left_handle || s_.right_handle, "handles",
         "has no handle. Give handles.left, handles.right or both: a pose on the object.");
  for (int hand = 0; hand < kHands; ++hand) {
    const std::string path = std::string("handles.") + kHandNames[static_cast<std::size_t>(hand)];
    if (!s_.Has(hand) || !s_.object.primitive) continue;
    const double distance = DistanceFrom(*s_.object.primitive, s_.handle(hand).pose.xyz);
    Unless(distance <= kMostHandleDistance, path + ".xyz",
           "is " + FormatNumber(distance) + " m away from the object; a handle must be on it, at " +
               "most " + FormatNumber(kMostHandleDistance) + " m from its surface.");
  }
}

void Checker::Device() const {
  Unless(!s_.HasRealArms() || s_.safety.handle_speed <= kMostRealHandleSpeed, "safety.handle_speed",
         "is " + FormatNumber(s_.safety.handle_speed) + " m/s; with real arms it must be at most " +
             FormatNumber(kMostRealHandleSpeed) + " m/s.");
  for (int hand = 0; hand < kHands; ++hand) {
    const std::string name = kHandNames[static_cast<std::size_t>(hand)];
    const std::string arm = "device.arms." + name, handle = "handles." + name;
    const std::optional<ArmSpec>& spec = hand == 0 ? s_.device.left : s_.device.right;
    if (spec) Inertia(spec->payload.inertia, arm + ".payload.inertia");
    if (s_.mode == Mode::kDirect) continue;  // needs no arms
    Unless(spec || !s_.Has(hand), arm,
           "is missing, and " + handle + " needs an arm. Give it, or remove the handle, or set " +
               "mode: direct.");
    Unless(!spec || s_.Has(hand), arm,
           "has no handle to hold. Give " + handle + ", or remove the arm.");
  }
  const auto& [type, left, right] = s_.device;
  const bool has_pairs = !s_.rendering.link_pairs.empty() || !left || !right;
  Unless(has_pairs || !left->elbow.empty(), "device.arms.left.elbow",
         "is missing. Name the link that must keep its distance from the other arm's elbow, or " +
             std::string("give rendering.link_pairs."));
  Unless(has_pairs || !right->elbow.empty(), "device.arms.right.elbow",
         "is missing. Name the link that must keep its distance from the other arm's elbow, or " +
             std::string("give rendering.link_pairs."));
}

void Checker::Operator() const {
  const bool is_real = s_.HasRealArms();
  const bool is_person = s_.operator_.type == "person";
  Unless(!is_real || is_person, "operator.type",
         "is " + s_.operator_.type + ", but the arms are real (device.type is " +
             Quote(s_.device.type) + ", which --machine sets): only a person holds them. Set " +
             "operator.type: person, or add --set operator.type=person.");
  Unless(is_real || !is_person, "operator.type",
         "is person, but there are no real arms to hold. Set operator.type: virtual or browser, " +
             std::string("or name the arms by --machine FILE."));
}

void Checker::Script() const {
  for (std::size_t i = 0; i < s_.operator_.script.size(); ++i) {
    Action(i);
    ActionOverlap(i);
  }
}

// One entry: it names a hand that exists, has what its action needs and nothing of another's.
void Checker::Action(std::size_t i) const {
  const ActionSpec& entry = s_.operator_.script[i];
  const std::string path = "operator.script." + std::to_string(i);
  const std::string name = NamesOf(entry.action)[static_cast<std::size_t>(entry.action)];
  const bool is_absent =
      (entry.hand == "left" && !s_.left_handle) || (entry.hand == "right" && !s_.right_handle);
  Unless(!is_absent, path + ".hand",
         "is " + entry.hand + ", and there is no handles." + entry.hand +
             ". Name the other hand or both.");
  using enum ActionType;
  const ActionSpec standard;
  const bool moves = entry.action == kMove || entry.action == kPutDown;
  const bool is_circle = entry.action == kCircle, is_push = entry.action == kPush;
  const struct {
    const char* key;
    bool is_given, is_used, is_needed;
  } uses[] = {
      {"by", !entry.by.isZero(0), moves, entry.action == kMove},
      {"rotate_by", !entry.rotate_by.isZero(0), entry.action == kRotate, entry.action == kRotate},
      {"force", !entry.force.isZero(0), is_push, is_push},
      {"rise", entry.rise != standard.rise, is_push, false},
      {"radius", entry.radius != standard.radius, is_circle, false},
      {"period", entry.period != standard.period, is_circle, false},
      {"cycles", entry.cycles != standard.cycles, is_circle, false},
  };
  for (const auto& use : uses) {
    const std::string key = path + "." + use.key;
    Unless(use.is_used || !use.is_given, key, "means nothing in a " + name + ". Remove it.");
    Unless(!use.is_needed || use.is_given, key, "is zero or missing, and a " + name + " needs it.");
  }
}

// Entries stand in order of time. Two that move, or two that turn the object, exclude each other;
// a push, a grip or a release may come at any time.
void Checker::ActionOverlap(std::size_t i) const {
  using enum ActionType;
  const auto& script = s_.operator_.script;
  const std::string path = "operator.script." + std::to_string(i);
  const auto end = [](const ActionSpec& a) { return a.start + ActionTime(a); };
  const auto moves = [](const ActionSpec& a) {
    return a.action == kMove || a.action == kPutDown || a.action == kCircle;
  };
  for (std::size_t j = 0; j < i; ++j) {
    const bool both_turn = script[i].action == kRotate && script[j].action == kRotate;
    const bool exclude = both_turn || (moves(script[i]) && moves(script[j]));
    const std::string other = "operator.script." + std::to_string(j);
    const std::string start = "is " + FormatNumber(script[i].start) + " s, before " + other;
    if (j + 1 == i && script[i].start < script[j].start) {
      return Unless(false, path + ".start", start + " starts. Write the script in order of time.");
    }
    if (exclude && script[i].start < end(script[j]) - 1e-9) {
      return Unless(false, path + ".start",
                    start + " ends at " + FormatNumber(end(script[j])) +
                        " s. Start it later or shorten the other.");
    }
  }
}

void Checker::Trajectory() const {
  const auto& points = s_.cobot.controller.trajectory;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const std::string path = "cobot.controller.trajectory.";
    Below(points[i - 1].time, path + std::to_string(i - 1) + ".time", points[i].time,
          path + std::to_string(i) + ".time", "s");
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

}  // namespace

void CheckScenario(const Scenario& scenario, const YamlNode& root, Problems* problems) {
  const Checker checker(scenario, root, problems);
  checker.Object();
  checker.Handles();
  checker.Device();
  checker.Operator();
  checker.Script();
  checker.Trajectory();
  checker.Limits();
}

}  // namespace predictor
