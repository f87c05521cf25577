#include "export/scene_sdf.h"

#include <cmath>
#include <map>
#include <set>

#include "core/text.h"
#include "export/xml_text.h"

namespace predictor::scene_export {
namespace {

constexpr const char* kModelName = "predictor_scene";
constexpr double kSdfStep = 0.001;   // [s]
constexpr double kUnbounded = 1e16;  // SDF's word for no limit
constexpr const char* kBallName = "attachment";

XmlElement* AddText(XmlElement* parent, const char* name, const std::string& text) {
  XmlElement* element = Add(parent, name);
  element->SetText(text.c_str());
  return element;
}

void AddPose(XmlElement* parent, const Pose& X, const std::string& relative_to = "") {
  XmlElement* pose = AddText(parent, "pose", Text(X.p) + " " + Text(RollPitchYaw(X.R())));
  if (!relative_to.empty()) Set(pose, "relative_to", relative_to);
}

class SdfWriter {
 public:
  SdfWriter(const SceneTree& tree, const Scenario& scenario, PackageMeshes* meshes)
      : tree_(tree), scenario_(scenario), meshes_(*meshes) {
    for (const SceneJoint& joint : tree.joints) above_[joint.child] = &joint;
    for (const SceneLink& link : tree.links) links_[link.name] = &link;
  }

  std::string Write() {
    tinyxml2::XMLDocument doc;
    doc.InsertEndChild(doc.NewDeclaration());
    doc.InsertEndChild(
        doc.NewComment(" Written by predictor export scene --sdf; see README.txt. "));
    XmlElement* sdf = doc.NewElement("sdf");
    doc.InsertEndChild(sdf);
    Set(sdf, "version", "1.9");
    XmlElement* world = Add(sdf, "world");
    Set(world, "name", "predictor");
    AddWorld(world);
    XmlElement* model = Add(world, "model");
    Set(model, "name", kModelName);
    AddParts(model);
    for (const SceneLink& link : tree_.links)
      if (IsSurroundings(link)) AddStaticModel(world, link);
    for (const SceneBody& body : tree_.movables) AddFreeModel(world, body);
    tinyxml2::XMLPrinter printer;
    doc.Print(&printer);
    return printer.CStr();
  }

 private:
  // Only these bodies have a friction of their own.
  static bool IsSurroundings(const SceneLink& link) { return link.friction.has_value(); }
  // In the tree, a ball joint consists of three axes with two links between them.
  bool IsBall() const { return tree_.attachment_joints.size() == 3; }
  bool IsOfBall(const SceneLink& link) const {
    return IsBall() && link.name.starts_with("attachment_");
  }
  // Returns whether the link is a <link> of the model.
  bool IsLink(const SceneLink& link) const {
    if (link.name == "world" || IsSurroundings(link) || IsOfBall(link)) return false;
    return link.mass > kTinyMass || IsMoved(link);
  }
  bool IsMoved(const SceneLink& link) const {
    const auto found = above_.find(link.name);
    return found != above_.end() && found->second->type != UrdfJointType::kFixed;
  }
  // Returns the first link that is "world" or a <link>. The search begins with this link and
  // continues with its ancestors.
  std::string CarrierOf(const std::string& name) const {
    const SceneLink& link = *links_.at(name);
    if (name == "world" || IsLink(link)) return name;
    return CarrierOf(above_.at(name)->parent);
  }

  void AddWorld(XmlElement* world) const {
    XmlElement* physics = Add(world, "physics");
    Set(physics, "name", "1ms");
    Set(physics, "type", "dart");
    AddText(physics, "max_step_size", Text(kSdfStep));
    AddText(physics, "real_time_factor", "1");
    AddText(world, "gravity", Text(Vector3(0, 0, -scenario_.environment.gravity)));
  }

  void AddParts(XmlElement* model) {
    for (const SceneLink& link : tree_.links) {
      if (link.name == "world" || IsSurroundings(link) || IsOfBall(link)) continue;
      if (IsLink(link))
        AddLink(model, link);
      else
        AddFrame(model, link);
    }
    for (const SceneJoint& joint : tree_.joints) {
      const SceneLink& child = *links_.at(joint.child);
      if (IsLink(child)) AddJoint(model, joint);
    }
  }

  // Adds the pose of a link with all joints at 0, relative to its parent in the model.
  void AddPlace(XmlElement* element, const SceneLink& link) const {
    Pose X;
    const SceneJoint* joint = above_.at(link.name);
    for (X = joint->X_PJ; IsOfBall(*links_.at(joint->parent)); X = joint->X_PJ * X)
      joint = above_.at(joint->parent);
    AddPose(element, X, joint->parent == "world" ? "" : joint->parent);
  }

  void AddLink(XmlElement* model, const SceneLink& link) {
    XmlElement* element = Add(model, "link");
    Set(element, "name", link.name);
    AddPlace(element, link);
    AddInertia(element, link);
    AddShapes(element, link);
    for (const SceneLink& frame : tree_.links) {
      if (IsOfBall(frame) || IsSurroundings(frame) || IsLink(frame)) continue;
      if (CarrierOf(frame.name) == link.name) AddVisuals(element, frame, frame.name);
    }
  }

  void AddInertia(XmlElement* element, const SceneLink& link) const {
    XmlElement* inertial = Add(element, "inertial");
    AddPose(inertial, {link.com, Quaternion::Identity()});
    AddText(inertial, "mass", FormatNumber(link.mass));
    XmlElement* inertia = Add(inertial, "inertia");
    const Matrix3& I = link.inertia;
    AddText(inertia, "ixx", FormatNumber(I(0, 0)));
    AddText(inertia, "ixy", FormatNumber(I(0, 1)));
    AddText(inertia, "ixz", FormatNumber(I(0, 2)));
    AddText(inertia, "iyy", FormatNumber(I(1, 1)));
    AddText(inertia, "iyz", FormatNumber(I(1, 2)));
    AddText(inertia, "izz", FormatNumber(I(2, 2)));
  }

  void AddFrame(XmlElement* model, const SceneLink& link) const {
    XmlElement* frame = Add(model, "frame");
    Set(frame, "name", link.name);
    const std::string& parent = above_.at(link.name)->parent;
    if (parent != "world") Set(frame, "attached_to", parent);
    AddPlace(frame, link);
  }

  // The names of links, frames and joints must differ.
  std::string JointName(std::string name) {
    while (links_.contains(name) || !joints_.insert(name).second) name += '_';
    return name;
  }

  void AddJoint(XmlElement* model, const SceneJoint& joint) {
    const SceneLink* parent = links_.at(joint.parent);
    const bool ball = IsOfBall(*parent);
    const bool slides = joint.type == UrdfJointType::kPrismatic;
    const bool fixed = joint.type == UrdfJointType::kFixed && !ball;
    XmlElement* element = Add(model, "joint");
    Set(element, "name", JointName(ball ? kBallName : joint.name));
    Set(element, "type", ball ? "ball" : fixed ? "fixed" : slides ? "prismatic" : "revolute");
    if (ball) AddPose(element, joint.X_PJ.Inverse());  // A in the object
    AddText(element, "parent", CarrierOf(ball ? tree_.end_effector : joint.parent));
    AddText(element, "child", joint.child);
    if (fixed) return;
    XmlElement* axis = Add(element, "axis");
    AddText(axis, "xyz", Text(joint.axis));
    if (!ball) AddLimit(axis, joint);
    XmlElement* dynamics = Add(axis, "dynamics");
    const double damping = ball ? scenario_.object.attachment.damping : joint.damping;
    AddText(dynamics, "damping", Text(damping));
    AddText(dynamics, "friction", Text(joint.friction));
  }

  void AddLimit(XmlElement* axis, const SceneJoint& joint) const {
    const SimulationSpec& simulation = scenario_.simulation;
    const bool has_range =
        simulation.joint_limits != JointLimits::kNone && joint.type != UrdfJointType::kContinuous;
    XmlElement* limit = Add(axis, "limit");
    AddText(limit, "lower", Text(has_range ? joint.lower : -kUnbounded));
    AddText(limit, "upper", Text(has_range ? joint.upper : kUnbounded));
    if (std::isfinite(joint.effort)) AddText(limit, "effort", Text(joint.effort));
    if (simulation.velocity_limits == VelocityLimits::kHard && std::isfinite(joint.velocity))
      AddText(limit, "velocity", Text(joint.velocity));
  }

  void AddShapes(XmlElement* element, const SceneLink& link) {
    AddVisuals(element, link, "");
    // Only the object, the movable objects and the surroundings have collision shapes.
    if (link.name != "object" && !IsSurroundings(link)) return;
    int count = 0;
    for (const SceneShape& shape : link.collisions) {
      XmlElement* collision = Add(element, "collision");
      Set(collision, "name", "collision_" + std::to_string(count++));
      AddPose(collision, shape.shape.X_LG);
      AddGeometry(collision, shape.shape, "collision");
      XmlElement* ode = Add(Add(Add(collision, "surface"), "friction"), "ode");
      const std::string friction = Text(link.friction.value_or(scenario_.environment.friction));
      AddText(ode, "mu", friction);
      AddText(ode, "mu2", friction);
    }
  }

  // `frame` is the name of the link's frame in the model, or empty if the link is `element` itself.
  void AddVisuals(XmlElement* element, const SceneLink& link, const std::string& frame) {
    int count = 0;
    for (const SceneShape& shape : link.visuals) {
      XmlElement* visual = Add(element, "visual");
      Set(visual, "name", link.name + "_" + std::to_string(count++));
      AddPose(visual, shape.shape.X_LG, frame);
      AddGeometry(visual, shape.shape, "visual");
      AddMaterial(visual, shape);
    }
  }

  void AddGeometry(XmlElement* parent, const ModelShape& shape, const std::string& role) {
    XmlElement* geometry = Add(parent, "geometry");
    switch (shape.kind) {
      case ShapeKind::kBox:
        AddText(Add(geometry, "box"), "size", Text(shape.size));
        break;
      case ShapeKind::kCylinder: {
        XmlElement* cylinder = Add(geometry, "cylinder");
        AddText(cylinder, "radius", Text(shape.size.x()));
        AddText(cylinder, "length", Text(shape.size.y()));
        break;
      }
      case ShapeKind::kSphere:
        AddText(Add(geometry, "sphere"), "radius", Text(shape.size.x()));
        break;
      case ShapeKind::kMesh: {
        XmlElement* mesh = Add(geometry, "mesh");
        AddText(mesh, "uri", meshes_.Add(shape, role));
        AddText(mesh, "scale", Text(shape.size));
        break;
      }
    }
  }

  static void AddMaterial(XmlElement* visual, const SceneShape& shape) {
    if (!shape.has_color) return;
    XmlElement* material = Add(visual, "material");
    AddText(material, "ambient", Text(shape.shape.color));
    AddText(material, "diffuse", Text(shape.shape.color));
  }

  void AddStaticModel(XmlElement* world, const SceneLink& link) {
    XmlElement* model = Add(world, "model");
    Set(model, "name", link.name);
    AddText(model, "static", "true");
    AddPose(model, above_.at(link.name)->X_PJ);
    XmlElement* element = Add(model, "link");
    Set(element, "name", "link");
    AddShapes(element, link);
  }

  void AddFreeModel(XmlElement* world, const SceneBody& body) {
    XmlElement* model = Add(world, "model");
    Set(model, "name", body.link.name);
    AddPose(model, body.X_WL);
    XmlElement* element = Add(model, "link");
    Set(element, "name", "link");
    AddInertia(element, body.link);
    AddShapes(element, body.link);
  }

  const SceneTree& tree_;
  const Scenario& scenario_;
  PackageMeshes& meshes_;
  std::map<std::string, const SceneJoint*> above_;  // joints by the link that they move
  std::map<std::string, const SceneLink*> links_;
  std::set<std::string> joints_;
};

}  // namespace

std::string SdfText(const SceneTree& tree, const Scenario& scenario, PackageMeshes* meshes) {
  return SdfWriter(tree, scenario, meshes).Write();
}

}  // namespace predictor::scene_export
