#include "simulation/mujoco/fixtures.h"

#include <algorithm>
#include <string>

#include "simulation/mujoco/shapes.h"

namespace predictor {
namespace {

// The share of the motion into a fixture that its contact removes, which is equal at every depth,
// so that a contact is a linear spring and damper.
constexpr double kContactImpedance = 0.99;
// Time constant with which friction stops a sliding body. With a shorter one, MuJoCo's convex
// contacts make the body hop more; with a longer one, it stops too late
// (docs/developer/decisions.md) [s].
constexpr double kFixtureFrictionTime = 0.01;
// The friction of fixtures creeps less than the engine's default friction by this factor.
constexpr double kFrictionStiffness = 10;

void SetForm(const FixtureSpec& fixture, mjsGeom* geom) {
  const Vector3& size = fixture.size;
  switch (fixture.shape) {
    case FixtureShape::kBox:
      geom->type = mjGEOM_BOX;
      SetVector(geom->size, size / 2);
      break;
    case FixtureShape::kCylinder:
    case FixtureShape::kCapsule:
      geom->type = fixture.shape == FixtureShape::kCylinder ? mjGEOM_CYLINDER : mjGEOM_CAPSULE;
      SetVector(geom->size, {size.x(), size.y() / 2, 0});
      break;
    case FixtureShape::kSphere:
      geom->type = mjGEOM_SPHERE;
      SetVector(geom->size, {size.x(), 0, 0});
      break;
    case FixtureShape::kPlane:
      geom->type = mjGEOM_PLANE;
      SetVector(geom->size, {size.x() / 2, size.y() / 2, 0.05});  // last: spacing of the grid
      break;
  }
}

void AddFixture(mjsBody* world, const FixtureSpec& fixture, std::size_t i) {
  mjsGeom* geom = mjs_addGeom(world, nullptr);
  mjs_setName(geom->element, FixtureName(i).c_str());
  SetForm(fixture, geom);
  SetPose(geom->pos, geom->quat, fixture.X_WG());
  geom->contype = geom->conaffinity = 0;  // only its own pairs collide
}

}  // namespace

std::string FixtureName(std::size_t i) { return "fixture/" + std::to_string(i); }

bool TouchesCobot(const EnvironmentSpec& environment) {
  return std::ranges::any_of(environment.fixtures,
                             [](const FixtureSpec& fixture) { return fixture.Touches("cobot"); });
}

void AddContacts(mjSpec* spec, const EnvironmentSpec& environment, std::size_t i,
                 const std::vector<std::string>& shapes) {
  const FixtureSpec& fixture = environment.fixtures[i];
  for (const std::string& shape : shapes) {
    mjsPair* pair = mjs_addPair(spec, nullptr);
    mjs_setString(pair->geomname1, FixtureName(i).c_str());
    mjs_setString(pair->geomname2, shape.c_str());
    pair->condim = 3;
    std::fill_n(pair->friction, 2, fixture.friction.value_or(environment.friction));
    pair->solref[0] = fixture.time_constant;
    pair->solref[1] = fixture.damping_ratio;
    pair->solreffriction[0] = kFixtureFrictionTime;
    pair->solreffriction[1] = 1;
    std::fill_n(pair->solimp, 2, kContactImpedance);
    pair->solimp[2] = 0.001;
    pair->solimp[3] = 0.5;
    pair->solimp[4] = 2;
    pair->margin = pair->gap = 0;
  }
}

void AddSurroundings(mjSpec* spec, const EnvironmentSpec& environment) {
  mjsBody* world = mjs_findBody(spec, "world");
  if (environment.floor) {
    mjsGeom* floor = mjs_addGeom(world, nullptr);
    mjs_setName(floor->element, "floor");
    floor->type = mjGEOM_PLANE;
    SetVector(floor->size, {0, 0, 0.05});  // unlimited size; spacing of the grid
    SetContact(floor, true, environment.friction);
  }
  if (environment.table) {
    const TableSpec& from = *environment.table;
    mjsGeom* table = mjs_addGeom(world, nullptr);
    mjs_setName(table->element, "table");
    table->type = mjGEOM_BOX;
    SetVector(table->size, from.size / 2);
    SetVector(table->pos, from.top - Vector3(0, 0, from.size.z() / 2));
    SetContact(table, true, environment.friction);
  }
  for (std::size_t i = 0; i < environment.fixtures.size(); ++i)
    AddFixture(world, environment.fixtures[i], i);
  // Without fixtures, the engine's default remains, so that earlier recordings replay bit for bit.
  if (!environment.fixtures.empty()) spec->option.impratio = kFrictionStiffness;
}

}  // namespace predictor
