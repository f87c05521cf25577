// Reads and checks the contents of links and joints.
#include <Eigen/Eigenvalues>
#include <cstdio>
#include <map>

#include "core/error.h"
#include "core/text.h"
#include "models/urdf_xml.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

constexpr double kInertiaRounding = 1e-6;  // rounding of decimal numbers, as a share of the largest
                                           // moment
constexpr double kMinMoment = 1e-12;    // smallest moment that the physics engine accepts [kg·m²]
constexpr double kLargestLimit = 1e30;  // some files use a huge limit to mean "none"

double PositiveNumber(const UrdfSource& source, const XmlElement& element, const char* attribute,
                      double largest = UrdfSource::kLargest) {
  const double x = source.Number(element, attribute, UrdfSource::kNone, largest);
  if (x <= 0) {
    source.Fail(element, std::string(attribute) + " of <" + element.Name() + "> is " +
                             FormatNumber(x) + "; it must be greater than 0.");
  }
  return x;
}

// Returns the file that a <mesh> or <texture> refers to. The file's absolute path replaces the URI.
std::filesystem::path ResolveFile(const UrdfSource& source, XmlElement* element,
                                  const std::string& link) {
  const std::string uri = source.Text(*element, "filename");
  try {
    const std::filesystem::path path = ResolveModelPath(uri, source.folder, source.scenario_folder);
    element->SetAttribute("filename", path.c_str());
    return path;
  } catch (const InputError& error) {
    source.Fail(*element, "<" + std::string(element->Name()) + "> of link " + Quote(link) + ": " +
                              error.what());
  }
}

void ReadMesh(const UrdfSource& source, XmlElement* mesh, const std::string& link,
              ModelShape* shape) {
  shape->kind = ShapeKind::kMesh;
  shape->mesh = ResolveFile(source, mesh, link);
  shape->place = source.Place(*mesh);
  shape->size = source.Triple(*mesh, "scale", Vector3::Ones());
  if ((shape->size.array() == 0).any()) {
    source.Fail(
        *mesh,
        "The scale of a mesh of link " + Quote(link) +
            " contains 0, which would flatten the mesh. Give the size of one mesh unit in m.");
  }
}

void ReadGeometry(const UrdfSource& source, XmlElement* geometry, const std::string& link,
                  ModelShape* shape) {
  XmlElement* kind = geometry->FirstChildElement();
  if (kind == nullptr || kind->NextSiblingElement() != nullptr) {
    source.Fail(*geometry, "<geometry> of link " + Quote(link) +
                               " must contain exactly one shape: box, cylinder, sphere or mesh.");
  }
  const std::string name = kind->Name();
  if (name == "box") {
    shape->kind = ShapeKind::kBox;
    source.Text(*kind, "size");
    shape->size = source.Triple(*kind, "size", Vector3::Zero());
    if (shape->size.minCoeff() <= 0) {
      source.Fail(*kind, "A box of link " + Quote(link) + " has the size " +
                             Quote(kind->Attribute("size")) +
                             "; all three entries must be greater than 0.");
    }
  } else if (name == "cylinder") {
    shape->kind = ShapeKind::kCylinder;
    shape->size = {PositiveNumber(source, *kind, "radius"), PositiveNumber(source, *kind, "length"),
                   0};
  } else if (name == "sphere") {
    shape->kind = ShapeKind::kSphere;
    shape->size = {PositiveNumber(source, *kind, "radius"), 0, 0};
  } else if (name == "mesh") {
    ReadMesh(source, kind, link, shape);
  } else {
    source.Fail(*kind, "Link " + Quote(link) + " has the shape " + Quote(name) +
                           ", which is not supported. " +
                           Suggestion(name, {"box", "cylinder", "sphere", "mesh"}));
  }
}

// Reads the colour of a <material>: its own, or that of the robot's material with the same name.
void ReadMaterial(const UrdfSource& source, const XmlElement& robot, XmlElement* material,
                  const std::string& link, ModelShape* shape) {
  XmlElement* texture = material->FirstChildElement("texture");
  if (texture != nullptr && texture->Attribute("filename") != nullptr) {
    ResolveFile(source, texture, link);
  }
  const XmlElement* color = source.Child(*material, "color");
  const char* name = material->Attribute("name");
  for (const XmlElement* global = robot.FirstChildElement("material");
       color == nullptr && name != nullptr && global != nullptr;
       global = global->NextSiblingElement("material")) {
    if (global->Attribute("name", name) != nullptr) color = source.Child(*global, "color");
  }
  if (color != nullptr) shape->color = source.Color(*color, "rgba");
}

// Reads xx xy xz yy yz zz of <inertia> as a matrix.
Matrix3 ReadInertia(const UrdfSource& source, const XmlElement& element) {
  const double xx = source.Number(element, "ixx"), yy = source.Number(element, "iyy"),
               zz = source.Number(element, "izz"), xy = source.Number(element, "ixy", 0),
               xz = source.Number(element, "ixz", 0), yz = source.Number(element, "iyz", 0);
  Matrix3 I;
  I << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return I;
}

void WriteInertia(const Matrix3& I, XmlElement* element) {
  const std::array<const char*, 3> axes = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const std::string name =
          std::string("i") + axes[static_cast<std::size_t>(i)] + axes[static_cast<std::size_t>(j)];
      element->SetAttribute(name.c_str(), FormatNumber(I(i, j)).c_str());
    }
  }
}

// Increases moments that rounding made too small for a rigid body (such as a rod or a thin plate)
// by at most kInertiaRounding of the largest moment. Returns whether a change was necessary.
bool RepairRounding(double mass, Matrix3* inertia) {
  if (mass == 0 && inertia->isZero(0)) return false;  // a frame without a body
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(*inertia);
  const Vector3 w = eigen.eigenvalues();
  const double least = std::max(kMinMoment, 1e-9 * w[2]);
  if (w[0] >= least && w[0] + w[1] >= w[2]) return false;
  Vector3 lifted = w.cwiseMax(least);
  lifted[0] = std::max(lifted[0], (1 + 1e-9) * lifted[2] - lifted[1]);
  *inertia = eigen.eigenvectors() * lifted.asDiagonal() * eigen.eigenvectors().transpose();
  return true;
}

void ReadLimits(const UrdfSource& source, const XmlElement& joint, UrdfJoint* to) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool has_range = to->type != UrdfJointType::kContinuous;
  const XmlElement* limit =
      has_range ? &source.Required(joint, "limit") : source.Child(joint, "limit");
  to->lower = has_range ? source.Number(*limit, "lower", 0, kLargestLimit) : -kInfinity;
  to->upper = has_range ? source.Number(*limit, "upper", 0, kLargestLimit) : kInfinity;
  to->velocity = limit && (has_range || limit->Attribute("velocity"))
                     ? PositiveNumber(source, *limit, "velocity", kLargestLimit)
                     : kInfinity;
  to->effort = limit && (has_range || limit->Attribute("effort"))
                   ? PositiveNumber(source, *limit, "effort", kLargestLimit)
                   : kInfinity;
  if (to->lower >= to->upper) {
    source.Fail(*limit, "Joint " + Quote(to->name) + " has the limits lower " +
                            FormatNumber(to->lower) + " and upper " + FormatNumber(to->upper) +
                            ", but lower must be below upper. Write type=\"fixed\" for a joint "
                            "that does not move.");
  }
}

UrdfJointType ReadType(const UrdfSource& source, const XmlElement& joint, const std::string& name) {
  static const std::map<std::string, UrdfJointType> kTypes = {
      {"fixed", UrdfJointType::kFixed},
      {"revolute", UrdfJointType::kRevolute},
      {"continuous", UrdfJointType::kContinuous},
      {"prismatic", UrdfJointType::kPrismatic}};
  const std::string type = source.Text(joint, "type");
  const auto found = kTypes.find(type);
  if (found == kTypes.end()) {
    source.Fail(joint,
                "Joint " + Quote(name) + " has the type " + Quote(type) +
                    ", which is not supported. " +
                    Suggestion(type, {"fixed", "revolute", "continuous", "prismatic", "planar"}));
  }
  return found->second;
}

}  // namespace

std::string WhatIsWrongWithInertia(const Matrix3& inertia) {
  const Vector3 moments =
      Eigen::SelfAdjointEigenSolver<Matrix3>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  const double rounding = kMinMoment + kInertiaRounding * moments.cwiseAbs().maxCoeff();
  constexpr double kNoise = 1e-12;  // share of the largest moment that is a rounding error
  const Vector3 shown =
      (moments.array().abs() < kNoise * moments.cwiseAbs().maxCoeff()).select(0, moments);
  std::array<char, 100> text;
  std::snprintf(text.data(), text.size(), "%.6g, %.6g, %.6g kg·m²", shown[0], shown[1], shown[2]);
  const std::string values = text.data();
  if (moments[0] < -rounding) {
    return "has the principal moments " + values +
           ", but none can be negative. Take the inertia from the CAD model.";
  }
  if (moments[0] + moments[1] < moments[2] - rounding) {
    return "has the principal moments " + values +
           ", which are physically impossible: none can be greater than the sum of the other two. "
           "Take the inertia about the centre of mass from the CAD model.";
  }
  return "";
}

void ReadInertial(const UrdfSource& source, XmlElement* link, UrdfLink* to) {
  if (source.Child(*link, "inertial") == nullptr) return;
  XmlElement* inertial = link->FirstChildElement("inertial");
  const XmlElement& mass = source.Required(*inertial, "mass");
  to->mass = source.Number(mass, "value");
  if (to->mass < 0) {
    source.Fail(mass, "Link " + Quote(to->name) + " has the mass " + FormatNumber(to->mass) +
                          " kg; it must not be negative.");
  }
  const Pose X_LC = source.Origin(*inertial);
  source.Required(*inertial, "inertia");
  XmlElement* element = inertial->FirstChildElement("inertia");
  Matrix3 inertia = ReadInertia(source, *element);
  const std::string wrong = WhatIsWrongWithInertia(inertia);
  if (!wrong.empty()) {
    source.Fail(*element, "The inertia of link " + Quote(to->name) + " " + wrong);
  }
  if (RepairRounding(to->mass, &inertia)) WriteInertia(inertia, element);
  for (const char* product : {"ixy", "ixz", "iyz"}) {
    if (element->Attribute(product) == nullptr) element->SetAttribute(product, 0);
  }
  to->com = X_LC.p;
  to->inertia = X_LC.R() * inertia * X_LC.R().transpose();
}

void ReadShapes(const UrdfSource& source, const XmlElement& robot, XmlElement* link, UrdfLink* to) {
  for (XmlElement* element = link->FirstChildElement(); element != nullptr;
       element = element->NextSiblingElement()) {
    const std::string name = element->Name();
    if (name != "visual" && name != "collision") continue;
    ModelShape shape;
    shape.X_LG = source.Origin(*element);
    source.Required(*element, "geometry");
    ReadGeometry(source, element->FirstChildElement("geometry"), to->name, &shape);
    if (XmlElement* material = element->FirstChildElement("material")) {
      ReadMaterial(source, robot, material, to->name, &shape);
    }
    (name == "visual" ? to->visuals : to->collisions).push_back(shape);
  }
}

void ReadJoint(const UrdfSource& source, const XmlElement& joint, UrdfJoint* to) {
  to->type = ReadType(source, joint, to->name);
  to->X_PJ = source.Origin(joint);
  if (to->type == UrdfJointType::kFixed) return;
  if (const XmlElement* axis = source.Child(joint, "axis")) {
    source.Text(*axis, "xyz");
    const Vector3 direction = source.Triple(*axis, "xyz", Vector3::UnitX());
    if (direction.norm() < 1e-9) {
      source.Fail(*axis, "The axis of joint " + Quote(to->name) + " is " +
                             Quote(axis->Attribute("xyz")) + ", which has no direction.");
    }
    to->axis = direction.normalized();
  }
  ReadLimits(source, joint, to);
}

}  // namespace predictor
