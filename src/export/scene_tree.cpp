#include "export/scene_tree.h"

#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "models/fixture_shapes.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "models/urdf.h"
#include "models/urdf_xml.h"
#include "scenario/obstacle_events.h"
#include "scenario/paths.h"

namespace predictor::scene_export {
namespace {

// Returns the material of the robot that has the same name. This material supplies the values that
// the visual's own material omits.
const XmlElement* GlobalMaterial(const XmlElement& robot, const XmlElement& material) {
  const char* name = material.Attribute("name");
  for (const XmlElement* global = robot.FirstChildElement("material");
       name != nullptr && global != nullptr; global = global->NextSiblingElement("material")) {
    if (global->Attribute("name", name) != nullptr) return global;
  }
  return nullptr;
}

const char* TextureOf(const XmlElement* material) {
  const XmlElement* texture = material ? material->FirstChildElement("texture") : nullptr;
  return texture ? texture->Attribute("filename") : nullptr;
}

bool HasColor(const XmlElement* material) {
  return material != nullptr && material->FirstChildElement("color") != nullptr;
}

SceneShape Read(const XmlElement& robot, const XmlElement& visual, const ModelShape& shape,
                const UrdfModel& urdf, const std::filesystem::path& scenario_folder) {
  SceneShape out{shape, shape.kind != ShapeKind::kMesh, {}};
  const XmlElement* material = visual.FirstChildElement("material");
  if (material == nullptr) return out;
  const XmlElement* global = GlobalMaterial(robot, *material);
  const char* texture = TextureOf(material) ? TextureOf(material) : TextureOf(global);
  if (texture != nullptr) {
    out.texture = ResolveModelPath(texture, urdf.file.parent_path(), scenario_folder);
  }
  out.has_color = out.has_color || HasColor(material) || HasColor(global);
  return out;
}

// Returns the shapes of the <visual> elements of each link of a URDF, and whether they have their
// own material. A mesh without its own material has the colours in its file. `scenario_folder` is
// the folder of the scenario that refers to the URDF.
std::vector<std::vector<SceneShape>> VisualsOf(const UrdfModel& urdf,
                                               const std::filesystem::path& scenario_folder) {
  std::vector<std::vector<SceneShape>> visuals(urdf.links.size());
  tinyxml2::XMLDocument doc;
  const XmlElement* robot = ParseXml(urdf.text, {urdf.file.string(), {}}, &doc);
  std::size_t i = 0;  // the text contains the links and their visuals in the same order as the
                      // model
  for (const XmlElement* link = robot->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link"), ++i) {
    const XmlElement* visual = link->FirstChildElement("visual");
    for (const ModelShape& shape : urdf.links[i].visuals) {
      visuals[i].push_back(Read(*robot, *visual, shape, urdf, scenario_folder));
      visual = visual->NextSiblingElement("visual");
    }
  }
  return visuals;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFarOff = 1000;      // range of a prismatic joint without limits [m]
constexpr double kFloorSize = 10;     // size of the box that represents the plane [m]
constexpr double kFloorDepth = 0.05;  // [m]
constexpr double kHandleRadius = 0.018, kHandleLength = 0.11;  // size of the displayed grip [m]
constexpr std::array<std::array<double, 4>, kHands> kHandleColors = {
    {{0.21, 0.65, 1, 1}, {0.71, 0.48, 1, 1}}};
constexpr std::array<double, 4> kFloorColor = {0.6, 0.6, 0.6, 1};
constexpr std::array<double, 4> kTableColor = {0.61, 0.48, 0.34, 1};

constexpr const char* kFixturePrefix = "fixture_";

// The names of the scene's own links, except the links of fixtures.
const std::set<std::string>& OwnLinks() {
  static const std::set<std::string> names = {"world",
                                              "floor",
                                              "table",
                                              "object",
                                              "left_handle",
                                              "right_handle",
                                              "attachment_link",
                                              "attachment_x_link",
                                              "attachment_y_link",
                                              "attachment_z_link"};
  return names;
}

UrdfModel ReadCobot(const Scenario& scenario) {
  const CobotSpec& spec = scenario.cobot;
  try {
    return ReadUrdf(ResolveModelPath(spec.model, scenario.folder()), spec.remove_links,
                    scenario.folder());
  } catch (const InputError& error) {
    throw error.Within(error.key().empty() ? "cobot.model" : "cobot");
  }
}

// Accepts one value for all joints, or one value per joint.
void CheckCount(const std::vector<double>& values, const std::string& key, int dof) {
  const int size = static_cast<int>(values.size());
  if (size == 1 || size == dof) return;
  throw InputError::At(key, key + " has " + std::to_string(size) +
                                " values. Give one for all joints, or " + std::to_string(dof) +
                                ".");
}

void CheckCobot(const CobotSpec& spec, const UrdfModel& urdf) {
  const auto robot = RobotModel::Build(urdf, Pose::Identity());
  CheckCount(spec.joint_friction.viscous, "cobot.joint_friction.viscous", robot->dof());
  CheckCount(spec.joint_friction.coulomb, "cobot.joint_friction.coulomb", robot->dof());
  if (!spec.effort_limit.empty()) {
    CheckCount(spec.effort_limit, "cobot.effort_limit", robot->dof());
  }
  try {
    robot->Frame(spec.end_effector);
  } catch (const InputError& error) {
    throw error.Within("cobot.end_effector");
  }
}

Pose At(const Vector3& p) { return {p, Quaternion::Identity()}; }

SceneShape Plain(ShapeKind kind, const Vector3& size, const Pose& X_LG,
                 const std::array<double, 4>& color) {
  SceneShape shape;
  shape.shape.kind = kind;
  shape.shape.size = size;
  shape.shape.X_LG = X_LG;
  shape.shape.color = color;
  return shape;
}

std::vector<SceneShape> Uncolored(const std::vector<ModelShape>& shapes) {
  std::vector<SceneShape> plain;
  plain.reserve(shapes.size());
  for (const ModelShape& shape : shapes) plain.push_back({shape, false, {}});
  return plain;
}

class Composer {
 public:
  explicit Composer(const Scenario& scenario) : scenario_(scenario) {}

  SceneTree Compose() {
    tree_.links.push_back({"world"});
    AddCobot();
    AddObject(AddAttachment());
    AddHandles();
    AddSurroundings();
    AddMovables();
    return std::move(tree_);
  }

 private:
  // Returns a name for a joint that the scene adds. The name must differ from the names of the
  // cobot's joints, because the topics use those names.
  std::string JointName(std::string name) {
    while (!joint_names_.insert(name).second) name += '_';
    return name;
  }

  SceneJoint& Join(const std::string& name, const std::string& parent, const SceneLink& child,
                   const Pose& X_PJ) {
    SceneJoint joint;
    joint.name = JointName(name);
    joint.parent = parent;
    joint.child = child.name;
    joint.X_PJ = X_PJ;
    tree_.links.push_back(child);
    tree_.joints.push_back(joint);
    return tree_.joints.back();
  }

  static SceneLink Massless(const std::string& name) {
    SceneLink link;
    link.name = name;
    link.mass = kTinyMass;
    link.inertia = kTinyInertia * Matrix3::Identity();
    return link;
  }

  void AddCobot() {
    const UrdfModel urdf = ReadCobot(scenario_);
    CheckCobot(scenario_.cobot, urdf);
    NameLinks(urdf);
    const auto visuals = VisualsOf(urdf, scenario_.folder());
    for (const UrdfJoint& joint : urdf.joints) joint_names_.insert(joint.name);
    Join("cobot_base_joint", "world", CobotLink(urdf, urdf.root, visuals),
         scenario_.cobot.base.ToPose());
    for (const UrdfJoint& joint : urdf.joints) {
      tree_.links.push_back(CobotLink(urdf, joint.child, visuals));
      AddCobotJoint(urdf, joint);
    }
    tree_.end_effector = names_.at(scenario_.cobot.end_effector);
  }

  void NameLinks(const UrdfModel& urdf) {
    std::set<std::string> taken = OwnLinks();
    for (const UrdfLink& link : urdf.links) taken.insert(link.name);
    for (const UrdfLink& link : urdf.links) {
      std::string name = link.name;
      if (OwnLinks().count(name) > 0 || name.starts_with(kFixturePrefix)) {
        name.insert(0, "cobot_");
        while (!taken.insert(name).second) name += '_';
      }
      names_[link.name] = name;
    }
  }

  SceneLink CobotLink(const UrdfModel& urdf, int index,
                      const std::vector<std::vector<SceneShape>>& visuals) const {
    const UrdfLink& from = urdf.links[static_cast<std::size_t>(index)];
    SceneLink link = Massless(names_.at(from.name));
    if (from.mass > 0) {
      link.mass = from.mass;
      link.com = from.com;
      link.inertia = from.inertia;
    }
    link.visuals = visuals[static_cast<std::size_t>(index)];
    link.collisions = Uncolored(from.collisions);
    return link;
  }

  void AddCobotJoint(const UrdfModel& urdf, const UrdfJoint& from) {
    const CobotSpec& spec = scenario_.cobot;
    SceneJoint joint;
    joint.name = from.name;
    joint.parent = names_.at(urdf.links[static_cast<std::size_t>(from.parent)].name);
    joint.child = names_.at(urdf.links[static_cast<std::size_t>(from.child)].name);
    joint.type = from.type;
    joint.X_PJ = from.X_PJ;
    joint.axis = from.axis;
    if (from.type != UrdfJointType::kFixed) {
      const int j = static_cast<int>(tree_.cobot_joints.size());
      joint.lower = from.lower;
      joint.upper = from.upper;
      joint.velocity = from.velocity;
      joint.effort = spec.effort_limit.empty() ? from.effort : OneOrEach(spec.effort_limit, j);
      joint.damping = OneOrEach(spec.joint_friction.viscous, j);
      joint.friction = OneOrEach(spec.joint_friction.coulomb, j);
      tree_.cobot_joints.push_back(joint.name);
    }
    tree_.joints.push_back(joint);
  }

  // Adds a moving joint of the attachment. The joint has no drive, and only `range` bounds it.
  void AddAxis(const std::string& name, const std::string& parent, const std::string& child,
               const Pose& X_PJ, const Vector3& axis) {
    const AttachmentSpec& spec = scenario_.object.attachment;
    SceneJoint& joint = Join(name, parent, Massless(child), X_PJ);
    joint.type = spec.joint == JointType::kPrismatic                ? UrdfJointType::kPrismatic
                 : spec.joint == JointType::kRevolute && spec.range ? UrdfJointType::kRevolute
                                                                    : UrdfJointType::kContinuous;
    joint.axis = axis.normalized();
    joint.lower = -kInfinity;
    joint.upper = kInfinity;
    if (joint.type == UrdfJointType::kPrismatic) {  // URDF requires limits
      joint.lower = -kFarOff;
      joint.upper = kFarOff;
    }
    if (spec.range && spec.joint != JointType::kSpherical) {
      joint.lower = (*spec.range)[0];
      joint.upper = (*spec.range)[1];
    }
    joint.velocity = joint.effort = kInfinity;
    joint.damping = spec.damping;
    tree_.attachment_joints.push_back(joint.name);
  }

  // Returns the link whose frame is A, to which the object is fixed.
  std::string AddAttachment() {
    const AttachmentSpec& spec = scenario_.object.attachment;
    const Pose X_EA = spec.on_end_effector.ToPose();
    const std::string& end_effector = tree_.end_effector;
    switch (spec.joint) {
      case JointType::kFixed:
        Join("attachment_joint", end_effector, Massless("attachment_link"), X_EA);
        return "attachment_link";
      case JointType::kRevolute:
      case JointType::kPrismatic:
        AddAxis("attachment", end_effector, "attachment_link", X_EA, spec.axis);
        return "attachment_link";
      case JointType::kSpherical:
        break;
    }
    AddAxis("attachment_x", end_effector, "attachment_x_link", X_EA, Vector3::UnitX());
    AddAxis("attachment_y", "attachment_x_link", "attachment_y_link", {}, Vector3::UnitY());
    AddAxis("attachment_z", "attachment_y_link", "attachment_z_link", {}, Vector3::UnitZ());
    return "attachment_z_link";
  }

  void AddObject(const std::string& parent) {
    const ObjectSpec& spec = scenario_.object;
    Join("object_joint", parent, ObjectLink("object", spec, "object"),
         spec.attachment.on_object.ToPose().Inverse());
  }

  // `key` is the object's place in the scenario.
  SceneLink ObjectLink(const std::string& name, const ObjectSpec& spec,
                       const std::string& key) const {
    const ObjectModel model = LoadObject(spec, scenario_.folder(), key);
    SceneLink link;
    link.name = name;
    link.mass = model.mass;
    link.com = model.com;
    link.inertia = model.inertia;
    link.collisions = Uncolored(model.collisions);
    link.visuals = ObjectVisuals(model, spec.model);
    return link;
  }

  // Returns the shapes of the merged links, in order and with the materials from the object's file.
  // If `file` is empty, the object is a primitive.
  std::vector<SceneShape> ObjectVisuals(const ObjectModel& model, const std::string& file) const {
    std::vector<SceneShape> merged;
    if (file.empty()) {
      for (const ModelShape& shape : model.visuals) merged.push_back({shape, true, {}});
      return merged;
    }
    const UrdfModel urdf =
        ReadUrdf(ResolveModelPath(file, scenario_.folder()), {}, scenario_.folder());
    for (const std::vector<SceneShape>& of_link : VisualsOf(urdf, scenario_.folder()))
      for (SceneShape shape : of_link) {
        shape.shape.X_LG = model.visuals[merged.size()].X_LG;
        merged.push_back(shape);
      }
    return merged;
  }

  void AddHandles() {
    // The grip of a handle is along Y, as in the viewer.
    const Pose X_DG = PoseFromXyzRpy(Vector3::Zero(), {M_PI / 2, 0, 0});
    for (const int hand : scenario_.hands()) {
      const auto h = static_cast<std::size_t>(hand);
      SceneLink link = Massless(std::string(kHandNames[h]) + "_handle");
      link.visuals = {
          Plain(ShapeKind::kCylinder, {kHandleRadius, kHandleLength, 0}, X_DG, kHandleColors[h])};
      Join(link.name + "_joint", "object", link, HandlePose(scenario_, hand));
    }
  }

  void AddStatic(const std::string& name, const Vector3& top, const Vector3& size,
                 const std::array<double, 4>& color) {
    SceneLink link;
    link.name = name;
    link.visuals = {Plain(ShapeKind::kBox, size, At({0, 0, -size.z() / 2}), color)};
    link.collisions = link.visuals;
    link.friction = scenario_.environment.friction;
    Join(name + "_joint", "world", link, At(top));
  }

  void AddFixture(const std::string& name, const FixtureSpec& fixture) {
    SceneLink link;
    link.name = name;
    for (const ModelShape& shape : FixtureShapes(fixture))
      link.visuals.push_back({shape, true, {}});
    link.collisions = link.visuals;
    link.friction = fixture.friction.value_or(scenario_.environment.friction);
    Join(name + "_joint", "world", link, Pose::Identity());
  }

  void AddSurroundings() {
    const EnvironmentSpec& environment = scenario_.environment;
    if (environment.floor) {
      AddStatic("floor", Vector3::Zero(), {kFloorSize, kFloorSize, kFloorDepth}, kFloorColor);
    }
    if (environment.table) {
      AddStatic("table", environment.table->top, environment.table->size, kTableColor);
    }
    // A fixture that appears in an event is omitted. It is absent at first, and the participant may
    // see the scene. A keep-out volume is not a body.
    for (std::size_t i = 0; i < environment.fixtures.size(); ++i)
      if (EventsOfFixture(scenario_, i) == 0 && !environment.fixtures[i].keep_out)
        AddFixture(kFixturePrefix + std::to_string(i), environment.fixtures[i]);
  }

  void AddMovables() {
    const EnvironmentSpec& environment = scenario_.environment;
    for (std::size_t i = 0; i < environment.objects.size(); ++i) {
      const MovableSpec& movable = environment.objects[i];
      const std::string index = std::to_string(i);
      SceneLink link = ObjectLink("movable_" + index, {movable.model, movable.primitive, {}},
                                  "environment.objects." + index);
      link.friction = movable.friction.value_or(environment.friction);
      if (movable.model.empty())
        for (SceneShape& shape : link.visuals)
          shape.shape.color = {movable.color.x(), movable.color.y(), movable.color.z(), 1};
      tree_.movables.push_back({link, movable.X_WM()});
    }
  }

  const Scenario& scenario_;
  SceneTree tree_;
  std::set<std::string> joint_names_;
  std::map<std::string, std::string> names_;  // the cobot's link names: in its file, in the scene
};

}  // namespace

SceneTree ComposeTree(const Scenario& scenario) { return Composer(scenario).Compose(); }

}  // namespace predictor::scene_export
