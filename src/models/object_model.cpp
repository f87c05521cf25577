#include "models/object_model.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "models/mesh_size.h"
#include "models/urdf_xml.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

// Returns the poses of the links in O.
std::vector<Pose> PlaceLinks(const UrdfModel& urdf) {
  std::vector<Pose> X_OL(urdf.links.size());
  for (const UrdfJoint& joint : urdf.joints) {
    if (joint.type != UrdfJointType::kFixed) {
      throw InputError(urdf.file.string() + ":" + std::to_string(joint.line),
                       "Joint " + Quote(joint.name) +
                           " of the object moves, but an object must be one rigid body. Make the "
                           "joint fixed, or remove the parts behind it.");
    }
    X_OL[static_cast<std::size_t>(joint.child)] =
        X_OL[static_cast<std::size_t>(joint.parent)] * joint.X_PJ;
  }
  return X_OL;
}

// Returns the inertia of a point mass at r about the origin [kg·m²].
Matrix3 PointInertia(double mass, const Vector3& r) {
  return mass * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
}

// Sums masses, centres of mass and inertias of the links (parallel-axis theorem).
void Merge(const UrdfModel& urdf, const std::vector<Pose>& X_OL, ObjectModel* object) {
  Matrix3 about_O = Matrix3::Zero();
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    const UrdfLink& link = urdf.links[i];
    const Vector3 r = X_OL[i] * link.com;
    const Matrix3 R = X_OL[i].R();
    object->mass += link.mass;
    object->com += link.mass * r;
    about_O += R * link.inertia * R.transpose() + PointInertia(link.mass, r);
    for (const bool is_visual : {true, false}) {
      for (ModelShape shape : is_visual ? link.visuals : link.collisions) {
        shape.X_LG = X_OL[i] * shape.X_LG;
        (is_visual ? object->visuals : object->collisions).push_back(shape);
      }
    }
  }
  if (object->mass > 0) object->com /= object->mass;
  object->inertia = about_O - PointInertia(object->mass, object->com);
}

void CheckMeshSizes(const ObjectModel& object) {
  std::size_t triangles = 0;
  for (const ModelShape& shape : object.collisions) {
    if (shape.kind == ShapeKind::kMesh) triangles += CountTriangles(shape.mesh);
    if (triangles <= kMaxCollisionTriangles) continue;
    throw InputError(shape.place, "With the mesh " + shape.mesh.string() +
                                      ", the object's collision shape has " +
                                      std::to_string(triangles) + " triangles, but at most " +
                                      std::to_string(kMaxCollisionTriangles) +
                                      " are possible. Simplify the mesh, or give <collision> a "
                                      "box, cylinder or sphere.");
  }
}

// Returns the principal moments about the centre [kg·m²] for a body of uniform density.
Vector3 UniformInertia(const PrimitiveSpec& p) {
  switch (p.shape) {
    case Shape::kBox: {
      const Vector3 s = p.size.cwiseAbs2();
      return p.mass / 12 * Vector3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
    }
    case Shape::kCylinder: {
      const double r = p.size.x(), length = p.size.y();
      const double across = r * r / 4 + length * length / 12;
      return p.mass * Vector3(across, across, r * r / 2);
    }
    case Shape::kSphere:
      break;
  }
  return Vector3::Constant(0.4 * p.mass * p.size.x() * p.size.x());
}

ModelShape ShapeOf(const PrimitiveSpec& p, const std::string& key) {
  ModelShape shape;
  shape.kind = p.shape == Shape::kBox        ? ShapeKind::kBox
               : p.shape == Shape::kCylinder ? ShapeKind::kCylinder
                                             : ShapeKind::kSphere;
  const int sizes = p.shape == Shape::kBox ? 3 : p.shape == Shape::kCylinder ? 2 : 1;
  shape.size.head(sizes) = p.size.head(sizes);
  if (!(p.size.head(sizes).minCoeff() > 0) || !p.size.head(sizes).allFinite()) {
    throw InputError::At(key + ".primitive.size",
                         key + ".primitive.size has the entries " + FormatNumber(p.size.x()) +
                             ", " + FormatNumber(p.size.y()) + ", " + FormatNumber(p.size.z()) +
                             " m. The entries that the shape uses must be greater than 0.");
  }
  return shape;
}

// Reads the URDF of an object that has a model. Throws InputError within `key`.
UrdfModel ReadObjectUrdf(const ObjectSpec& spec, const std::filesystem::path& folder,
                         const std::string& key) {
  try {
    const std::filesystem::path from = folder.empty() ? "." : folder;
    return ReadUrdf(ResolveModelPath(spec.model, from), {}, from);
  } catch (const InputError& error) {
    throw error.Within(key + ".model");
  }
}

void AppendOutline(const ModelShape& shape, std::vector<OutlinePoint>* outline) {
  const Vector3& size = shape.size;
  switch (shape.kind) {
    case ShapeKind::kBox:
      for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5})
          for (const double z : {-0.5, 0.5})
            outline->push_back({shape.X_LG * Vector3(x * size.x(), y * size.y(), z * size.z())});
      return;
    case ShapeKind::kCylinder:
      for (const double z : {-0.5, 0.5})
        outline->push_back({shape.X_LG * Vector3(0, 0, z * size.y()), size.x()});
      return;
    case ShapeKind::kSphere:
      outline->push_back({shape.X_LG.p, size.x()});
      return;
    case ShapeKind::kMesh:
      return;
  }
}

}  // namespace

std::vector<OutlinePoint> OutlineOf(const ObjectModel& object) {
  std::vector<OutlinePoint> outline;
  for (const ModelShape& shape : object.collisions.empty() ? object.visuals : object.collisions)
    AppendOutline(shape, &outline);
  return outline;
}

ObjectModel ReadObject(const std::filesystem::path& file) { return MakeObject(ReadUrdf(file)); }

ObjectModel MakeObject(const UrdfModel& urdf) {
  ObjectModel object;
  object.name = urdf.name;
  Merge(urdf, PlaceLinks(urdf), &object);
  CheckMeshSizes(object);
  if (object.mass <= 0 || object.inertia.determinant() <= 0) {
    throw InputError(urdf.file.string(), "The object " + Quote(urdf.name) + " has the mass " +
                                             FormatNumber(object.mass) +
                                             " kg, but it needs a mass and an inertia about all "
                                             "axes. Give the link of the object an <inertial>.");
  }
  return object;
}

ObjectModel MakeObject(const PrimitiveSpec& primitive, const std::string& key) {
  ObjectModel object;
  object.name = "primitive";
  const ModelShape shape = ShapeOf(primitive, key);
  if (!(primitive.mass > 0) || !std::isfinite(primitive.mass)) {
    throw InputError::At(key + ".primitive.mass", key + ".primitive.mass is " +
                                                      FormatNumber(primitive.mass) +
                                                      " kg; it must be greater than 0.");
  }
  object.mass = primitive.mass;
  object.com = primitive.center_of_mass;
  object.inertia = primitive.inertia.value_or(UniformInertia(primitive)).asDiagonal();
  const std::string wrong = object.inertia.allFinite() && object.inertia.diagonal().minCoeff() > 0
                                ? WhatIsWrongWithInertia(object.inertia)
                                : "must have three finite moments greater than 0.";
  if (!wrong.empty()) {
    throw InputError::At(key + ".primitive.inertia", key + ".primitive.inertia " + wrong);
  }
  object.visuals = object.collisions = {shape};
  return object;
}

ObjectModel LoadObject(const ObjectSpec& spec, const std::filesystem::path& folder,
                       const std::string& key) {
  if (spec.model.empty()) {
    if (spec.primitive) return MakeObject(*spec.primitive, key);
    throw InputError::At(
        key, key + " has neither a model nor a primitive. Give a model or a primitive.");
  }
  const UrdfModel urdf = ReadObjectUrdf(spec, folder, key);
  try {
    return MakeObject(urdf);
  } catch (const InputError& error) {
    throw error.Within(key + ".model");
  }
}

Pose HandlePose(const Scenario& scenario, int hand) {
  const HandleSpec& handle = scenario.handle(hand);
  if (handle.link.empty()) return handle.pose.ToPose();
  const UrdfModel urdf = ReadObjectUrdf(scenario.object, scenario.folder(), "object");
  const std::vector<std::string> names = urdf.LinkNames();
  const auto link = std::find(names.begin(), names.end(), handle.link);
  if (link == names.end()) {
    const std::string key = std::string("handles.") + HandName(hand) + ".link";
    throw InputError::At(key, key + " is " + Quote(handle.link) + ", but the object " +
                                  Quote(urdf.name) + " has no such link. " +
                                  Suggestion(handle.link, names));
  }
  const auto i = static_cast<std::size_t>(link - names.begin());
  return PlaceLinks(urdf)[i] * handle.pose.ToPose();
}

}  // namespace predictor
