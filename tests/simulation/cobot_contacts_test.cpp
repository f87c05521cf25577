// Tests the contacts of the cobot's links with the carried object and with one another
// (cobot.touches). The places and torques at rest follow from geometry and from static equilibrium.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "core/file.h"
#include "event_fixtures.h"
#include "scenario/scenario_io.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

constexpr double kSpring = 400;  // of each joint's controller [N/m]
constexpr double kPush = 60;     // of the hand [N]
constexpr double kWall = 0.6;    // face of the base's wall, along x [m]
constexpr double kDeck = 0.05;   // upper face of the base's deck [m]

// A base has a deck below and a wall in front. A sledge slides along x, and a slider slides along x
// on the sledge. The slider carries a box. Everything is half a metre or more above the deck.
class SlidingLinks : public testing::Test {
 protected:
  // `sledge_x` is the place of the sledge's own box along x, in the sledge [m].
  Scenario With(const std::vector<std::string>& overrides, double sledge_x = -0.5) {
    const std::string inertial =
        R"(<inertial><mass value="2"/><inertia ixx="0.02" iyy="0.03" izz="0.025"/></inertial>)";
    const auto box = [](const std::string& xyz, const std::string& size) {
      return "<collision><origin xyz=\"" + xyz + "\"/><geometry><box size=\"" + size +
             "\"/></geometry></collision>";
    };
    const auto slide = [](const std::string& parent, const std::string& child) {
      return "<joint name=\"to_" + child + "\" type=\"prismatic\"><parent link=\"" + parent +
             "\"/><child link=\"" + child +
             "\"/><axis xyz=\"1 0 0\"/><limit lower=\"-2\" upper=\"2\" velocity=\"5\" "
             "effort=\"500\"/></joint>";
    };
    std::ofstream(folder_.path() / "slider.urdf")
        << "<robot name=\"slider\"><link name=\"base\">" << box("0 0 0", "2 1 0.1")
        << box("0.65 0 0.8", "0.1 1 0.6") << "</link><link name=\"sledge\">" << inertial
        << box(std::to_string(sledge_x) + " 0 0.8", "0.1 0.1 0.1")
        << "</link><link name=\"slider\">" << inertial << box("0.1 0 0.8", "0.2 0.1 0.1")
        << "</link>" << slide("base", "sledge") << slide("sledge", "slider") << "</robot>";
    std::ofstream(folder_.path() / "slider.yaml") << R"(predictor: 1
name: Sliding links
mode: direct
cobot:
  model: slider.urdf
  end_effector: slider
  posture: [0 m, 0 m]
  joint_friction: {viscous: 40}
  controller: {type: joint_impedance, joint_stiffness: 400, joint_damping_ratio: 1}
object:
  primitive: {shape: box, size: [0.1, 0.3, 0.1], mass: 1}
  attachment: {joint: fixed, on_end_effector: {xyz: [0.05, 0, 0.6]}}
handles: {left: {xyz: [0, 0, 0]}}
operator: {type: virtual, script: []}
environment: {floor: false}
)";
    return LoadScenario(folder_.path() / "slider.yaml", overrides);
  }

  test::TemporaryFolder folder_;
};

double Moved(const World& world, const Scenario& s) {
  return world.state().object.X_W.p.x() - World(s).state().object.X_W.p.x();
}

// The slider meets the wall of the base after 0.4 m. The springs of both joints then carry half of
// this path each, and the wall carries the rest of the push. Without the contact, each spring
// carries the whole push.
TEST_F(SlidingLinks, ALinkStopsAtAnotherLink) {
  constexpr double kGap = kWall - 0.2;  // [m]
  constexpr double kStrong = 120;       // push [N]
  for (const bool touches : {false, true}) {
    const Scenario s = With({touches ? "cobot.touches=[cobot]" : "cobot.touches=[]"});
    World world(s);
    RunWith(&world, Push(s, {kStrong, 0, 0}), 4);
    const double moved = touches ? kGap : 2 * kStrong / kSpring;
    EXPECT_NEAR(Moved(world, s), moved, 1e-4) << touches;
    for (int j = 0; j < 2; ++j)
      EXPECT_NEAR(world.state().torque[j], -kSpring * moved / 2, 0.05) << touches << j;
  }
}

// The box slides on its attachment until it meets the wall, which carries the push. The joints of
// the cobot, whose springs carry nothing, stay where they are.
TEST_F(SlidingLinks, TheCarriedObjectStopsAtALink) {
  constexpr double kGap = kWall - 0.1;  // [m]
  for (const bool touches : {false, true}) {
    const Scenario s = With({"object.attachment.joint=prismatic",
                             "object.attachment.axis=[1, 0, 0]", "object.attachment.damping=40",
                             touches ? "cobot.touches=[object]" : "cobot.touches=[cobot]"});
    World world(s);
    RunWith(&world, Push(s, {kPush, 0, 0}), 6);
    if (touches) {
      EXPECT_NEAR(Moved(world, s), kGap, 1e-4);
      EXPECT_LT(world.state().object.V_W.norm(), 1e-4);
      EXPECT_LT(world.state().torque.norm(), 0.05);
    } else {
      EXPECT_GT(Moved(world, s), 2 * kGap);
    }
  }
}

// The gripper opens. The box falls freely, and then rests on the deck of the base, which no joint
// moves.
TEST_F(SlidingLinks, TheReleasedObjectFallsOntoALink) {
  for (const bool touches : {false, true}) {
    Scenario s = With({touches ? "cobot.touches=[object]" : "cobot.touches=[]"});
    s.events = {Event("release_object", 0.1)};
    World world(s);
    RunWith(&world, HandsOff(s), 0.1);
    const double start = world.state().object.X_W.p.z();
    const int ticks =
        static_cast<int>(std::sqrt(2 * (start - kDeck - 0.05) / kGravity) / kTick) - 2;
    RunWith(&world, HandsOff(s), ticks * kTick);
    EXPECT_NEAR(world.state().object.X_W.p.z(),
                start - kGravity * kTick * kTick * ticks * (ticks + 1) / 2, 1e-8);
    RunWith(&world, HandsOff(s), 1);
    if (touches)
      EXPECT_NEAR(world.state().object.X_W.p.z(), kDeck + 0.05, 1e-4);
    else
      EXPECT_LT(world.state().object.X_W.p.z(), kDeck);  // a soft support at z = 0 stops it
  }
}

// Returns the pairs that can touch, and "(overlap)" or the reason after those that cannot.
std::string Text(const std::vector<ContactPair>& pairs) {
  constexpr const char* kStates[] = {"", "(overlap)", "(joint)", "(body)", "(holds)"};
  std::string text;
  for (const ContactPair& pair : pairs)
    text += pair.link + "-" + (pair.other.empty() ? "object" : pair.other) +
            kStates[static_cast<int>(pair.state)] + " ";
  return text;
}

// Links that a joint connects are never a pair. The slider is the hand, so it does not touch what
// it holds.
TEST_F(SlidingLinks, PairsThatAlwaysTouchAreLeftOut) {
  EXPECT_EQ(Text(World(With({})).contact_pairs()), "");
  EXPECT_EQ(Text(World(With({"cobot.touches=[object]"})).contact_pairs()),
            "base-object sledge-object slider-object(holds) ");
  EXPECT_EQ(Text(World(With({"cobot.touches=[cobot]"})).contact_pairs()),
            "base-slider base-sledge(joint) sledge-slider(joint) ");
  // At this posture, the slider is 10 cm inside the wall.
  const Scenario s = With({"cobot.touches=[cobot]", "cobot.posture=[0.2 m, 0.3 m]"});
  World world(s);
  EXPECT_EQ(Text(world.contact_pairs()),
            "base-slider(overlap) base-sledge(joint) sledge-slider(joint) ");
  const Scenario free = With({"cobot.posture=[0.2 m, 0.3 m]"});
  World other(free);
  RunWith(&world, Push(s, {-kPush, 0, 0}), 0.3);
  RunWith(&other, Push(s, {-kPush, 0, 0}), 0.3);
  EXPECT_EQ((world.state().q - other.state().q).norm(), 0);
}

// A link without a shape separates nothing: its neighbours touch each other permanently.
TEST_F(SlidingLinks, NeighboursOfALinkWithoutShapesAreLeftOut) {
  With({});
  std::string text = ReadWholeFile(folder_.path() / "slider.urdf");
  const std::size_t sledge = text.find("<collision>", text.find("\"sledge\""));
  text.erase(sledge, text.find("</collision>", sledge) + 12 - sledge);
  std::ofstream(folder_.path() / "slider.urdf") << text;
  const auto with = [&](const std::string& touches) {
    return LoadScenario(folder_.path() / "slider.yaml", {"cobot.touches=" + touches});
  };
  EXPECT_EQ(Text(World(with("[object]")).contact_pairs()), "base-object slider-object(holds) ");
  EXPECT_NE(RefusalOf(with("[cobot]")).find("with <collision> are neighbours"), std::string::npos);
}

// The hulls of the Panda's wrist overlap in every posture. The object hangs at link 8, which is
// fixed to link 7.
TEST(CobotContacts, OfThePandaAreThoseOfLinksThatAJointDoesNotConnect) {
  Scenario s = RigidBox();
  s.cobot.touches = {"object", "cobot"};
  const std::vector<ContactPair> pairs = World(s).contact_pairs();
  int with_object = 0, with_link = 0;
  for (const ContactPair& pair : pairs) {
    const int a = pair.link.back() - '0';
    const int b = pair.other.empty() ? 8 : pair.other.back() - '0';
    if (pair.other.empty()) {
      EXPECT_EQ(pair.state, a < 7 ? PairState::kCanTouch : PairState::kHolds) << Text({pair});
      ++with_object;
    } else {
      EXPECT_EQ(pair.state == PairState::kJoint, b - a == 1) << Text({pair});
      ++with_link;
    }
    if (b - a > 2) {
      EXPECT_EQ(pair.state, PairState::kCanTouch) << Text({pair});
    }
    if (pair.state == PairState::kCanTouch) {
      EXPECT_GT(pair.distance, 0) << Text({pair});
    }
    if (pair.state == PairState::kOverlaps) {
      EXPECT_LT(pair.distance, 0.001) << Text({pair});
    }
  }
  EXPECT_EQ(with_object, 8);  // links 0 to 7
  EXPECT_EQ(with_link, 8 * 7 / 2);
}

// The base's mesh has holes for screws.
TEST(CobotContacts, DoNotRequireLinksWithoutHoles) {
  Scenario s = RigidBox();
  s.cobot.model = "package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf";
  s.cobot.remove_links.clear();
  s.cobot.end_effector = "tool0";
  s.cobot.posture = {0, -1.2, 1.8, -2.17, -1.57, 0};
  s.cobot.touches = {"object", "cobot"};
  ASSERT_EQ(RefusalOf(s), "");
  const std::string text = Text(World(s).contact_pairs());
  EXPECT_NE(text.find("base_link-object "), std::string::npos) << text;
  EXPECT_NE(text.find("base_link-forearm_link "), std::string::npos) << text;
}

// The solver's warm start is part of the state.
TEST_F(SlidingLinks, ASavedStateContinuesBitForBit) {
  Scenario s = With({"cobot.touches=[object, cobot]"});
  for (const bool released : {false, true}) {
    if (released) s.events = {Event("release_object", 0.2)};
    const WorldInput input = Push(s, {150, 3, -2});
    for (const double saved_at : {0.3, 0.9}) {
      World world(s), other(s);
      RunWith(&other, HandsOff(s), 0.07);  // leaves traces that the loaded state must replace
      RunWith(&world, input, saved_at);
      CopyState(&world, &other);
      for (int round = 0; round < 2; ++round) {
        RunWith(&world, input, 0.4);
        RunWith(&other, input, 0.4);
        EXPECT_EQ((world.state().q - other.state().q).norm(), 0) << released << saved_at;
        EXPECT_EQ((world.state().object.X_W.p - other.state().object.X_W.p).norm(), 0) << released;
        EXPECT_EQ((world.state().object.V_W - other.state().object.V_W).norm(), 0) << released;
        world.Reset();
        other.Reset();
      }
    }
  }
}

TEST_F(SlidingLinks, TheTickDoesNotUseTheHeap) {
  Scenario s = With({"cobot.touches=[object, cobot]"});
  ExpectNoHeap(s, {150, 3, -2}, 900);
  s.events = {Event("release_object", 0.2)};
  ExpectNoHeap(s, {150, 3, -2}, 900);
}

// ---- bad input ---------------------------------------------------------------------------------

// The sledge's box is 1 cm inside the carried box. No posture of the slider alone is involved.
TEST_F(SlidingLinks, AStartInWhichTheObjectIsInsideALinkIsRefused) {
  const std::vector<std::string> inside = {"cobot.touches=[object]", "cobot.posture=[0 m, 0 m]",
                                           "object.attachment.on_end_effector.xyz=[0.05, 0, 0.79]"};
  EXPECT_EQ(
      RefusalOf(With(inside, -0.04)),
      "cobot.touches | cobot.touches: at the start, after the cobot sagged under its load, the "
      "object is 10 mm inside the cobot's link \"sledge\". Choose another cobot.posture, place "
      "the object further away with object.attachment.on_end_effector, or remove object from "
      "this list.");
  EXPECT_EQ(RefusalOf(With({inside[1], inside[2]}, -0.04)), "");
}

TEST_F(SlidingLinks, ThatHaveNoShapesAreRefused) {
  With({});
  std::string text = ReadWholeFile(folder_.path() / "slider.urdf");
  for (std::size_t at; (at = text.find("<collision>")) != std::string::npos;)
    text.erase(at, text.find("</collision>", at) + 12 - at);
  std::ofstream(folder_.path() / "slider.urdf") << text;
  EXPECT_EQ(RefusalOf(LoadScenario(folder_.path() / "slider.yaml", {"cobot.touches=[cobot]"})),
            "cobot.touches | cobot.touches is given, but " + (folder_ / "slider.urdf").string() +
                " has no <collision>, so nothing would collide. Add <collision> to the links in "
                "this file, or remove this key.");
}

// Without the shapes of the base, the sledge and the slider remain, which a joint connects. Without
// those of the sledge, only the slider remains, which holds the object.
TEST_F(SlidingLinks, OfWhichNoneCanTouchAreRefused) {
  With({});
  std::string text = ReadWholeFile(folder_.path() / "slider.urdf");
  const auto expect_refusal = [&](const std::string& word, const std::string& reason) {
    std::ofstream(folder_.path() / "slider.urdf") << text;
    EXPECT_EQ(
        RefusalOf(LoadScenario(folder_.path() / "slider.yaml", {"cobot.touches=[" + word + "]"})),
        "cobot.touches | cobot.touches contains " + word + ", but the only links of " +
            (folder_ / "slider.urdf").string() + " with <collision> " + reason +
            ", so nothing would collide. Add <collision> to other links, or remove " + word +
            " from this list.");
  };
  const auto erase_first_shape = [&] {
    const std::size_t at = text.find("<collision>");
    text.erase(at, text.find("</collision>", at) + 12 - at);
  };
  erase_first_shape();
  erase_first_shape();
  expect_refusal("cobot", "are neighbours");
  erase_first_shape();
  expect_refusal("object", "belong to the hand that holds the object");
}

}  // namespace
}  // namespace predictor
