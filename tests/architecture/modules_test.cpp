// The dependencies between modules in CMakeLists.txt must match the includes.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;
using Graph = std::map<std::string, std::set<std::string>>;

const fs::path kSources = PREDICTOR_SOURCE_DIR;

std::string Read(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// Returns the modules that CMakeLists.txt allows each module to include, directly or through a
// PUBLIC dependency.
Graph Declared() {
  Graph direct;
  const std::string text = Read(kSources / "CMakeLists.txt");
  const std::regex line(R"(predictor_module\((\w+)\s+([^)]*)\))");
  for (std::sregex_iterator it(text.begin(), text.end(), line), end; it != end; ++it) {
    std::istringstream words((*it)[2]);
    auto& uses = direct[(*it)[1]];
    for (std::string word; words >> word;) uses.insert(word);
  }
  for (auto& [module, uses] : direct)
    std::erase_if(uses, [&](const std::string& use) { return !direct.contains(use); });
  Graph all = direct;
  for (std::size_t round = 0; round < direct.size(); ++round)
    for (auto& [module, uses] : all)
      for (const std::string& use : std::set<std::string>(uses))
        uses.insert(all[use].begin(), all[use].end());
  return all;
}

// Returns the modules whose headers the files of each module include.
Graph Included() {
  Graph graph;
  const std::regex include(R"re(#include "(\w+)/)re");
  for (const auto& entry : fs::recursive_directory_iterator(kSources / "src")) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    const std::string module = fs::relative(entry.path(), kSources / "src").begin()->string();
    const std::string text = Read(entry.path());
    for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it)
      if ((*it)[1] != module) graph[module].insert((*it)[1]);
  }
  return graph;
}

TEST(Modules, IncludeOnlyWhatIsDeclared) {
  const Graph declared = Declared();
  ASSERT_GT(declared.size(), 8u);
  for (const auto& [module, uses] : Included()) {
    ASSERT_TRUE(declared.contains(module))
        << "src/" << module << " is not declared in CMakeLists.txt";
    for (const std::string& use : uses)
      EXPECT_TRUE(declared.at(module).contains(use)) << module << " includes " << use;
  }
}

TEST(Modules, HaveNoCircle) {
  for (const auto& [module, uses] : Declared()) EXPECT_FALSE(uses.contains(module)) << module;
}

TEST(Modules, OfTheTickDoNotDependOnOneAnother) {
  const std::set<std::string> tick = {"sensing", "simulation", "haptics", "safety", "devices"};
  for (const auto& [module, uses] : Included()) {
    if (!tick.contains(module)) continue;
    for (const std::string& use : uses)
      EXPECT_FALSE(tick.contains(use)) << module << " includes " << use;
  }
}

// A third-party type is used only in the folder that wraps it.
TEST(Modules, KeepThirdPartiesInTheirFolders) {
  const std::map<std::string, std::set<std::string>> homes = {
      {"mujoco/", {"simulation", "models", "muscles"}},
      {"pinocchio/", {"models"}},
      {"yaml-cpp/", {"scenario"}},
      {"seccomp.h", {"process"}},
      {"tinyxml2", {"models"}},
      {"api.h", {"qp"}}};
  for (const auto& entry : fs::recursive_directory_iterator(kSources / "src")) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    const std::string module = fs::relative(entry.path(), kSources / "src").begin()->string();
    std::istringstream lines(Read(entry.path()));
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("#include")) continue;
      for (const auto& [header, folders] : homes) {
        const bool included = line.find("<" + header) != std::string::npos ||
                              line.find("\"" + header) != std::string::npos;
        EXPECT_TRUE(!included || folders.contains(module)) << entry.path() << ": " << line;
      }
    }
  }
}

// The engines are behind src/simulation/engine.h. In src/simulation, only the files that choose an
// engine may include its files. Everything else, such as equilibrium, linearisation, coupling,
// attachment, controllers and hazards, uses an engine only through this interface.
TEST(Engines, AreKnownOnlyToTheirFoldersAndToTheChoice) {
  const fs::path folder = kSources / "src" / "simulation";
  const std::set<std::string> may_choose = {"engine.cpp", "engine_version.cpp"};
  const std::regex of_engine(R"re(#include ["<](simulation/(mujoco|dart)/|mujoco|dart))re");
  std::set<std::string> including, files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    const fs::path file = fs::relative(entry.path(), folder);
    const std::string part = file.begin()->string();
    if (part == "mujoco" || part == "dart") continue;
    files.insert(file.string());
    if (std::regex_search(Read(entry.path()), of_engine)) including.insert(file.string());
  }
  for (const char* file : {"equilibrium.cpp", "linearise.cpp", "coupling.cpp", "controller.cpp",
                           "controllers/cartesian_impedance.cpp"})
    EXPECT_TRUE(files.contains(file)) << file << " is not covered by this rule";
  EXPECT_EQ(including, may_choose);
}

// Outside src/simulation, the program knows engines only through the interface, except for the
// places below, which state facts about one engine.
TEST(Engines, AreKnownToFewOtherFiles) {
  const std::regex of_engine(R"re(#include "simulation/(mujoco|dart)/(\w+)\.h")re");
  const std::set<std::string> may_include = {
      "src/analysis/check/contact.cpp: contact_law",  // the law that MuJoCo's contacts obey
  };
  std::set<std::string> including;
  for (const char* folder : {"src", "apps"})
    for (const auto& entry : fs::recursive_directory_iterator(kSources / folder)) {
      const std::string file = fs::relative(entry.path(), kSources).string();
      if (file.starts_with("src/simulation/") || file.starts_with("apps/dart_engine/")) continue;
      const std::string text = Read(entry.path());
      for (std::sregex_iterator it(text.begin(), text.end(), of_engine), end; it != end; ++it)
        including.insert(file + ": " + (*it)[2].str());
    }
  EXPECT_EQ(including, may_include);
}

// Only RulesFor may decide whether the arms are real. All other code must use the operating rule
// that applies.
TEST(OperatingRules, AloneDecideWhatRealArmsChange) {
  const std::regex question(
      R"re(HasRealArms|IsSimulated|dynamic_cast<[^>]*(Device|Rig)\b|device\.type\s*[!=]=)re");
  const std::set<std::string> may_ask = {
      "src/scenario/scenario.h",  // defines the predicate
      "src/scenario/operating_rules.cpp",
      "src/devices/device.cpp",  // creates the device of that type
  };
  int asked = 0;
  for (const char* folder : {"src", "apps"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kSources / folder)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      const std::string text = Read(entry.path());
      std::smatch found;
      if (!std::regex_search(text, found, question)) continue;
      const std::string file = fs::relative(entry.path(), kSources).string();
      EXPECT_TRUE(may_ask.contains(file)) << file << " asks: " << found.str();
      ++asked;
    }
  }
  EXPECT_EQ(asked, static_cast<int>(may_ask.size()));  // the pattern finds every permitted file
}

}  // namespace
