#include "simulation/mujoco/movables.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "scenario/paths.h"
#include "simulation/mujoco/fixtures.h"
#include "simulation/mujoco/mesh_holes.h"
#include "simulation/mujoco/shapes.h"

namespace predictor {
namespace {

constexpr double kDeepestFall = -20;  // height at which a fall ends [m]

std::string Key(std::size_t i) { return "environment.objects." + std::to_string(i); }

std::string BodyName(std::size_t i) { return "movable/" + std::to_string(i); }

std::vector<std::string> ShapesOf(const ObjectModel& model, std::size_t i) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < model.collisions.size(); ++k)
    names.push_back(BodyName(i) + "/" + std::to_string(k));
  return names;
}

void AddContactsOf(mjSpec* spec, const std::vector<std::string>& shapes,
                   const std::vector<std::string>& others, double friction) {
  for (const std::string& shape : shapes)
    for (const std::string& other : others) AddContact(spec, other, shape, friction);
}

// Makes the shapes of a movable object collide with the floor, the table and the fixtures.
void AddContactsWithSurroundings(mjSpec* spec, const EnvironmentSpec& environment,
                                 const std::vector<std::string>& shapes,
                                 const std::optional<double>& friction) {
  const double on_floor = friction.value_or(environment.friction);
  if (environment.floor) AddContactsOf(spec, shapes, {kFloorName}, on_floor);
  if (environment.table) AddContactsOf(spec, shapes, {"table"}, on_floor);
  for (std::size_t i = 0; i < environment.fixtures.size(); ++i)
    if (environment.fixtures[i].Touches("object"))
      AddContacts(spec, environment, i, shapes, friction);
}

}  // namespace

MovableModels LoadMovables(const Scenario& scenario) {
  MovableModels models;
  const std::vector<MovableSpec>& objects = scenario.environment.objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    models.push_back(
        LoadObject({objects[i].model, objects[i].primitive, {}}, scenario.folder(), Key(i)));
    if (models.back().collisions.empty())
      throw InputError::At(
          Key(i) + ".model",
          Key(i) + ".model: " + ResolveModelPath(objects[i].model, scenario.folder()).string() +
              " has no <collision>, so this movable object would fall through everything. Add "
              "<collision> to the links in this file.");
    for (const ModelShape& shape : models.back().collisions) CheckHull(shape, Key(i) + ".model");
  }
  return models;
}

void AddMovables(mjSpec* spec, const EnvironmentSpec& environment, const MovableModels& models) {
  for (std::size_t i = 0; i < models.size(); ++i) {
    mjsBody* body = mjs_addBody(mjs_findBody(spec, "world"), nullptr);
    mjs_setName(body->element, BodyName(i).c_str());
    mjs_setName(mjs_addFreeJoint(body)->element, BodyName(i).c_str());
    const Pose X_WM = environment.objects[i].X_WM();
    SetPose(body->pos, body->quat, X_WM);
    SetInertia(body, models[i]);
    const std::vector<std::string> names = ShapesOf(models[i], i);
    for (std::size_t k = 0; k < names.size(); ++k) {
      mjsGeom* geom = AddShape(spec, body, models[i].collisions[k], names[k], Key(i) + ".model");
      geom->contype = geom->conaffinity = 0;  // only its own pairs collide
    }
  }
}

void AddMovableContacts(mjSpec* spec, const EnvironmentSpec& environment,
                        const MovableModels& models, const std::vector<std::string>& object,
                        const std::vector<std::string>& cobot) {
  for (std::size_t i = 0; i < models.size(); ++i) {
    const MovableSpec& movable = environment.objects[i];
    const std::vector<std::string> shapes = ShapesOf(models[i], i);
    const double friction = movable.friction.value_or(environment.friction);
    AddContactsWithSurroundings(spec, environment, shapes, movable.friction);
    if (movable.Touches("object")) AddContactsOf(spec, shapes, object, friction);
    if (movable.Touches("cobot")) AddContactsOf(spec, shapes, cobot, friction);
    for (std::size_t j = 0; j < i; ++j)
      AddContactsOf(
          spec, shapes, ShapesOf(models[j], j),
          FrictionBetween(environment, movable.friction, environment.objects[j].friction));
  }
}

void CheckMeshes(const MovableModels& models) {
  for (std::size_t i = 0; i < models.size(); ++i)
    for (const ModelShape& shape : models[i].collisions) CheckMesh(shape, Key(i) + ".model");
}

void FindMovables(std::size_t count, Scene* scene) {
  const mjModel& model = *scene->model;
  scene->movable_of.assign(static_cast<std::size_t>(model.nbody), -1);
  for (std::size_t i = 0; i < count; ++i) {
    const int body = mj_name2id(&model, mjOBJ_BODY, BodyName(i).c_str());
    const int joint = model.body_jntadr[body];
    scene->movables.push_back({body, model.jnt_qposadr[joint], model.jnt_dofadr[joint]});
    scene->movable_of[static_cast<std::size_t>(body)] = static_cast<int>(i);
  }
  scene->own_positions = static_cast<int>(model.nq) - 7 * static_cast<int>(count);
  scene->own_dof = static_cast<int>(model.nv) - 6 * static_cast<int>(count);
  for (int p = 0; p < model.npair; ++p) {
    const int a = model.geom_bodyid[model.pair_geom1[p]],
              b = model.geom_bodyid[model.pair_geom2[p]];
    if (std::max(scene->movable_of[static_cast<std::size_t>(a)],
                 scene->movable_of[static_cast<std::size_t>(b)]) >= 0)
      scene->movable_pairs.push_back(p);
  }
}

void SetMovablesTouch(const Scene& scene, bool touch) noexcept {
  for (const int pair : scene.movable_pairs)
    scene.model->pair_margin[pair] = touch ? 0 : kNoContact;
}

bool MovablesTouch(const Scene& scene) noexcept {
  return scene.movable_pairs.empty() ||
         scene.model->pair_margin[scene.movable_pairs.front()] > kNoContact;
}

void LetPass(const Scene& scene, int movable) noexcept {
  const mjModel& model = *scene.model;
  for (const int pair : scene.movable_pairs) {
    const int a = model.geom_bodyid[model.pair_geom1[pair]],
              b = model.geom_bodyid[model.pair_geom2[pair]];
    if (a != scene.object && b != scene.object) continue;
    const int of = std::max(scene.movable_of[static_cast<std::size_t>(a)],
                            scene.movable_of[static_cast<std::size_t>(b)]);
    model.pair_margin[pair] = of == movable ? kNoContact : 0;
  }
}

double GapBetween(const Scene& scene, mjData* data, int movable, double most) noexcept {
  const mjModel& model = *scene.model;
  const int body = scene.movables[static_cast<std::size_t>(movable)].body;
  double nearest = most;
  for (int a = 0; a < model.ngeom; ++a) {
    if (model.geom_bodyid[a] != scene.object) continue;
    for (int b = 0; b < model.ngeom; ++b) {
      if (model.geom_bodyid[b] != body) continue;
      nearest = std::min(nearest, mj_geomDistance(&model, data, a, b, most, nullptr));
    }
  }
  return nearest;
}

// The engine's free joint has the linear velocity of the frame in axes of W and the angular
// velocity in its own axes.
Movables MotionOfMovables(const Scene& scene, const mjData& data) noexcept {
  Movables all;
  for (const MovableBody& movable : scene.movables) {
    MovableMotion& motion = all.motion[static_cast<std::size_t>(all.count++)];
    const double* X = data.qpos + movable.qpos;
    const double* V = data.qvel + movable.dof;
    motion.X_W = {Eigen::Map<const Vector3>(X), Quaternion(X[3], X[4], X[5], X[6]).normalized()};
    motion.V_W << Eigen::Map<const Vector3>(V), motion.X_W.q * Eigen::Map<const Vector3>(V + 3);
  }
  return all;
}

void EndFalls(const Scene& scene, mjData* data) noexcept {
  for (const MovableBody& movable : scene.movables) {
    if (data->qpos[movable.qpos + 2] >= kDeepestFall) continue;
    data->qpos[movable.qpos + 2] = kDeepestFall;
    std::fill_n(data->qvel + movable.dof, 6, 0.0);
  }
}

}  // namespace predictor
