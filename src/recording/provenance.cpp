#include "recording/provenance.h"

#include <openssl/evp.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "models/urdf.h"
#include "scenario/kind_groups.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

// The folders of the recorded files. The relative positions of these folders are kept, so that
// references between the scenario and the URDFs remain valid.
constexpr const char* kScenarioFolder = "scenario";
constexpr const char* kAssetsFolder = "assets";
constexpr const char* kPackagesFolder = "packages";
constexpr const char* kControllerTape = "controller/tape.f64";
constexpr const char* kPinnedFolder = "pinned";  // files that come with the program; only compared

std::string Sha256(const std::string& bytes) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  std::size_t size = sizeof digest;
  if (EVP_Q_digest(nullptr, "SHA256", nullptr, bytes.data(), bytes.size(), digest, &size) != 1)
    throw InputError("SHA-256 is not available in this system's OpenSSL.");
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    text += "0123456789abcdef"[digest[i] >> 4U];
    text += "0123456789abcdef"[digest[i] & 15U];
  }
  return text;
}

// Returns the path of `file` relative to `root`, or "" if the file is not below `root`.
std::string Below(const fs::path& file, const fs::path& root) {
  if (root.empty()) return "";
  const fs::path relative = file.lexically_relative(root);
  return relative.empty() || *relative.begin() == ".." ? "" : relative.generic_string();
}

// Returns the name under which a recording stores the file. Symlinks in `file` and in the
// scenario's `folder` are resolved.
std::string NameOf(const fs::path& file, const fs::path& folder) {
  const auto at = [&](const char* place, const fs::path& root) {
    const std::string below = Below(file, root);
    return below.empty() ? "" : place + ("/" + below);
  };
  if (std::string name = at(kScenarioFolder, folder); !name.empty()) return name;
  if (std::string name = at(kAssetsFolder, folder.parent_path() / "assets"); !name.empty())
    return name;
  if (std::string name = at(kPinnedFolder, PinnedRobots()); !name.empty()) return name;
  for (const fs::path& root : PackageRoots())
    if (const std::string below = Below(file, root); !below.empty())
      return kPackagesFolder + ("/" + root.filename().string() + "/" + below);
  throw InputError(file.string(), "The file is outside the folders that a scenario can use.");
}

// Records a URDF that the scenario refers to, with its meshes. After this call, the scenario refers
// to the recorded file.
void Describe(std::string* model, const std::vector<std::string>& remove_links,
              const fs::path& folder, std::set<fs::path>* files) {
  if (model->empty()) return;
  const fs::path urdf = ResolveModelPath(*model, folder);
  files->insert(urdf);
  for (const UrdfLink& link : ReadUrdf(urdf, remove_links, folder).links)
    for (const auto& shapes : {link.visuals, link.collisions})
      for (const ModelShape& shape : shapes)
        if (!shape.mesh.empty()) files->insert(fs::weakly_canonical(shape.mesh));
  if (model->starts_with("package://")) return;
  const fs::path name = NameOf(urdf, folder);
  *model = name.lexically_relative(kScenarioFolder).generic_string();
}

bool IsUrdf(const std::string& name) { return fs::path(name).extension() == ".urdf"; }
bool IsPinned(const std::string& name) {
  return name.starts_with(std::string(kPinnedFolder) + "/");
}

// Returns a path below `folder` for an untrusted file name `name`.
fs::path PlaceFor(const std::string& name, const fs::path& folder) {
  const fs::path path = fs::path(name).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == "..")
    throw InputError("The recording attaches a file named " + Quote(name) +
                     ", which is outside the recording. The recording was not written by this "
                     "program. Do not use it.");
  return folder / path;
}

void ComparePinned(const std::string& name, const std::string& hash) {
  const fs::path file =
      PlaceFor(name.substr(std::string(kPinnedFolder).size() + 1), PinnedRobots());
  if (fs::exists(file) && Sha256(ReadWholeFile(file)) == hash) return;
  throw InputError("The recording was made with a different " + Quote(name) +
                   ". Use the program version that made the recording.");
}

void ExpectScenario(const RecordingHeader& header, const std::string& file) {
  if (!header.scenario_yaml.empty()) return;
  throw InputError(
      file,
      "The recording is damaged and its scenario is lost, so the run cannot be shown or "
      "recomputed. `predictor export data` and `predictor compare` can still read the ticks of "
      "this recording.");
}

void AddPackagePath(const fs::path& packages) {
  std::string path = packages.string();
  for (const auto& entry : fs::directory_iterator(packages))
    if (entry.is_directory()) path += ":" + entry.path().string();
  if (const char* configured = std::getenv("PREDICTOR_PACKAGE_PATH"))
    path += ":" + std::string(configured);
  setenv("PREDICTOR_PACKAGE_PATH", path.c_str(), 1);
}

// Only recordings of earlier versions contain the parameters of all controllers and actions.
std::string ScenarioText(const RecordingHeader& header, const std::string& file) {
  YamlNode tree = ParseYaml(header.scenario_yaml, file);
  bool is_earlier = false;
  for (const KindGroup& group : KindGroups(&tree))
    is_earlier = RemoveForeignParameters(group) || is_earlier;
  return is_earlier ? WriteYaml(tree) : header.scenario_yaml;
}

// A replay never runs a program. Instead of running a controller's program, a replay uses the
// controller's recorded answers.
void UseTape(const RecordingHeader& header, Scenario* scenario) {
  std::vector<double> tape;
  for (const RecordingAttachment& file : header.attachments) {
    if (file.name != kControllerTape) continue;
    tape.resize(file.bytes.size() / sizeof(double));
    std::memcpy(tape.data(), file.bytes.data(), tape.size() * sizeof(double));
  }
  scenario->controller_tape = std::make_shared<const std::vector<double>>(std::move(tape));
}

}  // namespace

RecordingHeader DescribeRun(const Scenario& scenario, const std::string& program_version,
                            const std::map<std::string, std::string>& labels) {
  Scenario named = scenario;
  const fs::path folder = fs::weakly_canonical(scenario.folder());
  std::set<fs::path> files;
  Describe(&named.cobot.model, named.cobot.remove_links, folder, &files);
  Describe(&named.object.model, {}, folder, &files);
  for (MovableSpec& movable : named.environment.objects)
    Describe(&movable.model, {}, folder, &files);
  for (auto* arm : {&named.device.left, &named.device.right})
    if (*arm) Describe(&(*arm)->model, (*arm)->remove_links, folder, &files);

  RecordingHeader header;
  for (const fs::path& file : files) {
    const std::string name = NameOf(file, folder);
    std::string bytes = ReadWholeFile(file);
    header.model_hashes[name] = Sha256(bytes);
    if (!IsPinned(name) || IsUrdf(name))
      header.attachments.push_back(
          {name, IsUrdf(name) ? "application/xml" : "application/octet-stream", std::move(bytes)});
  }
  header.scenario_yaml = SaveScenario(named);
  header.scenario_name = scenario.file.stem().string();
  header.program_version = program_version;
  header.seed = static_cast<std::uint64_t>(scenario.seed);
  header.dt = 1 / scenario.rate;
  header.labels = labels;
  header.start_unix_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(
                             std::chrono::system_clock::now().time_since_epoch())
                             .count();
  return header;
}

void AddControllerTape(const std::vector<double>& tape, RecordingHeader* header) {
  if (tape.empty()) return;
  const char* bytes = reinterpret_cast<const char*>(tape.data());
  header->attachments.push_back({kControllerTape, "application/octet-stream",
                                 std::string(bytes, tape.size() * sizeof(double))});
}

Scenario RecordedScenario(const RecordingHeader& header, const std::string& file,
                          const fs::path& folder) {
  ExpectScenario(header, file);
  Scenario scenario = ParseScenario(ScenarioText(header, file), file, folder);
  UseTape(header, &scenario);
  return scenario;
}

Scenario RestoreScenario(const RecordingHeader& header, const fs::path& folder) {
  ExpectScenario(header, "");
  const auto write = [](const fs::path& file, const std::string& bytes) {
    fs::create_directories(file.parent_path());
    WriteWholeFile(file, bytes);
  };
  for (const RecordingAttachment& file : header.attachments)
    if (!IsPinned(file.name)) write(PlaceFor(file.name, folder), file.bytes);
  for (const auto& [name, hash] : header.model_hashes)
    if (IsPinned(name)) ComparePinned(name, hash);
  if (fs::is_directory(folder / kPackagesFolder)) AddPackagePath(folder / kPackagesFolder);
  const std::string name = header.scenario_name.empty() ? "scenario" : header.scenario_name;
  const fs::path file = PlaceFor(kScenarioFolder + ("/" + name + ".yaml"), folder);
  write(file, ScenarioText(header, file.string()));
  Scenario scenario = LoadScenario(file);
  UseTape(header, &scenario);
  return scenario;
}

}  // namespace predictor
