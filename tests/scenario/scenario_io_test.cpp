#include "scenario/scenario_io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/random.h"
#include "fixture.h"
#include "scenario/catalogue.h"
#include "scenario/field_walk.h"

namespace predictor {
namespace {

TEST(Scenario, ReadsEveryNotation) {
  const Scenario s = Fixture();
  EXPECT_EQ(s.name, "Box of 9 kg, two handles underneath");
  EXPECT_EQ(s.mode, Mode::kEmulate);
  EXPECT_EQ(s.cobot.posture, (std::vector<double>{0, -0.3, 0, -2.0, 0, 1.7, 0.785}));
  EXPECT_EQ(s.cobot.joint_friction.viscous, std::vector<double>{1.0});
  ASSERT_TRUE(s.object.primitive && s.object.primitive->inertia);
  EXPECT_EQ(s.object.primitive->mass, 9);
  ASSERT_TRUE(s.left_handle && s.right_handle);
  EXPECT_EQ(s.right_handle->pose.xyz, Vector3(0, -0.2, -0.15));
  EXPECT_EQ(s.device.right->base.xyz, Vector3(-0.1, -0.3, 0));
  EXPECT_TRUE(s.environment.table);
  EXPECT_EQ(s.operator_.script[2].action, "push");
  EXPECT_EQ(s.operator_.script[2].parameters.Find("force")->items[0].text, "45");
  EXPECT_FALSE(s.rendering.lead);
  EXPECT_EQ(s.file, kData / "box.yaml");
}

TEST(Scenario, OmittedKeysKeepTheirDefaults) {
  const Scenario s = Fixture(), standard;
  EXPECT_EQ(s.rate, standard.rate);
  EXPECT_EQ(s.safety.stop_jerk, standard.safety.stop_jerk);
  EXPECT_EQ(s.rig.sensor_bias, standard.rig.sensor_bias);
  EXPECT_EQ(s.device.left->loop.bandwidth, 15);
  EXPECT_FALSE(s.rig.loop);
}

TEST(Scenario, LoadsFromAFile) {
  const Scenario s = LoadScenario(kData / "box_9kg.yaml", {"seed=7"});
  EXPECT_EQ(s.seed, 7u);
  EXPECT_EQ(s.file, kData / "box_9kg.yaml");
  EXPECT_THROW(LoadScenario(kData / "missing.yaml"), InputError);
  EXPECT_THROW(LoadScenario(kData), InputError);
}

TEST(Scenario, OverridesComeBeforeTheChecks) {
  EXPECT_EQ(Fixture({"rendering.lead=0.022"}).rendering.lead, 0.022);
  EXPECT_EQ(Fixture({"operator.script.1.duration=3"})
                .operator_.script[1]
                .parameters.Find("duration")
                ->text,
            "3");
  EXPECT_EQ(Fixture({"cobot.joint_friction.viscous=[1, 2, 3]"}).cobot.joint_friction.viscous.size(),
            3u);
  EXPECT_FALSE(Fixture({"environment.table=null"}).environment.table);
  EXPECT_EQ(Fixture({"rig.loop.bandwidth=25"}).rig.loop->bandwidth, 25);
  EXPECT_EQ(Fixture({"seed=1", "seed=18446744073709551615"}).seed, UINT64_MAX);
  // The following two values are valid only together.
  EXPECT_NE(ErrorOfOverride("safety.oscillation.low=20"), "");
  EXPECT_EQ(ErrorOf(FixtureText(), {"safety.oscillation.low=20", "safety.oscillation.high=40"}),
            "");
}

TEST(Scenario, ErrorsNamePlacePathValueAndWhatIsAllowed) {
  EXPECT_EQ(ErrorOfOverride("safety.force=-3"),
            "--set safety.force: safety.force is -3 N; it must be above 0 and at most 1000 N.");
  EXPECT_EQ(ErrorOfOverride("mode=emulat"),
            "--set mode: mode is \"emulat\"; it must be one of: emulate, direct. "
            "Did you mean emulate?");
  EXPECT_EQ(ErrorOf("predictor: 1\ncobot: {model: a, end_effector: b}\nobjekt: {}\n"
                    "handles: {left: {xyz: [0, 0, 0]}}\n"),
            "box.yaml:3:1: \"objekt\" is not a key. Did you mean object?");
}

TEST(Scenario, OnlyAPersonAtThePageEndsARunWithoutADuration) {
  EXPECT_EQ(Fixture({"duration=0", "operator={type: browser}"}).duration, 0);
  try {
    Fixture({"duration=0"});
    FAIL() << "no one could end this run";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("duration is 0, which means that only a person"),
              std::string::npos)
        << error.what();
  }
}

TEST(Scenario, SeveralErrorsAreReportedInTheFilesOrder) {
  const std::string error = ErrorOf(
      "predictor: 2\nduration: -1\nseed: x\nsafety: {forse: 1}\ncobot: {end_effector: e}\n");
  const std::vector<std::string> parts = {
      "box.yaml:1:12: predictor is 2; it must be 1.", "box.yaml:2:11: duration is -1 s",
      "box.yaml:3:7: seed is \"x\"", "box.yaml:4:10: \"forse\" is not a key of safety",
      "box.yaml:5:8: cobot.model is missing"};
  std::size_t at = 0;
  for (const std::string& part : parts) {
    const std::size_t found = error.find(part, at);
    ASSERT_NE(found, std::string::npos) << part << "\nin\n" << error;
    at = found;
  }
}

TEST(Scenario, AtMostTenErrorsAreReported) {
  std::string text;
  for (int i = 0; i < 25; ++i) text += "unknown_" + std::to_string(i) + ": 1\n";
  const std::string error = ErrorOf(text);
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 10);
  EXPECT_NE(error.find("more."), std::string::npos);
}

TEST(Scenario, DirectModeNeedsNoArms) {
  EXPECT_NE(ErrorOfOverride("device={}"), "");
  EXPECT_EQ(ErrorOf(FixtureText(), {"device={}", "mode=direct"}), "");
}

TEST(Scenario, OneArmNeedsOneHandle) {
  EXPECT_NE(ErrorOfOverride("device.arms.left=null"), "");
  EXPECT_NE(ErrorOfOverride("handles.right=null"), "");
  EXPECT_EQ(ErrorOf(FixtureText(), {"device.arms.right=null", "handles.right=null"}), "");
}

TEST(Scenario, PushesMayComeDuringAMoveButMovesExcludeEachOther) {
  EXPECT_EQ(ErrorOfOverride("operator.script.2.start=4"), "");
  const std::string move = "operator.script.2={action: move, by: [0, 0, 1], start: ";
  EXPECT_NE(ErrorOfOverride(move + "4.9}").find("before operator.script.1 ends at 5 s"),
            std::string::npos);
  EXPECT_EQ(ErrorOfOverride(move + "5}"), "");
  EXPECT_EQ(ErrorOfOverride("operator.script.2={action: rotate, rotate_by: [0, 0, 1], start: 4}"),
            "");
  EXPECT_NE(ErrorOfOverride("operator.script.2.start=0.5"), "");
}

TEST(Scenario, EveryShippedScenarioLoads) {
  int count = 0;
  const auto folder = std::filesystem::path(PREDICTOR_SOURCE_DIR) / "scenarios";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_NO_THROW(LoadScenario(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

// ---- saving
// --------------------------------------------------------------------------------------

Scenario Reread(const Scenario& s) {
  Problems problems;
  const Scenario read = ReadFields(ParseYaml(SaveScenario(s), "saved"), &problems);
  problems.ThrowIfAny();
  return read;
}

TEST(SaveScenario, SavedTextLoadsAndSavesTheSame) {
  const std::string saved = SaveScenario(Fixture());
  EXPECT_EQ(SaveScenario(ParseScenario(saved, "saved", kData)), saved);
  // The original file did not contain this default.
  EXPECT_NE(saved.find("stop_jerk: 250"), std::string::npos);
  EXPECT_NE(saved.find("[m/s³]"), std::string::npos);  // with its unit
}

// Fills a scenario with random allowed values according to its own tables.
class Randomizer {
 public:
  explicit Randomizer(RandomStream* random) : random_(random) {}

  template <class T>
  void operator()(const char*, T& member, const Rule& rule) {
    Fill(member, rule);
  }
  template <class Walk>
  void Group(const char*, const char*, Walk walk) {
    walk(*this);
  }
  template <class Walk>
  void Own(const char*, std::string& type, YamlNode& parameters, const Rule&, ParameterKinds kinds,
           Walk common) {
    common(*this);
    const ParameterKind& kind = *kinds[Below(kinds.size())];
    const auto own = kind.parameters();
    AnyVisitor visitor(this);
    own->Walk(visitor);
    type = kind.name;
    parameters = WriteParameters(own.get());
  }

 private:
  std::size_t Below(std::size_t n) { return random_->Next() % n; }
  std::size_t Length(const Rule& rule) {
    return rule.least + Below(std::min<std::size_t>(rule.most - rule.least, 4) + 1);
  }

  void Fill(double& x, const Rule& rule) {
    if (!rule.steps.empty()) {
      x = rule.steps[Below(rule.steps.size())];
      return;
    }
    const double small = std::pow(10.0, -12 * random_->Uniform());
    x = rule.range.low + (rule.range.high - rule.range.low) * random_->Uniform() * small;
    if (!rule.range.Contains(x) || Below(8) == 0) x = rule.range.high;
  }
  void Fill(int& x, const Rule& rule) {
    double number = 0;
    Fill(number, rule);
    x = static_cast<int>(std::ceil(number));
  }
  void Fill(std::uint64_t& x, const Rule&) { x = random_->Next(); }
  void Fill(bool& x, const Rule&) { x = Below(2) == 0; }
  void Fill(std::string& x, const Rule& rule) {
    static const std::vector<std::string> kOdd = {
        "a",           "null",  "Null",        "~",
        "5",           "-.5e3", ".nan",        "true",
        "No",          "a: b",  "a:",          "- a",
        " lead",       "tail ", "#c",          "a #c",
        "[",           "]",     "{a}",         "a, b",
        "'q'",         "\"q\"", "\\",          "&a",
        "*a",          "!t",    "|",           ">",
        "%",           "@",     "`",           "é日🙂",
        "line\nbreak", "tab\t", "../x/y.urdf", "package://p/x.urdf",
        "0x1F",        "=",     "<<",          "---",
        "...",         "?",     ":",           std::string("\x01\x1f\x7f"),
        "1:30",        "y"};
    x = rule.choices.empty() ? kOdd[Below(kOdd.size())] : rule.choices[Below(rule.choices.size())];
    if (!rule.required && rule.choices.empty() && Below(8) == 0) x.clear();
  }
  void Fill(Vector3& x, const Rule& rule) {
    for (int i = 0; i < 3; ++i) Fill(x[i], rule);
  }
  template <std::size_t N>
  void Fill(std::array<double, N>& x, const Rule& rule) {
    for (double& each : x) Fill(each, rule);
  }
  void Fill(std::vector<double>& x, const Rule& rule) {
    x.resize(rule.one_for_all && Below(2) == 0 ? 1 : Length(rule));
    for (double& each : x) Fill(each, rule);
  }
  void Fill(std::vector<std::string>& x, const Rule& rule) {
    x.resize(Length(rule));
    for (std::string& each : x) Fill(each, rule);
  }
  void Fill(std::vector<std::array<std::string, 2>>& x, const Rule& rule) {
    x.resize(Length(rule));
    for (auto& pair : x) {
      for (std::string& each : pair) Fill(each, rule);
    }
  }
  template <class T>
  void Fill(std::optional<T>& x, const Rule& rule) {
    x.reset();
    if (Below(2) == 0) Fill(x.emplace(), rule);
  }
  template <class T>
  requires std::is_enum_v<T>
  void Fill(T& x, const Rule&) { x = static_cast<T>(Below(NamesOf(x).size())); }
  template <class T>
  requires IsStruct<T, Randomizer>
  void Fill(T& x, const Rule&) { Fields(*this, x); }
  template <class T>
  requires IsStruct<T, Randomizer>
  void Fill(std::vector<T>& x, const Rule& rule) {
    x.resize(Length(rule));
    for (T& each : x) Fields(*this, each);
  }

  RandomStream* random_;
};

// Numbers are written so that they are read back exactly (text_test.cpp), so equal texts mean equal
// values.
TEST(SaveScenario, RandomScenariosComeBackExactly) {
  RandomStream random(3, "scenarios");
  for (int i = 0; i < 200; ++i) {
    Scenario s;
    Randomizer randomizer(&random);
    Fields(randomizer, s);
    const Scenario read = Reread(s);
    ASSERT_EQ(SaveScenario(read), SaveScenario(s));
    ASSERT_EQ(read.name, s.name);
    ASSERT_EQ(read.safety.force, s.safety.force);
    ASSERT_EQ(read.seed, s.seed);
  }
}

// ---- tables -------------------------------------------------------------------------------------

// Records the offsets, within their struct, of the members that a table visits.
class Coverage {
 public:
  struct Member {
    std::size_t offset, size, alignment;
  };
  template <class T>
  void operator()(const char*, T& member, const Rule&) {
    Note(member);
  }
  template <class Walk>
  void Group(const char*, const char*, Walk walk) {
    walk(*this);
  }
  template <class Walk>
  void Own(const char*, std::string& type, YamlNode& parameters, const Rule&, ParameterKinds,
           Walk common) {
    common(*this);
    Note(type);
    Note(parameters);
  }
  template <class T>
  void Note(T& member) {
    const auto address = reinterpret_cast<const char*>(&member);
    members.push_back({static_cast<std::size_t>(address - base), sizeof(T), alignof(T)});
  }

  const char* base = nullptr;
  std::vector<Member> members;
};

// The only bytes between the members are those that alignment requires, so the table contains every
// member.
template <class S>
bool VisitsEveryMember() {
  S s;
  Coverage coverage;
  coverage.base = reinterpret_cast<const char*>(&s);
  Fields(coverage, s);
  if constexpr (std::is_same_v<S, Scenario>) {  // the file does not contain these members
    coverage.Note(s.file);
    coverage.Note(s.tree);
    coverage.Note(s.controller_tape);
  }
  // the table visits them in groups
  if constexpr (std::is_same_v<S, RenderingSpec>) coverage.Note(s.parts);
  auto& members = coverage.members;
  std::sort(members.begin(), members.end(),
            [](const auto& a, const auto& b) { return a.offset < b.offset; });
  const auto align = [](std::size_t x, std::size_t to) { return (x + to - 1) / to * to; };
  std::size_t end = 0;
  for (const Coverage::Member& member : members) {
    if (member.offset != align(end, member.alignment)) return false;
    end = member.offset + member.size;
  }
  return align(end, alignof(S)) == sizeof(S);
}

template <class S>
class FieldTable : public testing::Test {};
using Structs =
    testing::Types<PoseSpec, JointFriction, Waypoint, ControllerSpec, CobotSpec, PrimitiveSpec,
                   AttachmentSpec, ObjectSpec, HandleSpec, TableSpec, FixtureSpec, EnvironmentSpec,
                   CouplingSpec, VelocityLoopSpec, HandlePayloadSpec, SensorSpec, ArmSpec,
                   DeviceSpec, RigSpec, HandSpec, ActionSpec, OperatorSpec, RenderingSpec,
                   OscillationSpec, SafetySpec, GuidanceSpec, Scenario>;
TYPED_TEST_SUITE(FieldTable, Structs);

TYPED_TEST(FieldTable, VisitsEveryMember) { EXPECT_TRUE(VisitsEveryMember<TypeParam>()); }

TEST(Catalogue, ListsWhatCanBeLoadedByName) {
  const auto folder =
      std::filesystem::temp_directory_path() /
      ("catalogue-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "broken.yaml") << "name: [";
  std::ofstream(folder / "notes.txt") << "name: no scenario";
  EXPECT_TRUE(ScenariosIn(folder).empty());
  std::filesystem::remove_all(folder);
  EXPECT_TRUE(ScenariosIn(folder).empty());

  const auto list = ScenariosIn(std::filesystem::path(PREDICTOR_SOURCE_DIR) / "scenarios");
  ASSERT_GE(list.size(), 8u);
  EXPECT_TRUE(std::is_sorted(list.begin(), list.end(),
                             [](const auto& a, const auto& b) { return a.name < b.name; }));
  EXPECT_EQ(list.front().name, "admittance");
  EXPECT_EQ(list.front().title, "Bar of 2.1 kg, admittance control");
}

}  // namespace
}  // namespace predictor
