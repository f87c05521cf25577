#include "commissioning/bases.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

#include "core/error.h"
#include "core/random.h"

namespace predictor::commissioning {
namespace {

Pose RandomPose(RandomStream* random) {
  const Vector3 w(random->Normal(), random->Normal(), random->Normal());
  return {{random->Normal(), random->Normal(), random->Normal()}, RotationFromVector(2 * w)};
}

// Returns points on and above a table. Both arms touch each point with an error of `noise` [m].
std::vector<TouchedPoint> Points(const Pose& X_AB, int count, double noise, RandomStream* random) {
  const std::vector<Vector3> places = {{0.3, -0.2, 0},  {0.3, 0.25, 0},   {0.7, 0, 0.02},
                                       {0.5, 0.1, 0.3}, {0.6, -0.2, 0.1}, {0.4, 0.2, 0.2}};
  const auto error = [&] {
    return Vector3(noise * random->Normal(), noise * random->Normal(), noise * random->Normal());
  };
  std::vector<TouchedPoint> points;
  for (int i = 0; i < count; ++i) {
    const Vector3 p_A = places[static_cast<std::size_t>(i)];
    points.push_back({p_A + error(), X_AB.Inverse() * p_A + error()});
  }
  return points;
}

// Computes Kabsch's solution by a singular value decomposition (Umeyama 1991).
Pose BySingularValues(const std::vector<TouchedPoint>& points) {
  Vector3 a = Vector3::Zero(), b = Vector3::Zero();
  for (const TouchedPoint& p : points) {
    a += p.p_A / static_cast<double>(points.size());
    b += p.p_B / static_cast<double>(points.size());
  }
  Matrix3 M = Matrix3::Zero();
  for (const TouchedPoint& p : points) M += (p.p_A - a) * (p.p_B - b).transpose();
  const Eigen::JacobiSVD<Matrix3> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3 signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  const Matrix3 R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return {a - R * b, Quaternion(R)};
}

TEST(CalibrateBases, IsExactWithoutNoise) {
  RandomStream random(1, "bases");
  for (int n = 0; n < 50; ++n) {
    const Pose X_AB = RandomPose(&random);
    const BaseCalibration found = CalibrateBases(Points(X_AB, 3 + n % 4, 0, &random));
    EXPECT_LT(PoseError(found.X_AB, X_AB).norm(), 1e-7);
    EXPECT_LT(found.residual, 1e-9);
  }
}

TEST(CalibrateBases, IsTheSolutionBySingularValues) {
  RandomStream random(2, "bases");
  for (int n = 0; n < 50; ++n) {
    const auto points = Points(RandomPose(&random), 3 + n % 4, 0.0008, &random);
    EXPECT_LT(PoseError(CalibrateBases(points).X_AB, BySingularValues(points)).norm(), 1e-7);
  }
}

TEST(CalibrateBases, StatesItsUncertainty) {
  RandomStream random(3, "bases");
  int held = 0, intervals = 0;
  double worst = 0;
  for (int n = 0; n < 400; ++n) {
    const Pose X_AB = RandomPose(&random);
    const BaseCalibration found = CalibrateBases(Points(X_AB, 6, 0.0007, &random));
    const Vector6 error = PoseError(found.X_AB, X_AB).cwiseAbs();
    for (int i = 0; i < 3; ++i) {
      held += (error[i] <= found.position[i]) + (error[3 + i] <= found.rotation[i]);
      intervals += 2;
    }
    const Vector3 amid(0.5, 0, 0.1);
    worst = std::max(worst, (found.X_AB * (X_AB.Inverse() * amid) - amid).norm());
  }
  const double part = 1.0 * held / intervals;
  std::printf(
      "%.1f %% of the intervals are correct; largest error of the points' centre: %.2f mm\n",
      100 * part, 1000 * worst);
  EXPECT_GE(part, 0.92);
  EXPECT_LE(part, 0.98);
  EXPECT_LT(worst, 0.002);
}

std::string RefusalOf(const std::vector<TouchedPoint>& points) {
  try {
    CalibrateBases(points);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(CalibrateBases, RefusesPointsThatDoNotDetermineTheBase) {
  RandomStream random(4, "bases");
  const Pose X_AB = RandomPose(&random);
  EXPECT_NE(RefusalOf(Points(X_AB, 2, 0, &random)).find("2 points are too few"), std::string::npos);
  std::vector<TouchedPoint> line;
  for (int i = 0; i < 5; ++i) {
    const Vector3 p_A(0.3 + 0.1 * i, 0.2 - 0.05 * i, 0.01 * (i % 2));
    line.push_back({p_A, X_AB.Inverse() * p_A});
  }
  EXPECT_NE(RefusalOf(line).find("nearly on a line"), std::string::npos);
}

TEST(CalibrateBases, NamesThePointThatMissesAndRefusesAnotherOrder) {
  RandomStream random(5, "bases");
  const Pose X_AB = RandomPose(&random);
  for (std::size_t i = 0; i < 6; ++i) {
    auto points = Points(X_AB, 6, 0.0005, &random);
    points[i].p_B += Vector3(0.02, 0, -0.02);
    const std::string refusal = RefusalOf(points);
    EXPECT_NE(refusal.find("point " + std::to_string(i + 1) + " is off"), std::string::npos)
        << refusal;
  }
  auto points = Points(X_AB, 6, 0.0005, &random);
  std::swap(points[0].p_B, points[1].p_B);
  EXPECT_NE(RefusalOf(points).find("are inconsistent"), std::string::npos);
}

}  // namespace
}  // namespace predictor::commissioning
