#include "simulation/mujoco/fixtures.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/text.h"
#include "simulation/mujoco/contact_law.h"
#include "simulation/mujoco/shapes.h"

namespace predictor {
namespace {

// The share of the motion into a fixture that the fixture's contact removes. This share is equal at
// every depth, so that a contact is a linear spring and damper.
constexpr double kContactImpedance = 0.99;
// The time constant with which friction stops a sliding body [s]. With a shorter time constant,
// MuJoCo's convex contacts make the body hop more. With a longer time constant, the body stops too
// late (docs/developer/decisions.md).
constexpr double kFixtureFrictionTime = 0.01;
// The same share for contacts with a stiffness [N/m]. This share is small, because the engine's
// contacts also add an inertia. The added inertia is this share of the mass that the contacts move.
constexpr double kYieldingImpedance = 0.001;
constexpr double kYieldingFrictionTime = 0.2;  // instead of kFixtureFrictionTime [s]
// The largest permitted value of K dt²/m + 2 B dt/m at a point of contact. A single spring and
// damper is stable if this value is below 4. A body that turns on several points of contact needs a
// value up to ten times smaller.
constexpr double kLargestRate = 0.4;
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

double FrictionBetween(const EnvironmentSpec& environment, const std::optional<double>& a,
                       const std::optional<double>& b) {
  if (a && b) return std::min(*a, *b);
  return a.value_or(b.value_or(environment.friction));
}

namespace {

void AddPair(mjSpec* spec, const std::string& shape, const std::string& other, double friction,
             const FixtureSpec& law) {
  mjsPair* pair = mjs_addPair(spec, nullptr);
  mjs_setString(pair->geomname1, shape.c_str());
  mjs_setString(pair->geomname2, other.c_str());
  pair->condim = 3;
  std::fill_n(pair->friction, 2, friction);
  pair->solref[0] = law.time_constant;
  pair->solref[1] = law.damping_ratio;
  pair->solreffriction[0] = kFixtureFrictionTime;
  pair->solreffriction[1] = 1;
  std::fill_n(pair->solimp, 2, kContactImpedance);
  pair->solimp[2] = 0.001;
  pair->solimp[3] = 0.5;
  pair->solimp[4] = 2;
  pair->margin = pair->gap = 0;
}

}  // namespace

void AddContacts(mjSpec* spec, const EnvironmentSpec& environment, std::size_t i,
                 const std::vector<std::string>& shapes, const std::optional<double>& friction) {
  const FixtureSpec& fixture = environment.fixtures[i];
  for (const std::string& shape : shapes)
    AddPair(spec, FixtureName(i), shape, FrictionBetween(environment, fixture.friction, friction),
            fixture);
}

void AddContact(mjSpec* spec, const std::string& shape, const std::string& other, double friction) {
  AddPair(spec, shape, other, friction, FixtureSpec());
  spec->option.impratio = kFrictionStiffness;
}

namespace {

// Throws InputError if a spring and a damper on a body with this inverse of the mass [1/kg] would
// be unstable in steps of dt [s].
void CheckRate(const FixtureSpec& fixture, std::size_t i, double inverse_mass, double dt) {
  const double rate = dt * inverse_mass * (*fixture.stiffness * dt + 2 * fixture.damping);
  if (rate <= kLargestRate) return;
  const std::string key = "environment.fixtures." + std::to_string(i);
  const double largest = std::max(0.0, kLargestRate / (dt * inverse_mass) - 2 * fixture.damping);
  throw InputError::At(
      key + ".stiffness",
      key + ".stiffness and damping are so large that a body of " +
          FormatNumber(std::round(10 / inverse_mass) / 10) +
          " kg would be unstable in the simulation's steps of 1 ms. With this damping, the "
          "stiffness can be at most " +
          FormatNumber(std::floor(largest / dt)) +
          " N/m. Reduce the stiffness and the damping, or remove both for a fixture that does not "
          "yield.");
}

}  // namespace

// The engine's contact obeys (m + 1/R) a = F − k I/R x − b/R v with R = (1 − I)/I · Â. I is the
// contact's impedance, k and b are those of solref divided by I² and I, and Â approximates the
// inverse of the mass that the contact moves (MuJoCo, "Computation", "Constraint model"). The
// approximation does not matter, because the same Â is used here.
void SetStiffness(const EnvironmentSpec& environment, const std::vector<int>& fixture_of,
                  mjSpec* spec, mjModel* model) {
  for (mjsElement* e = mjs_firstElement(spec, mjOBJ_PAIR); e; e = mjs_nextElement(spec, e)) {
    const int p = mjs_getId(e);
    const int a = model->pair_geom1[p], b = model->pair_geom2[p];
    const int i =
        std::max(fixture_of[static_cast<std::size_t>(a)], fixture_of[static_cast<std::size_t>(b)]);
    if (i < 0) continue;
    const FixtureSpec& fixture = environment.fixtures[static_cast<std::size_t>(i)];
    if (!fixture.stiffness) continue;
    const double inverse_mass = model->body_invweight0[2 * model->geom_bodyid[a]] +
                                model->body_invweight0[2 * model->geom_bodyid[b]];
    CheckRate(fixture, static_cast<std::size_t>(i), inverse_mass, model->opt.timestep);
    const double scale = (1 - kYieldingImpedance) * inverse_mass;
    mjsPair* pair = mjs_asPair(e);
    pair->solref[0] = -scale * *fixture.stiffness;
    pair->solref[1] = -scale * fixture.damping;
    pair->solreffriction[0] = kYieldingFrictionTime;
    std::fill_n(pair->solimp, 2, kYieldingImpedance);
    std::copy_n(pair->solref, mjNREF, model->pair_solref + mjNREF * p);
    std::copy_n(pair->solreffriction, mjNREF, model->pair_solreffriction + mjNREF * p);
    std::copy_n(pair->solimp, mjNIMP, model->pair_solimp + mjNIMP * p);
  }
}

// With the impedance I, the engine's contact adds the inertia m I/(1 − I), as explained above. A
// solref of a time constant and a damping ratio ζ gives k = 1/(time ζ)² and b = 2/time (MuJoCo,
// "Modeling", "Solver parameters").
ContactLaw ContactLawOf(const FixtureSpec& fixture, double mass) {
  if (fixture.stiffness)
    return {*fixture.stiffness, fixture.damping,
            mass * kYieldingImpedance / (1 - kYieldingImpedance)};
  const double scaled = mass / (1 - kContactImpedance);
  const double swing = fixture.time_constant * fixture.damping_ratio;  // [s]
  return {scaled / (swing * swing), 2 * scaled / fixture.time_constant, scaled * kContactImpedance};
}

namespace {

// The engine's default properties of a contact. The impedance depends on the depth. The stiffness
// of the reference is divided by the square of the largest impedance, and its damping by the
// largest impedance (MuJoCo, "Modeling", "Solver parameters").
constexpr double kDefaultTimeConstant = 0.02;  // [s]; the damping ratio is 1
constexpr double kSmallestImpedance = 0.9, kLargestImpedance = 0.95;

ContactLaw DefaultLaw(double mass, double impedance) {
  const double scaled = mass / (1 - impedance), share = impedance / kLargestImpedance;
  return {scaled * share * share / (kDefaultTimeConstant * kDefaultTimeConstant),
          2 * scaled * share / kDefaultTimeConstant, scaled * impedance};
}

}  // namespace

ContactLaw LightContactLaw(double mass) { return DefaultLaw(mass, kSmallestImpedance); }
ContactLaw DeepContactLaw(double mass) { return DefaultLaw(mass, kLargestImpedance); }

void AddSurroundings(mjSpec* spec, const EnvironmentSpec& environment) {
  mjsBody* world = mjs_findBody(spec, "world");
  if (environment.floor) {
    mjsGeom* floor = mjs_addGeom(world, nullptr);
    mjs_setName(floor->element, kFloorName);
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
  // Without stiffness and damping, the engine's default values remain, so that the replay of
  // earlier recordings is identical bit for bit.
  if (!environment.fixtures.empty() || !environment.objects.empty())
    spec->option.impratio = kFrictionStiffness;
}

}  // namespace predictor
