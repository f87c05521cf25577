#include "analysis/check/surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/check/reach.h"
#include "core/text.h"

namespace predictor {
namespace {

// A shape and its pose in W.
struct SurfaceShape {
  FixtureShape shape;
  Vector3 size;
  Pose X_WG;
};

// Returns the outward normal of the surface from which the point lies farthest outside. This
// surface is a side of a box, or the cap or mantle of a cylinder.
Vector3 FacingSide(const SurfaceShape& shape, const Vector3& p) {
  if (shape.shape == FixtureShape::kBox) {
    Eigen::Index axis = 0;
    (p.cwiseAbs() - shape.size / 2).maxCoeff(&axis);
    return std::copysign(1.0, p[axis]) * Vector3::Unit(axis);
  }
  const double radial = p.head<2>().norm() - shape.size.x();
  if (std::abs(p.z()) - shape.size.y() / 2 >= radial || p.head<2>().isZero())
    return std::copysign(1.0, p.z()) * Vector3::UnitZ();
  return Vector3(p.x(), p.y(), 0).normalized();
}

// Returns the normal in the shape's own frame.
Vector3 NormalInShape(const SurfaceShape& shape, const Vector3& p) {
  switch (shape.shape) {
    case FixtureShape::kBox:
    case FixtureShape::kCylinder:
      return FacingSide(shape, p);
    case FixtureShape::kPlane:
      return Vector3::UnitZ();
    default: {
      const double half = shape.shape == FixtureShape::kCapsule ? shape.size.y() / 2 : 0;
      const Vector3 away = p - std::clamp(p.z(), -half, half) * Vector3::UnitZ();
      return away.isZero() ? Vector3(Vector3::UnitZ()) : Vector3(away.normalized());
    }
  }
}

Vector3 NormalOf(const SurfaceShape& shape, const Vector3& p_W) {
  return shape.X_WG.q * NormalInShape(shape, shape.X_WG.Inverse() * p_W);
}

FixtureShape AsFixture(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::kBox:
      return FixtureShape::kBox;
    case ShapeKind::kCylinder:
      return FixtureShape::kCylinder;
    default:
      return FixtureShape::kSphere;
  }
}

SurfaceShape NearestShape(const Scenario& s, std::size_t i, const Vector3& p_W) {
  const Pose X_WM = s.environment.objects[i].X_WM();
  const std::vector<ModelShape> shapes = LoadMovable(s, i).collisions;
  const auto distance = [&](const ModelShape& shape) { return (X_WM * shape.X_LG.p - p_W).norm(); };
  const auto nearest = std::ranges::min_element(shapes, {}, distance);
  return {AsFixture(nearest->kind), nearest->size, X_WM * nearest->X_LG};
}

SurfaceShape ShapeOf(const Scenario& s, const Surface& surface, const Vector3& p_W) {
  const EnvironmentSpec& environment = s.environment;
  switch (surface.kind) {
    case Surface::Kind::kFixture: {
      const FixtureSpec& fixture = environment.fixtures[surface.number];
      return {fixture.shape, fixture.size, fixture.X_WG()};
    }
    case Surface::Kind::kTable: {
      const TableSpec& table = *environment.table;
      return {FixtureShape::kBox,
              table.size,
              {table.top - Vector3(0, 0, table.size.z() / 2), Quaternion::Identity()}};
    }
    case Surface::Kind::kMovable:
      return NearestShape(s, surface.number, p_W);
    case Surface::Kind::kFloor:
      break;
  }
  return {FixtureShape::kPlane, Vector3::Zero(), Pose::Identity()};
}

double LowestPoint(const ModelShape& shape, const Pose& X_WO) {
  const Pose X_WG = X_WO * shape.X_LG;
  const Vector3 up = X_WG.q.conjugate() * Vector3::UnitZ();  // in the shape's axes
  switch (shape.kind) {
    case ShapeKind::kBox:
      return X_WG.p.z() - up.cwiseAbs().dot(shape.size) / 2;
    case ShapeKind::kCylinder:
      return X_WG.p.z() - up.head<2>().norm() * shape.size.x() -
             std::abs(up.z()) * shape.size.y() / 2;
    case ShapeKind::kSphere:
      return X_WG.p.z() - shape.size.x();
    case ShapeKind::kMesh:
      break;
  }
  return -std::numeric_limits<double>::infinity();
}

// Returns the numbers of the surfaces of one kind with their names, for example "0 (shelf) and 2".
std::string NumbersOf(const std::vector<Surface>& surfaces, Surface::Kind kind,
                      const Scenario* names, int* count) {
  std::vector<std::string> words;
  for (const Surface& surface : surfaces) {
    if (surface.kind != kind) continue;
    words.push_back(std::to_string(surface.number));
    if (!names) continue;
    const EnvironmentSpec& environment = names->environment;
    const std::string& name = kind == Surface::Kind::kFixture
                                  ? environment.fixtures[surface.number].name
                                  : environment.objects[surface.number].name;
    if (!name.empty()) words.back() += " (" + name + ")";
  }
  *count = static_cast<int>(words.size());
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k)
    text += (k == 0 ? "" : k + 1 == words.size() ? " and " : ", ") + words[k];
  return text;
}

}  // namespace

std::vector<Surface> SurfacesOf(const Scenario& s, bool floor) {
  const EnvironmentSpec& environment = s.environment;
  std::vector<Surface> surfaces;
  for (std::size_t i = 0; i < environment.fixtures.size(); ++i)
    if (environment.fixtures[i].Touches("object")) surfaces.push_back({Surface::Kind::kFixture, i});
  if (environment.table) surfaces.push_back({Surface::Kind::kTable});
  if (floor && environment.floor) surfaces.push_back({Surface::Kind::kFloor});
  for (std::size_t i = 0; i < environment.objects.size(); ++i)
    if (environment.objects[i].Touches("object")) surfaces.push_back({Surface::Kind::kMovable, i});
  return surfaces;
}

std::string KeyOf(const Surface& surface) {
  switch (surface.kind) {
    case Surface::Kind::kFixture:
      return "environment.fixtures." + std::to_string(surface.number);
    case Surface::Kind::kMovable:
      return "environment.objects." + std::to_string(surface.number);
    case Surface::Kind::kTable:
      return "environment.table";
    case Surface::Kind::kFloor:
      break;
  }
  return "environment.floor";
}

std::string PhraseOf(const std::vector<Surface>& surfaces, const Scenario* names) {
  const auto has = [&](Surface::Kind kind) {
    return std::ranges::find(surfaces, kind, &Surface::kind) != surfaces.end();
  };
  std::vector<std::string> parts;
  const auto add = [&](Surface::Kind kind, const std::string& one, const std::string& several) {
    int count = 0;
    const std::string numbers = NumbersOf(surfaces, kind, names, &count);
    if (count > 0) parts.push_back((count == 1 ? one : several) + " " + numbers);
  };
  add(Surface::Kind::kFixture, "fixture", "fixtures");
  if (has(Surface::Kind::kTable)) parts.emplace_back("table");
  if (has(Surface::Kind::kFloor)) parts.emplace_back("floor");
  add(Surface::Kind::kMovable, "movable object", "movable objects");
  return Join(parts, ", ");
}

std::vector<std::string> LinkContacts(const Scenario& s) {
  std::vector<std::string> keys;
  const EnvironmentSpec& environment = s.environment;
  for (std::size_t i = 0; i < environment.fixtures.size(); ++i)
    if (environment.fixtures[i].Touches("cobot"))
      keys.push_back(KeyOf({Surface::Kind::kFixture, i}));
  for (std::size_t i = 0; i < environment.objects.size(); ++i)
    if (environment.objects[i].Touches("cobot"))
      keys.push_back(KeyOf({Surface::Kind::kMovable, i}));
  if (!s.cobot.touches.empty()) keys.emplace_back("cobot.touches");
  return keys;
}

Vector3 NormalToward(const FixtureSpec& fixture, const Vector3& p_W) {
  return NormalOf({fixture.shape, fixture.size, fixture.X_WG()}, p_W);
}

Vector3 NormalToward(const Scenario& s, const Surface& surface, const Vector3& p_W) {
  return NormalOf(ShapeOf(s, surface, p_W), p_W);
}

ObjectModel LoadMovable(const Scenario& s, std::size_t i) {
  const MovableSpec& movable = s.environment.objects[i];
  return LoadObject({movable.model, movable.primitive, {}}, s.folder(),
                    KeyOf({Surface::Kind::kMovable, i}));
}

double LowestPoint(const ObjectModel& object, const Pose& X_WO) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const ModelShape& shape : object.collisions)
    lowest = std::min(lowest, LowestPoint(shape, X_WO));
  return lowest;
}

bool CanReachFloor(const Scenario& s, const Pose& X_WO) {
  if (!s.environment.floor) return false;
  if (s.operator_.type != "virtual") return true;
  const ObjectModel object = LoadObject(s.object, s.folder());
  for (const std::vector<IntendedSample>& path : TaskPaths(s, X_WO, kPathStep))
    for (const IntendedSample& sample : path)
      if (LowestPoint(object, sample.X_WO) <= kNearFloor) return true;
  return false;
}

}  // namespace predictor
