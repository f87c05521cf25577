// Writes a package without damaging other files in the destination folder.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <system_error>

#include "core/error.h"
#include "core/text.h"
#include "export/scene_package.h"

namespace predictor::scene_export {
namespace {

namespace fs = std::filesystem;

// The name of the file that lists the files of an export. This name begins with a dot, so Unity
// ignores the file.
constexpr const char* kManifest = ".predictor-scene";
constexpr const char* kManifestHeader = "# What predictor export scene wrote here";

[[noreturn]] void FailToWrite(const fs::path& path, const std::error_code& error) {
  throw InputError(Quote(path.string()) + " cannot be written" +
                   (error ? ": " + error.message() : std::string()) + ". Give a writable folder.");
}

// Returns whether a relative path remains within the folder in which it starts.
bool IsInside(const fs::path& path) {
  return !path.empty() && path.is_relative() &&
         std::none_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".."; });
}

// Returns the paths that an earlier export wrote. If there was no earlier export, the list is
// empty.
std::set<std::string> ReadManifest(const fs::path& folder) {
  std::set<std::string> mine;
  std::ifstream stream(folder / kManifest);
  std::string line;
  if (!std::getline(stream, line) || line != kManifestHeader) return mine;
  mine.insert(kManifest);
  while (std::getline(stream, line)) {
    if (IsInside(line)) mine.insert(line);
  }
  return mine;
}

std::string ManifestOf(const ScenePackage& package) {
  std::string text = std::string(kManifestHeader) + "\n";
  for (const auto& [path, file] : package.files) text += path + "\n";
  return text;
}

void CheckFolder(const fs::path& folder, bool force) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) {
    throw InputError(Quote(folder.string()) + " is a file. Give a folder or a new name.");
  }
  const bool is_empty = fs::is_empty(folder, error);
  if (error) FailToWrite(folder, error);
  if (is_empty || force) return;
  throw InputError(
      "The folder " + Quote(folder.string()) +
      " is not empty. Give another folder, or use --force to replace an earlier export.");
}

// Returns whether the path remains within the folder even if symbolic links are followed.
bool IsBelow(const fs::path& folder, const std::string& path) {
  std::error_code error;
  const fs::path parent = fs::weakly_canonical((folder / path).parent_path(), error);
  return !error && parent == (fs::weakly_canonical(folder, error) / path).parent_path();
}

// Throws InputError if the export would overwrite a file that no earlier export wrote.
void CheckFiles(const ScenePackage& package, const fs::path& folder,
                const std::set<std::string>& mine) {
  std::set<std::string> paths = {kManifest};
  for (const auto& [path, file] : package.files) paths.insert(path);
  for (const std::string& path : paths) {
    const fs::path parent = (folder / path).parent_path();
    std::error_code error;
    if (!IsBelow(folder, path) || (fs::exists(parent, error) && !fs::is_directory(parent, error))) {
      throw InputError(Quote(parent.string()) +
                       " is a link or a file, not a folder. Move it, or give another folder.");
    }
    const fs::file_status status = fs::symlink_status(folder / path, error);
    if (!fs::exists(status) || (mine.count(path) > 0 && !fs::is_directory(status))) continue;
    throw InputError(Quote((folder / path).string()) +
                     " was not written by an earlier export, so it was not replaced. Move it, or "
                     "give another folder.");
  }
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) FailToWrite(folder, error);
}

void WriteFile(const fs::path& path, const PackageFile& file) {
  std::error_code error;
  fs::remove(path, error);  // a link is replaced, not followed
  if (!file.source.empty()) {
    if (!fs::copy_file(file.source, path, error)) FailToWrite(path, error);
    return;
  }
  std::ofstream stream(path, std::ios::binary);
  stream << file.text;
  if (!stream.flush()) FailToWrite(path, {});
}

}  // namespace

void WriteScenePackage(const ScenePackage& package, const fs::path& folder, bool force) {
  CheckFolder(folder, force);
  const std::set<std::string> mine = ReadManifest(folder);
  CheckFiles(package, folder, mine);
  MakeFolder(folder);
  // The list is written first, so the files of a failed export can be replaced later.
  WriteFile(folder / kManifest, {ManifestOf(package), {}});
  for (const std::string& path : mine) {
    std::error_code error;
    if (path == kManifest || package.files.count(path) > 0 || !IsBelow(folder, path)) continue;
    if (!fs::is_directory(fs::symlink_status(folder / path, error))) {
      fs::remove(folder / path, error);
    }
  }
  for (const auto& [path, file] : package.files) {
    MakeFolder((folder / path).parent_path());
    WriteFile(folder / path, file);
  }
}

}  // namespace predictor::scene_export
