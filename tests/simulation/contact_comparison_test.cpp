// Compares contact in both engines with closed forms. Also compares the measured values and the
// closed forms with docs/contact.csv.
#include <cstdio>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "free_body.h"
#include "simulation/dart/dart_process.h"
#include "support/test_name.h"

namespace predictor {
namespace {

constexpr double kReproducible = 1e-3;  // of a row of the file, relative
constexpr const char* kFile = PREDICTOR_SOURCE_DIR "/docs/contact.csv";
constexpr const char* kPage = PREDICTOR_SOURCE_DIR "/docs/how-to/engines.md";

struct Result {
  double value, closed_form;
};

// A quantity for which each engine's law of contact gives a closed form.
struct Case {
  std::string name, quantity;
  std::function<Result(EngineKind)> measure;
};

std::string Number(double value, const char* format = "%.5g") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// ---- the cases ---------------------------------------------------------------------------------

Case BlockOnAnIncline(double friction) {
  return {"block on an incline of 20°, friction " + Number(friction), "path in 1 s [m]",
          [friction](EngineKind kind) -> Result {
            FreeBody body(Shape::kBox, kBlock, {Slope(FixtureShape::kBox, friction)}, kGravity,
                          kind);
            const Pose start = OnSlope(kBlock.z() / 2);
            body.Place(start);
            body.Run(1);
            const double a = kGravity * (std::sin(kSlope) - friction * std::cos(kSlope));
            return {(body.pose().p - start.p).norm(), a / 2};
          }};
}

// Without gravity, both engines have the same closed form.
Case BallAgainstAWall(double zeta) {
  return {"ball that hits a wall at 2 m/s, damping ratio " + Number(zeta), "share of its speed [1]",
          [zeta](EngineKind kind) -> Result {
            constexpr double kRadius = 0.2, kSpeed = 2;  // [m], [m/s]
            constexpr double kFrequency = 25;            // of MuJoCo's contact [rad/s]
            FixtureSpec wall = Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin);
            wall.damping_ratio = zeta;
            if (kind == EngineKind::kMujoco) wall.time_constant = 1 / (kFrequency * zeta);
            FreeBody body(Shape::kSphere, {kRadius, 0, 0}, {wall}, 0, kind);
            body.Place({kOrigin + Vector3(0, 0, kRadius + 0.01), Quaternion::Identity()},
                       {0, 0, -kSpeed});
            body.Run(0.4);
            return {body.velocity().z() / kSpeed, Restitution(zeta)};
          }};
}

// In MuJoCo, the fixture has a stiffness, so it is a spring and damper, and the closed form
// includes the ball's weight. In DART, the impact is over in an instant.
Case FallingBall(double zeta) {
  return {"ball that falls 0.815 m, damping ratio " + Number(zeta), "height of the rebound [m]",
          [zeta](EngineKind kind) -> Result {
            constexpr double kRadius = 0.2, kSpeed = 4;  // [m], [m/s]
            constexpr double kFrequency = 50;            // of MuJoCo's contact [rad/s]
            const double height = kSpeed * kSpeed / (2 * kGravity);
            const bool is_rigid = kind == EngineKind::kDart;
            FixtureSpec ground = Fixture(FixtureShape::kPlane, {1, 1, 0}, kOrigin);
            if (is_rigid) {
              ground.damping_ratio = zeta;
            } else {
              ground.stiffness = kBodyMass * kFrequency * kFrequency;
              ground.damping = 2 * zeta * kBodyMass * kFrequency;
            }
            FreeBody body(Shape::kSphere, {kRadius, 0, 0}, {ground}, kGravity, kind);
            body.Place({kOrigin + Vector3(0, 0, kRadius + height), Quaternion::Identity()});
            body.Run(kSpeed / kGravity + (is_rigid ? 0.002 : 0.05));
            const double e = Restitution(zeta);
            return {body.Rise(0.5, kOrigin.z() + kRadius),
                    is_rigid ? e * e * height : HeightOfBounce(kFrequency, zeta, kSpeed)};
          }};
}

Case PegAgainstAWall(double force) {
  return {
      "peg pressed against a wall with " + Number(force) + " N, friction 0.5", "path in 0.5 s [m]",
      [force](EngineKind kind) -> Result {
        constexpr double kFriction = 0.5, kRadius = 0.05, kLength = 0.04, kTime = 0.5;
        FixtureSpec wall = Fixture(FixtureShape::kBox, {0.1, 2, 8}, kOrigin + Vector3(0.05, 0, 0));
        wall.friction = kFriction;
        FreeBody body(Shape::kCylinder, {kRadius, kLength, 0}, {wall}, kGravity, kind);
        const Pose start = PoseFromXyzRpy(kOrigin - Vector3(kLength / 2, 0, 0), {0, M_PI / 2, 0});
        body.Place(start);
        Wrench F = Wrench::Zero();
        F[0] = force;
        body.Run(kTime, F);
        const double a = kGravity - kFriction * force / kBodyMass;
        return {start.p.z() - body.pose().p.z(), a * kTime * kTime / 2};
      }};
}

// A stop must take at least 50 steps of 1 ms. In each step, the body moves at the speed that
// belongs to the end of the step. The path is therefore too short by half a step at the initial
// speed.
Case SlidingStop(double friction, double speed) {
  return {"block that slides at " + Number(speed) + " m/s, friction " + Number(friction),
          "path until it stops [m]", [=](EngineKind kind) -> Result {
            FreeBody body(Shape::kBox, kBlock, {TableTop(friction)}, kGravity, kind);
            const Vector3 start = kOrigin + Vector3(0, 0, kBlock.z() / 2);
            body.Place({start, Quaternion::Identity()}, {speed, 0, 0});
            body.Run(speed / (friction * kGravity) + 0.3);
            return {(body.pose().p - start).x(), speed * speed / (2 * friction * kGravity)};
          }};
}

// Measures the largest force at the height of the centre of mass at which the box does not tip. The
// relative error is at most a thousandth.
Case TippingBox() {
  return {"box of 0.1 m × 0.3 m, pushed at half its height", "force that tips it [N]",
          [](EngineKind kind) -> Result {
            const Vector3 size = {0.1, 0.2, 0.3};
            const double critical = kBodyMass * kGravity * size.x() / size.z();
            FreeBody body(Shape::kBox, size, {TableTop(0.8)}, kGravity, kind);
            double holds = 0.97 * critical, tips = 1.03 * critical;
            while (tips - holds > 1e-3 * critical) {
              Wrench F = Wrench::Zero();
              F[0] = (holds + tips) / 2;
              body.Place({kOrigin + Vector3(0, 0, size.z() / 2), Quaternion::Identity()});
              body.Run(0.2);
              body.Run(1.5, F);
              (body.tilt() > 0.3 ? tips : holds) = F[0];
            }
            return {(holds + tips) / 2, critical};
          }};
}

std::vector<Case> Cases() {
  return {BlockOnAnIncline(0),   BlockOnAnIncline(0.2), BallAgainstAWall(0.05),
          BallAgainstAWall(0.2), FallingBall(0.05),     FallingBall(0.2),
          PegAgainstAWall(20),   PegAgainstAWall(30),   SlidingStop(0.3, 0.5),
          SlidingStop(0.8, 0.5), TippingBox()};
}

// ---- the file and the page ---------------------------------------------------------------------

constexpr const char* kHeader = "case,quantity,MuJoCo,MuJoCo's closed form,DART,DART's closed form";

struct Row {
  std::string name, quantity;
  std::vector<double> values;  // as in kHeader
};

std::vector<Row> ReadRows() {
  std::ifstream file(kFile);
  std::string line;
  EXPECT_TRUE(std::getline(file, line)) << kFile;
  EXPECT_EQ(line, kHeader);
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    // The names are quoted, because they contain commas.
    std::istringstream cells(line);
    Row row;
    std::string cell;
    cells.ignore(1);
    std::getline(cells, row.name, '"');
    cells.ignore(1);
    std::getline(cells, row.quantity, ',');
    while (std::getline(cells, cell, ',')) row.values.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

std::string Percent(double value, double of) {
  const std::string text = Number(100 * (value / of - 1), "%+.1f");
  return text == "+0.0" || text == "-0.0" ? "0.0" : text;
}

// Returns a row of the page's table.
std::string TableRow(const Row& row) {
  const std::vector<double>& v = row.values;
  std::string text = "| " + row.name + " | " + row.quantity;
  for (const std::size_t i : {std::size_t{0}, std::size_t{2}})
    text += " | " + Number(v[i + 1], "%.4g") + " | " + Number(v[i], "%.4g") + " | " +
            Percent(v[i], v[i + 1]);
  return text + " | " + Percent(v[2], v[0]) + " |";
}

class ContactComparison : public testing::TestWithParam<int> {
 protected:
  static void Compare(EngineKind kind) {
    const auto i = static_cast<std::size_t>(GetParam());
    const Case which = Cases().at(i);
    const Result result = which.measure(kind);
    std::printf("\"%s\",%s: %s,%s\n", which.name.c_str(), which.quantity.c_str(),
                Number(result.value, "%.6g").c_str(), Number(result.closed_form, "%.6g").c_str());
    EXPECT_NEAR(result.value, result.closed_form, kFormAccuracy * result.closed_form) << which.name;
    const std::vector<Row> rows = ReadRows();
    ASSERT_LT(i, rows.size()) << "docs/contact.csv lacks this case.";
    EXPECT_EQ(rows[i].name, which.name);
    EXPECT_EQ(rows[i].quantity, which.quantity);
    const std::size_t first = kind == EngineKind::kMujoco ? 0 : 2;
    const double written[] = {rows[i].values.at(first), rows[i].values.at(first + 1)};
    EXPECT_NEAR(result.value, written[0], kReproducible * written[0])
        << "If this is intended, correct docs/contact.csv and the table in docs/how-to/engines.md.";
    EXPECT_NEAR(result.closed_form, written[1], kReproducible * written[1]);
  }
};

TEST_P(ContactComparison, MujocoAgreesWithTheClosedForm) { Compare(EngineKind::kMujoco); }

TEST_P(ContactComparison, DartAgreesWithTheClosedForm) {
  if (!HasDart()) GTEST_SKIP() << "This build has no DART.";
  Compare(EngineKind::kDart);
}

INSTANTIATE_TEST_SUITE_P(Cases, ContactComparison,
                         testing::Range(0, static_cast<int>(Cases().size())),
                         [](const testing::TestParamInfo<int>& each) {
                           const Case c = Cases().at(static_cast<std::size_t>(each.param));
                           return test::TestName(c.name + " " + c.quantity);
                         });

TEST(ContactPage, ShowsTheFiguresOfTheFile) {
  std::ifstream file(kPage);
  std::stringstream page;
  page << file.rdbuf();
  for (const Row& row : ReadRows())
    EXPECT_NE(page.str().find(TableRow(row)), std::string::npos)
        << "docs/how-to/engines.md lacks the row\n"
        << TableRow(row);
}

}  // namespace
}  // namespace predictor
