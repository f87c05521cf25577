#include "ergonomics/contact_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/error.h"

namespace predictor::ergonomics {
namespace {

const std::string kHeader =
    "region,point,force_N,pressure_N_per_cm2,transient_factor,stiffness_N_per_mm,mass_kg\n";
const std::string kStart = "# limits\nedition,test edition\n" + kHeader;

std::string ErrorOf(const std::string& text) {
  try {
    ParseContactLimits(text, "limits.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void ExpectError(const std::string& text, const std::string& place, const std::string& advice) {
  const std::string error = ErrorOf(text);
  EXPECT_EQ(error.find(place + ": "), 0u) << error;
  EXPECT_NE(error.find(advice), std::string::npos) << error;
}

TEST(ContactLimitFile, IsReadInSiUnits) {
  const ContactLimits limits =
      ParseContactLimits(kStart + "\n hand/finger , palm,140,260,2,75,0.6\r\n", "limits.csv");
  EXPECT_EQ(limits.edition, "test edition");
  ASSERT_EQ(limits.points.size(), 1u);
  const ContactLimit& palm = limits.points[0];
  EXPECT_EQ(palm.region, "hand/finger");
  EXPECT_EQ(palm.point, "palm");
  EXPECT_EQ(palm.force, 140);
  EXPECT_EQ(palm.pressure, 2.6e6);
  EXPECT_EQ(palm.stiffness, 75e3);
  EXPECT_EQ(palm.mass, 0.6);
  EXPECT_EQ(ForceLimit(palm, ContactKind::kTransient), 280);
  EXPECT_EQ(PressureLimit(palm, ContactKind::kQuasiStatic), 2.6e6);
}

TEST(ContactLimitFile, RefusesWhatItCannotUse) {
  ExpectError("", "limits.csv", "contains no limits");
  ExpectError(kStart, "limits.csv", "contains no limits");
  ExpectError(kHeader, "limits.csv:1", "Begin the file with a line such as");
  ExpectError("edition,\n" + kHeader, "limits.csv:1", "does not name its edition");
  ExpectError("edition,x\nregion,point\n", "limits.csv:2", "it must be region,point,force_N");
  ExpectError(kStart + "chest,sternum,140,120,2,25\n", "limits.csv:4", "7 columns");
  ExpectError(kStart + "chest,,140,120,2,25,40\n", "limits.csv:4", "Name both");
  ExpectError(kStart + "chest,sternum,-1,120,2,25,40\n", "limits.csv:4", "force_N is \"-1\"");
  ExpectError(kStart + "chest,sternum,140 N,120,2,25,40\n", "limits.csv:4", "without a unit");
  ExpectError(kStart + "chest,sternum,140,nan,2,25,40\n", "limits.csv:4", "pressure_N_per_cm2");
  ExpectError(kStart + "chest,sternum,140,120,0.5,25,40\n", "limits.csv:4", "at least 1");
  const std::string row = "chest,sternum,140,120,2,25,40\n";
  ExpectError(kStart + row + row, "limits.csv:5", "twice");
  ExpectError(kStart + row + "chest,pectoral,150,170,2,25,40\n", "limits.csv:5",
              "belong to the region");
  EXPECT_THROW(ReadContactLimits("/nowhere/limits.csv"), InputError);
}

// The shipped file states that the user must confirm its values.
TEST(ContactLimitFile, ShippedTemplateIsComplete) {
  const ContactLimits limits =
      ReadContactLimits(std::string(PREDICTOR_SOURCE_DIR) + "/assets/contact_limits_template.csv");
  EXPECT_NE(limits.edition.find("to be confirmed"), std::string::npos);
  EXPECT_EQ(limits.points.size(), 29u);
  for (const ContactLimit& limit : limits.points) {
    const bool head = limit.region == "skull/forehead" || limit.region == "face";
    EXPECT_EQ(limit.transient_factor, head ? 0 : 2) << limit.point;
  }
}

const ContactLimit kHand = {"hand/finger", "palm", 140, 2.6e6, 2, 75e3, 0.6};

// The values were computed by hand: m_R = 17.8/2 + 9 = 17.9 kg, μ = 0.6·17.9/18.5 = 0.5805 kg, v =
// 280/√(0.5805·75000).
TEST(Contact, SpeedOfAHandIsThatComputedByHand) {
  const double robot = EffectiveRobotMass(17.8, 9);
  EXPECT_NEAR(robot, 17.9, 1e-12);
  const ContactSpeed result = MaxContactSpeed(kHand, {ContactKind::kTransient, robot, 0});
  EXPECT_NEAR(result.speed, 1.342, 0.0005);
  EXPECT_FALSE(result.by_pressure);
  EXPECT_NEAR(MaxContactSpeed(kHand, {ContactKind::kQuasiStatic, robot, 0}).speed, result.speed / 2,
              1e-12);
}

// The spring of the contact absorbs the whole energy of the relative motion.
TEST(Contact, EnergyIsThatOfTheReducedMass) {
  for (const double robot : {1.0, 10.0, 1000.0}) {
    const ContactSpeed result = MaxContactSpeed(kHand, {ContactKind::kTransient, robot, 0});
    EXPECT_NEAR(0.5 * ReducedMass(kHand.mass, robot) * result.speed * result.speed, result.energy,
                1e-9);
  }
  EXPECT_NEAR(ReducedMass(0.6, 1e9), 0.6, 1e-6);
}

TEST(Contact, SmallAreasAreLimitedByPressure) {
  const ContactSpeed edge = MaxContactSpeed(kHand, {ContactKind::kTransient, 18, 0.2e-4});
  EXPECT_TRUE(edge.by_pressure);  // 0.2 cm² · 520 N/cm² = 104 N
  EXPECT_NEAR(edge.energy, 104 * 104 / (2 * 75e3), 1e-9);
  EXPECT_FALSE(MaxContactSpeed(kHand, {ContactKind::kTransient, 18, 1e-2}).by_pressure);
}

TEST(Contact, IsComparedWithBothLimits) {
  const ContactRatio ratio = CompareContact(kHand, ContactKind::kTransient, 140, 7.8e6);
  EXPECT_NEAR(ratio.force, 0.5, 1e-12);
  EXPECT_NEAR(ratio.pressure, 1.5, 1e-12);
  EXPECT_FALSE(ratio.within());
  EXPECT_TRUE(CompareContact(kHand, ContactKind::kQuasiStatic, 140, 2.6e6).within());
}

TEST(Contact, OfAPointThatMustNotBeHitHasNoSpeed) {
  ContactLimit head = kHand;
  head.transient_factor = 0;
  EXPECT_EQ(MaxContactSpeed(head, {ContactKind::kTransient, 18, 0}).speed, 0);
  EXPECT_TRUE(std::isinf(CompareContact(head, ContactKind::kTransient, 1, 0).force));
  EXPECT_GT(MaxContactSpeed(head, {ContactKind::kQuasiStatic, 18, 0}).speed, 0);
}

}  // namespace
}  // namespace predictor::ergonomics
