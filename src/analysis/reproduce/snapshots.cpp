// Draws the scene of a tick: the virtual cobot with its load, and the device's arms.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <numbers>

#include "analysis/reproduce/raster.h"
#include "analysis/reproduce/runs.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "models/urdf.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

constexpr int kWidth = 720, kHeight = 560;  // [px]
constexpr int kSlices = 20;                 // segments of round shapes
constexpr double kHandleRadius = 0.02, kHandleLength = 0.12, kRodRadius = 0.014;  // [m]
constexpr double kMetresPerNewton = 0.01;  // length of an arrow per newton: 0.3 m at the threshold
constexpr double kGrid = 0.25, kGridReach = 1.5, kGridLine = 0.004;  // [m]
constexpr double kOrange = 0.5, kRed = 0.8;  // share of the threshold from which an arrow has this
                                             // colour

const Vector3 kCobot(0.33, 0.45, 0.62), kArms(0.90, 0.905, 0.92), kHandle(0.20, 0.42, 0.85);

// The corners of triangles: three corners for each triangle [m].
using Corners = std::vector<Vector3>;

void AddQuad(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d, Corners* to) {
  for (const Vector3& p : {a, b, c, a, c, d}) to->push_back(p);
}

Corners BoxCorners(const Vector3& size) {
  Corners corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-0.5, 0.5}) {
      const auto at = [&](double u, double v) {
        Vector3 p;
        p[axis] = side * size[axis];
        p[(axis + 1) % 3] = u * size[(axis + 1) % 3];
        p[(axis + 2) % 3] = v * size[(axis + 2) % 3];
        return p;
      };
      AddQuad(at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5), &corners);
    }
  return corners;
}

// Returns a truncated cone about the z axis, with radius r0 at z0 and radius r1 at z1. The cone is
// closed at both ends.
Corners ConeCorners(double r0, double z0, double r1, double z1) {
  Corners corners;
  for (int i = 0; i < kSlices; ++i) {
    const auto at = [&](int k, double r, double z) {
      const double angle = 2 * std::numbers::pi * k / kSlices;
      return Vector3(r * std::cos(angle), r * std::sin(angle), z);
    };
    AddQuad(at(i, r0, z0), at(i + 1, r0, z0), at(i + 1, r1, z1), at(i, r1, z1), &corners);
    AddQuad(at(i, r0, z0), at(i + 1, r0, z0), {0, 0, z0}, {0, 0, z0}, &corners);
    AddQuad(at(i, r1, z1), at(i + 1, r1, z1), {0, 0, z1}, {0, 0, z1}, &corners);
  }
  return corners;
}

Corners SphereCorners(double radius) {
  Corners corners;
  for (int i = 0; i < kSlices / 2; ++i)
    for (int k = 0; k < kSlices; ++k) {
      const auto at = [&](int u, int v) {
        const double up = std::numbers::pi * (2.0 * u / kSlices - 0.5);
        const double around = 2 * std::numbers::pi * v / kSlices;
        return Vector3(radius * std::cos(up) * std::cos(around),
                       radius * std::cos(up) * std::sin(around), radius * std::sin(up));
      };
      AddQuad(at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k), &corners);
    }
  return corners;
}

// Returns the scaled triangles of a binary STL file. For other formats and truncated files, the
// list is empty.
Corners StlCorners(const std::filesystem::path& file, const Vector3& scale) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  constexpr std::size_t kHead = 84, kEach = 50, kNormal = 12;
  if (bytes.size() < kHead) return {};
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHead - sizeof count, sizeof count);
  if ((bytes.size() - kHead) / kEach < count) return {};
  Corners corners;
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<float, 3> p;
      std::memcpy(p.data(), bytes.data() + kHead + t * kEach + kNormal + k * sizeof p, sizeof p);
      corners.push_back(scale.cwiseProduct(Vector3(p[0], p[1], p[2])));
    }
  return corners;
}

Corners CornersOf(const ModelShape& shape) {
  switch (shape.kind) {
    case ShapeKind::kBox:
      return BoxCorners(shape.size);
    case ShapeKind::kCylinder:
      return ConeCorners(shape.size[0], -0.5 * shape.size[1], shape.size[0], 0.5 * shape.size[1]);
    case ShapeKind::kSphere:
      return SphereCorners(shape.size[0]);
    case ShapeKind::kMesh:
      return StlCorners(shape.mesh, shape.size);
  }
  return {};
}

void Draw(const Corners& corners, const Pose& X_WG, const Vector3& color, Raster* raster,
          bool lit = true) {
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    raster->Triangle(X_WG * corners[i], X_WG * corners[i + 1], X_WG * corners[i + 2], color, lit);
}

// A robot and the shapes of its links, as read from the files.
class Figure {
 public:
  Figure(const Scenario& scenario, const std::string& model,
         const std::vector<std::string>& remove_links, const Pose& X_WB)
      : urdf_(
            ReadUrdf(ResolveModelPath(model, scenario.folder()), remove_links, scenario.folder())),
        model_(RobotModel::Build(urdf_, X_WB)),
        data_(*model_) {
    for (const UrdfLink& link : urdf_.links)
      for (const ModelShape& shape : link.collisions)
        parts_.push_back({CornersOf(shape), model_->Frame(link.name, shape.X_LG)});
  }
  void Show(const double* q, const Vector3& color, Raster* raster) {
    const int dof = model_->dof();
    JointVector joints(dof);
    for (int j = 0; j < dof; ++j) joints[j] = q[j];
    data_.UpdateKinematics(*model_, joints, JointVector::Zero(dof));
    for (const Part& part : parts_)
      Draw(part.corners, data_.FramePose(*model_, part.frame), color, raster);
  }
  // Returns the pose of a link. Call Show first.
  Pose LinkPose(const std::string& link) const {
    return data_.FramePose(*model_, model_->Frame(link));
  }

 private:
  struct Part {
    Corners corners;
    FrameId frame;
  };
  UrdfModel urdf_;
  std::shared_ptr<const RobotModel> model_;
  RobotData data_;
  std::vector<Part> parts_;
};

// Returns a pose at `from` whose z-axis points to `to`.
Pose Along(const Vector3& from, const Vector3& to) {
  return {from, Quaternion::FromTwoVectors(Vector3::UnitZ(), to - from)};
}

void DrawGrid(Raster* raster) {
  const Vector3 grey(0.76, 0.78, 0.80);
  const int lines = static_cast<int>(kGridReach / kGrid);
  // Draws the line in pieces, because a triangle behind the camera is omitted completely.
  for (int i = -lines; i <= lines; ++i)
    for (int k = -lines; k < lines; ++k)
      for (const bool turned : {false, true}) {
        const auto at = [&](double along, double across) {
          const double u = (k + along) * kGrid, v = i * kGrid + across;
          return turned ? Vector3(v, u, 0) : Vector3(u, v, 0);
        };
        Corners line;
        AddQuad(at(0, -kGridLine / 2), at(1, -kGridLine / 2), at(1, kGridLine / 2),
                at(0, kGridLine / 2), &line);
        Draw(line, Pose(), grey, raster, false);
      }
}

void DrawForce(const HandRecord& hand, double threshold, Raster* raster) {
  const Vector3 force(hand.wrench[0], hand.wrench[1], hand.wrench[2]);
  const double share = force.norm() / threshold, length = kMetresPerNewton * force.norm();
  if (!(length > 0.01)) return;
  const Vector3 color = share < kOrange ? Vector3(0.10, 0.66, 0.30)
                        : share <= kRed ? Vector3(0.97, 0.58, 0.08)
                                        : Vector3(0.86, 0.13, 0.15);
  const Vector3 from = FromRecord(hand.virtual_.pose).p;
  const Pose X = Along(from, from + force);
  const double head = std::min(0.06, 0.6 * length);
  Draw(ConeCorners(0.009, 0, 0.009, length - head), X, color, raster);
  Draw(ConeCorners(0.024, length - head, 0, length), X, color, raster);
}

class Scenery {
 public:
  explicit Scenery(const Scenario& scenario)
      : scenario_(scenario),
        cobot_(scenario, scenario.cobot.model, scenario.cobot.remove_links,
               scenario.cobot.base.ToPose()),
        object_(LoadObject(scenario.object, scenario.folder())) {
    if (scenario.mode == Mode::kDirect) return;
    for (int h = 0; h < kHands; ++h)
      if (scenario.Has(h)) {
        const ArmSpec& arm = scenario.arm(h);
        arms_[static_cast<std::size_t>(h)] =
            std::make_unique<Figure>(scenario, arm.model, arm.remove_links, scenario.X_WB(h));
      }
  }

  std::string Picture(const TickRecord& record, const RasterCamera& camera) {
    Raster raster(kWidth, kHeight, camera);
    DrawGrid(&raster);
    cobot_.Show(record.cobot_q.data(), kCobot, &raster);
    const Pose X_WO = FromRecord(record.object.pose);
    for (const ModelShape& shape : object_.visuals)
      Draw(CornersOf(shape), X_WO * shape.X_LG, {shape.color[0], shape.color[1], shape.color[2]},
           &raster);
    for (int h = 0; h < kHands; ++h) DrawHand(h, record, &raster);
    raster.ForgetDepth();  // a force must be visible even if the object hides the handle
    const double threshold = scenario_.safety.force;
    for (const HandRecord& hand : record.hands)
      if (hand.present != 0) DrawForce(hand, threshold, &raster);
    return raster.Png();
  }

 private:
  void DrawHand(int h, const TickRecord& record, Raster* raster) {
    const HandRecord& hand = record.hands[static_cast<std::size_t>(h)];
    if (hand.present == 0) return;
    Draw(ConeCorners(kHandleRadius, -kHandleLength / 2, kHandleRadius, kHandleLength / 2),
         FromRecord(hand.virtual_.pose), kHandle, raster);
    Figure* arm = arms_[static_cast<std::size_t>(h)].get();
    if (arm == nullptr) return;
    arm->Show(hand.q.data(), kArms, raster);
    const Vector3 flange = arm->LinkPose(scenario_.arm(h).end_effector).p;
    const Vector3 handle = FromRecord(hand.real.pose).p;
    Draw(ConeCorners(kRodRadius, 0, kRodRadius, (handle - flange).norm()), Along(flange, handle),
         kArms, raster);
  }

  const Scenario& scenario_;
  Figure cobot_;
  ObjectModel object_;
  std::array<std::unique_ptr<Figure>, kHands> arms_;
};

// Returns a camera above the operator's side, directed at the load of the cobot.
RasterCamera CameraOf(const Scenario& scenario) {
  const Vector3 base = scenario.cobot.base.xyz;
  return {base + Vector3(2.3, -1.55, 1.15), base + Vector3(0.33, 0.03, 0.14), 0.5};
}

}  // namespace

std::vector<ReproducedImage> ReproduceSnapshots(const ReproducedRun& run,
                                                const std::string& prefix) {
  const Scenario& scenario = run.data.info.scenario;
  Scenery scenery(scenario);
  std::vector<ReproducedImage> images;
  for (const TickRecord& record : run.moments)
    images.push_back({prefix + "-" + std::to_string(std::lround(record.run_time)) + "s",
                      scenery.Picture(record, CameraOf(scenario))});
  return images;
}

}  // namespace predictor
