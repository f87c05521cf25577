#include "scenario/paths.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxModelBytes = 64u << 20;  // maximum size of a model or mesh file
constexpr std::size_t kMaxNames = 1000;  // maximum number of names in a folder that are compared
                                         // for a suggestion
constexpr std::size_t kLongestUri = 4096;

// Returns share/predictor beside the folder of the running program, or "" if share/predictor does
// not exist, as in a build folder.
fs::path InstalledData() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path data = program.parent_path().parent_path() / "share" / "predictor";
  return !error && fs::is_directory(data, error) ? Canonical(data) : fs::path();
}

// UseDataFolder sets this folder. If UseDataFolder was not called, the first call of this function
// finds the folder.
fs::path& Data() {
  static fs::path data = InstalledData();
  return data;
}

// Returns the readable folders; see ResolveModelPath.
std::vector<fs::path> AllowedRoots(const fs::path& scenario_folder,
                                   const std::vector<fs::path>& packages) {
  const fs::path folder = Canonical(scenario_folder.empty() ? fs::path(".") : scenario_folder);
  std::vector<fs::path> allowed = {folder, folder.parent_path() / "assets"};
  allowed.insert(allowed.end(), packages.begin(), packages.end());
  return allowed;
}

std::vector<std::string> NamesIn(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (names.size() == kMaxNames) break;
    names.push_back(it->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string DidYouMean(const std::string& word, const std::vector<std::string>& names) {
  const std::string nearest = Nearest(word, names);
  return nearest.empty() ? "" : " Did you mean " + nearest + "?";
}

// As above for packages. The ending that these names have in common says nothing about their
// similarity.
std::string DidYouMeanPackage(const std::string& word, const std::vector<std::string>& names) {
  constexpr std::string_view kEnding = "_description";
  if (!word.ends_with(kEnding)) return DidYouMean(word, names);
  const auto stem = [&](const std::string& name) {
    return name.substr(0, name.size() - kEnding.size());
  };
  std::vector<std::string> stems;
  for (const std::string& name : names)
    if (name.ends_with(kEnding)) stems.push_back(stem(name));
  const std::string nearest = Nearest(stem(word), stems);
  return nearest.empty() ? "" : " Did you mean " + nearest + std::string(kEnding) + "?";
}

std::string ListOf(const std::vector<fs::path>& folders) {
  std::vector<std::string> names;
  names.reserve(folders.size());
  for (const fs::path& folder : folders) names.push_back(folder.string());
  return names.empty() ? "none" : Join(names);
}

// `file` must be a canonical path in a place from which files may be read. Throws InputError if the
// file cannot be read as a model.
void CheckFile(const std::string& uri, const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) {
    throw InputError(Quote(uri) + " does not exist: there is no " + file.string() + "." +
                     DidYouMean(file.filename().string(), NamesIn(file.parent_path())));
  }
  if (!fs::is_regular_file(status)) {
    throw InputError(Quote(uri) + " is not a file: " + file.string() +
                     " is a folder or a device. Give the model file itself.");
  }
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error || bytes > kMaxModelBytes) {
    throw InputError(Quote(uri) + " is too large: " + file.string() + " has " +
                     std::to_string(bytes) + " bytes, but at most " +
                     std::to_string(kMaxModelBytes) + " are allowed. Simplify the model.");
  }
}

// Returns the file for package://name/rest in one of the roots.
fs::path FindInPackages(const std::string& uri, const std::vector<fs::path>& roots) {
  const std::string path = uri.substr(std::string("package://").size());
  const std::string name = path.substr(0, path.find('/'));
  if (name.empty() || name.size() == path.size()) {
    throw InputError(Quote(uri) + " does not name a file. Write package://PACKAGE/PATH/TO/FILE.");
  }
  const std::string rest = path.substr(name.size() + 1);
  fs::path package;
  std::vector<std::string> known;
  for (const fs::path& root : roots) {
    const fs::path folder = root.filename() == name ? root : root / name;
    std::error_code error;
    if (fs::exists(folder / rest, error)) return folder / rest;
    if (package.empty() && fs::is_directory(folder, error)) package = folder;
    for (std::string& other : NamesIn(root)) known.push_back(std::move(other));
  }
  if (!package.empty()) return package / rest;
  throw InputError(Quote(uri) + " is in the package " + Quote(name) + ", which was not found in: " +
                   ListOf(roots) + "." + DidYouMeanPackage(name, known) +
                   " Set PREDICTOR_PACKAGE_PATH to the folder that contains it.");
}

// Returns the unchecked path in `uri`.
fs::path Locate(const std::string& uri, const fs::path& base_folder,
                const std::vector<fs::path>& roots) {
  const bool is_control = std::any_of(uri.begin(), uri.end(),
                                      [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  if (uri.empty() || is_control || uri.size() > kLongestUri) {
    throw InputError("A model path is " + Quote(uri) + ". Write the path of a file.");
  }
  if (uri.rfind("package://", 0) == 0) return FindInPackages(uri, roots);
  if (uri.rfind("file://", 0) == 0) return uri.substr(std::string("file://").size());
  if (uri.find("://") != std::string::npos) {
    throw InputError(Quote(uri) + " is a remote address, but models are read from local files " +
                     "only. Download it and give its path or package:// address.");
  }
  return base_folder / uri;  // an absolute uri replaces base_folder
}

}  // namespace

fs::path Canonical(const fs::path& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(path, error);
  return error ? path.lexically_normal() : canonical;
}

bool IsInside(const fs::path& path, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

std::vector<fs::path> PackageRoots() {
  std::vector<fs::path> roots;
  if (const char* configured = std::getenv("PREDICTOR_PACKAGE_PATH")) {
    std::istringstream list(configured);
    for (std::string folder; std::getline(list, folder, ':');) {
      if (!folder.empty()) roots.push_back(Canonical(folder));
    }
  }
  const fs::path robots = PinnedRobots();
  if (!robots.empty()) {
    roots.push_back(robots);                // package://panda_description/...
    roots.push_back(robots.parent_path());  // package://example-robot-data/robots/...
  }
  return roots;
}

fs::path DataFolder() { return Data(); }

void UseDataFolder(const fs::path& folder) { Data() = Canonical(folder); }

fs::path FindShipped(const fs::path& path) {
  std::error_code error;
  if (path.empty() || fs::exists(path, error) || Data().empty() || path.is_absolute()) return path;
  fs::path scenario = Data() / "scenarios" / path;
  if (path.extension() != ".yaml") scenario += ".yaml";
  for (const fs::path& shipped : {Data() / path, scenario})
    if (IsInside(Canonical(shipped), Data()) && fs::exists(shipped, error)) return shipped;
  return path;
}

fs::path PinnedRobots() {
  std::error_code error;
  const fs::path installed = Data() / "example-robot-data" / "robots";
  if (!Data().empty() && fs::is_directory(installed, error)) return Canonical(installed);
#ifdef PREDICTOR_ROBOT_DATA_DIR
  return Canonical(PREDICTOR_ROBOT_DATA_DIR);
#else
  return {};
#endif
}

std::vector<fs::path> ModelFolders(const fs::path& scenario_folder) {
  return AllowedRoots(scenario_folder, PackageRoots());
}

fs::path ResolveModelPath(const std::string& uri, const fs::path& base_folder,
                          const fs::path& scenario_folder) {
  const std::vector<fs::path> roots = PackageRoots();
  const fs::path file = Canonical(Locate(uri, base_folder, roots));
  const std::vector<fs::path> allowed =
      AllowedRoots(scenario_folder.empty() ? base_folder : scenario_folder, roots);
  const bool is_allowed = std::any_of(allowed.begin(), allowed.end(),
                                      [&](const fs::path& root) { return IsInside(file, root); });
  if (!is_allowed) {
    throw InputError(Quote(uri) + " refers to " + file.string() +
                     ", which is outside the readable folders: " + ListOf(allowed) +
                     ". Move the file there, or add its folder to " + "PREDICTOR_PACKAGE_PATH.");
  }
  CheckFile(uri, file);
  return file;
}

}  // namespace predictor
