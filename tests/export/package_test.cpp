// Tests the other contents of a package (meshes, textures, names), and the inputs that the exporter
// refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "core/error.h"
#include "export/files.h"
#include "export/scene_package.h"
#include "export/scenes.h"
#include "models/urdf.h"
#include "support/text.h"

namespace predictor::scene_export {
namespace {

namespace fs = std::filesystem;

class Package : public testing::Test {
 protected:
  Package() : scenario(OddScene(folder.path() / "s", JointType::kSpherical)) {}

  // Writes an object with these elements in its single link.
  void SetObject(const std::string& shapes, const std::string& materials = "") {
    Write(folder.path() / "s/object.urdf", "<robot name=\"o\">" + materials +
                                               R"(<link name="a"><inertial><mass value="2"/>
            <inertia ixx="0.05" iyy="0.04" izz="0.03"/></inertial>)" +
                                               shapes + "</link></robot>");
  }
  static std::string Mesh(const std::string& file, const std::string& material = "") {
    return "<visual><geometry><mesh filename=\"" + file + "\"/></geometry>" + material +
           "</visual>";
  }
  void Put(const std::string& path, const std::string& text) {
    Write(folder.path() / "s" / path, text);
  }
  std::map<std::string, std::string> Exported() {
    package = MakeScenePackage(scenario);
    WriteScenePackage(package, folder.path() / "out", false);
    return Files(folder.path() / "out");
  }
  std::string Refusal() const {
    try {
      MakeScenePackage(scenario);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  test::TemporaryFolder folder;
  Scenario scenario;
  ScenePackage package;
};

TEST_F(Package, GivesFilesOfOneNameTwoNames) {
  Put("a/part.stl", "first");
  Put("b/Part.STL", "second");
  Put("b/part.obj", "v 0 0 0\n");
  Put("b/ä part.obj", "third");
  SetObject(Mesh("a/part.stl") + Mesh("b/Part.STL") + Mesh("b/part.obj") + Mesh("a/part.stl") +
            Mesh("b/ä part.obj"));
  const auto files = Exported();
  EXPECT_EQ(files.at("meshes/visual_part.stl"), "first");
  EXPECT_EQ(files.at("meshes/visual_Part_2.stl"), "second");
  EXPECT_EQ(files.at("meshes/visual_part_3.obj"), "v 0 0 0\n");
  EXPECT_EQ(files.at("meshes/visual____part.obj"), "third");
  const UrdfModel urdf = ReadUrdf(folder.path() / "out/scene.urdf");
  for (const UrdfLink& link : urdf.links) {
    if (link.name != "object") continue;
    ASSERT_EQ(link.visuals.size(), 5u);
    EXPECT_EQ(link.visuals[3].mesh, link.visuals[0].mesh);
    EXPECT_EQ(link.visuals[1].mesh.filename(), "visual_Part_2.stl");
  }
}

TEST_F(Package, IncludesTexturesAndReportsMissingOnes) {
  const std::string dae = R"(<COLLADA><library_images>
      <image id="a"><init_from>../textures/wood.png</init_from></image>
      <image id="b"><init_from><ref> ../textures/WOOD.jpg </ref></init_from></image>
      <image id="c"><init_from>/home/jane/lost.png</init_from></image></library_images>
      <surface><init_from>a</init_from></surface></COLLADA>)";
  Put("meshes/box.dae", dae);
  Put("meshes/lid.obj", "mtllib lid.mtl\nv 0 0 0\r\nusemtl wood");
  Put("meshes/lid.mtl", "newmtl wood\nKd 1 1 1\nmap_Kd -s 1 1 1 ../textures/wood.png\n");
  Put("textures/wood.png", "png");
  Put("textures/WOOD.jpg", "jpg");
  SetObject(Mesh("meshes/box.dae") + Mesh("meshes/lid.obj"));
  const auto files = Exported();
  const std::string out = files.at("meshes/visual_box.dae");
  EXPECT_TRUE(Contains(out, "<init_from>texture_wood.png</init_from>")) << out;
  EXPECT_TRUE(Contains(out, "<ref>texture_WOOD_2.jpg</ref>")) << out;
  EXPECT_TRUE(Contains(out, "<init_from>lost.png</init_from>")) << out;
  EXPECT_TRUE(Contains(out, "<surface><init_from>a</init_from></surface></COLLADA>")) << out;
  EXPECT_FALSE(Contains(out, "jane")) << out;
  EXPECT_EQ(files.at("meshes/texture_wood.png"), "png");
  EXPECT_EQ(files.at("meshes/texture_WOOD_2.jpg"), "jpg");
  EXPECT_EQ(files.at("meshes/visual_lid.obj"), "mtllib material_lid.mtl\nv 0 0 0\r\nusemtl wood");
  EXPECT_EQ(files.at("meshes/material_lid.mtl"),
            "newmtl wood\nKd 1 1 1\nmap_Kd -s 1 1 1 texture_wood.png\n");
  ASSERT_EQ(package.notes.size(), 1u);
  EXPECT_TRUE(Contains(package.notes[0], "box.dae")) << package.notes[0];
  EXPECT_TRUE(Contains(package.notes[0], "lost.png")) << package.notes[0];
  const std::string& readme = files.at("README.txt");
  EXPECT_TRUE(Contains(readme, "Not found and therefore omitted: lost.png of box.dae.")) << readme;
  EXPECT_FALSE(Contains(readme, "jane")) << readme;
  EXPECT_FALSE(Contains(readme, folder.path().string())) << readme;
}

// A mesh without a material must keep the colours of its file. A mesh with a material must get that
// material under a unique name.
TEST_F(Package, KeepsMaterials) {
  Put("a.stl", "");
  Put("b.stl", "");
  Put("c.stl", "");
  Put("d.stl", "");
  Put("cloth.png", "cloth");
  SetObject(Mesh("a.stl") + Mesh("b.stl", "<material name=\"m\"/>") +
                Mesh("c.stl", "<material name=\"t\"/>") +
                Mesh("d.stl", "<material name=\"m\"><color rgba=\"0 1 0 1\"/></material>"),
            "<material name=\"m\"><color rgba=\"1 0 0 0.5\"/></material>"
            "<material name=\"t\"><texture filename=\"cloth.png\"/></material>");
  const auto files = Exported();
  const std::string& urdf = files.at("scene.urdf");
  const auto after = [&](const std::string& mesh) {
    const std::size_t at = urdf.find(mesh);
    return urdf.substr(at, urdf.find("</visual>", at) - at);
  };
  EXPECT_FALSE(Contains(after("visual_a.stl"), "material"));
  EXPECT_TRUE(Contains(after("visual_b.stl"), "<material name=\"rgba_1_0_0_0.5\">"));
  EXPECT_TRUE(Contains(after("visual_b.stl"), "<color rgba=\"1 0 0 0.5\"/>"));
  EXPECT_TRUE(Contains(after("visual_c.stl"), "<texture filename=\"meshes/texture_cloth.png\"/>"));
  EXPECT_TRUE(Contains(after("visual_d.stl"), "<color rgba=\"0 1 0 1\"/>"));
  EXPECT_EQ(files.at("meshes/texture_cloth.png"), "cloth");
}

TEST_F(Package, RenamesOnlyNamesThatTheSceneUses) {
  Exported();
  const UrdfModel urdf = ReadUrdf(folder.path() / "out/scene.urdf");
  const std::vector<std::string> expected = {"world",
                                             "cobot_world",
                                             "cobot_object_",
                                             "cobot_object",
                                             "tip",
                                             "branch",
                                             "attachment_x_link",
                                             "attachment_y_link",
                                             "attachment_z_link",
                                             "object",
                                             "left_handle",
                                             "floor",
                                             "table",
                                             "fixture_0",
                                             "fixture_1",
                                             "fixture_2",
                                             "fixture_3",
                                             "fixture_4"};
  EXPECT_EQ(urdf.LinkNames(), expected);
}

// A subject who sees the scene in Unity must not see the fixture before the event.
TEST_F(Package, LeavesOutAFixtureThatAnEventLetsAppear) {
  scenario.environment.fixtures[1].name = "wall";
  EventSpec event;
  event.event = "obstacle_appears";
  event.Set("fixture=wall");
  scenario.events = {event};
  Exported();
  const std::vector<std::string> links = ReadUrdf(folder.path() / "out/scene.urdf").LinkNames();
  EXPECT_EQ(std::ranges::count(links, "fixture_0"), 1);
  EXPECT_EQ(std::ranges::count(links, "fixture_1"), 0);
  EXPECT_EQ(std::ranges::count(links, "fixture_2"), 1);
}

TEST_F(Package, RefusesAMeshThatUrdfImporterDoesNotRead) {
  for (const std::string name : {"part.ply", "part.msh", "part"}) {
    Put(name, "");
    SetObject(Mesh(name));
    const std::string refusal = Refusal();
    EXPECT_TRUE(Contains(refusal, "object.urdf:")) << refusal;
    EXPECT_TRUE(Contains(refusal, name)) << refusal;
    EXPECT_TRUE(Contains(refusal, "reads only .dae, .stl and .obj")) << refusal;
  }
}

TEST_F(Package, RefusesWhatDoesNotFitTheCobot) {
  const struct {
    std::function<void(Scenario*)> change;
    const char* sentence;
  } cases[] = {
      {[](Scenario* s) {
         s->cobot.effort_limit = {1, 2};
       },
       "cobot.effort_limit has 2 values"},
      {[](Scenario* s) { s->cobot.joint_friction.viscous = {}; },
       "cobot.joint_friction.viscous has 0 values"},
      {[](Scenario* s) {
         s->cobot.joint_friction.coulomb = {1, 2, 3, 4};
       },
       "cobot.joint_friction.coulomb has 4 values"},
      {[](Scenario* s) { s->cobot.end_effector = "tipp"; }, "cobot.end_effector: "},
      {[](Scenario* s) { s->cobot.remove_links = {"thumb"}; }, "cobot.remove_links.0: "},
      {[](Scenario* s) { s->cobot.model = "../elsewhere.urdf"; }, "cobot.model: "},
      {[](Scenario* s) { s->object.model = "nothing.urdf"; }, "object.model: "},
  };
  for (const auto& c : cases) {
    const Scenario whole = scenario;
    c.change(&scenario);
    EXPECT_TRUE(Contains(Refusal(), c.sentence)) << c.sentence << "\n" << Refusal();
    scenario = whole;
  }
  EXPECT_EQ(Refusal(), "");
}

}  // namespace
}  // namespace predictor::scene_export
