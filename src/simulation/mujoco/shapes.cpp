#include "simulation/mujoco/shapes.h"

#include <algorithm>

#include "core/error.h"
#include "simulation/mujoco/collision_mesh.h"

namespace predictor {
namespace {

void SetMesh(mjSpec* spec, const ModelShape& shape, const CollisionMesh& from,
             const std::string& name, mjsGeom* geom) {
  mjsMesh* mesh = mjs_addMesh(spec, nullptr);
  mjs_setName(mesh->element, name.c_str());
  mjs_setFloat(mesh->uservert, from.vertices.data(), static_cast<int>(from.vertices.size()));
  mjs_setInt(mesh->userface, from.faces.data(), static_cast<int>(from.faces.size()));
  SetVector(mesh->scale, shape.size);
  geom->type = mjGEOM_MESH;
  mjs_setString(geom->meshname, name.c_str());
}

}  // namespace

void SetVector(double* to, const Vector3& from) { std::copy_n(from.data(), 3, to); }

void SetPose(double* pos, double* quat, const Pose& X) {
  SetVector(pos, X.p);
  quat[0] = X.q.w();
  quat[1] = X.q.x();
  quat[2] = X.q.y();
  quat[3] = X.q.z();
}

void SetInertia(mjsBody* body, const ObjectModel& model) {
  body->explicitinertial = 1;
  body->mass = model.mass;
  SetVector(body->ipos, model.com);
  const Matrix3& I = model.inertia;
  const double inertia[6] = {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
  std::copy_n(inertia, 6, body->fullinertia);
}

void SetContact(mjsGeom* geom, bool surroundings, double friction) {
  geom->contype = surroundings ? 1 : 0;
  geom->conaffinity = surroundings ? 0 : 1;
  geom->friction[0] = friction;
}

mjsGeom* AddShape(mjSpec* spec, mjsBody* body, const ModelShape& shape, const std::string& name,
                  const std::string& key) {
  mjsGeom* geom = mjs_addGeom(body, nullptr);
  mjs_setName(geom->element, name.c_str());
  SetPose(geom->pos, geom->quat, shape.X_LG);
  switch (shape.kind) {
    case ShapeKind::kBox:
      geom->type = mjGEOM_BOX;
      SetVector(geom->size, shape.size / 2);
      break;
    case ShapeKind::kCylinder:
      geom->type = mjGEOM_CYLINDER;
      SetVector(geom->size, {shape.size.x(), shape.size.y() / 2, 0});
      break;
    case ShapeKind::kSphere:
      geom->type = mjGEOM_SPHERE;
      SetVector(geom->size, {shape.size.x(), 0, 0});
      break;
    case ShapeKind::kMesh:
      SetMesh(spec, shape, ReadCollisionMesh(shape, key), name, geom);
      break;
  }
  return geom;
}

void CheckMesh(const ModelShape& shape, const std::string& key) {
  if (shape.kind != ShapeKind::kMesh) return;
  const SpecPtr spec(mj_makeSpec());
  SetMesh(spec.get(), shape, ReadCollisionMesh(shape, key), "mesh",
          mjs_addGeom(mjs_findBody(spec.get(), "world"), nullptr));
  const ModelPtr model(mj_compile(spec.get(), nullptr));
  if (model != nullptr) return;
  throw InputError::At(key, key + ": " + shape.place +
                                ": The physics engine cannot load the mesh " + shape.mesh.string() +
                                ": " + FirstLine(spec.get()) +
                                ". Repair it, save it as binary STL or OBJ, or give <collision> a "
                                "box, cylinder or sphere.");
}

}  // namespace predictor
