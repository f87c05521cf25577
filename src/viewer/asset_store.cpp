#include "viewer/asset_store.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <utility>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "viewer/page_files.h"

namespace predictor::viewer {
namespace {

constexpr std::size_t kLongestExtension = 5;

std::string Extension(const std::filesystem::path& file) {
  std::string extension;
  for (const char c : file.extension().string())
    if (std::isalnum(static_cast<unsigned char>(c)))
      extension += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension.empty() || extension.size() > kLongestExtension ? "bin" : extension;
}

std::string TypeOf(const std::string& extension) {
  if (extension == "dae") return "model/vnd.collada+xml";
  if (extension == "stl") return "model/stl";
  if (extension == "obj") return "model/obj";
  if (extension == "png") return "image/png";
  if (extension == "jpg" || extension == "jpeg") return "image/jpeg";
  return "application/octet-stream";
}

std::string ReadFile(const std::filesystem::path& file, std::size_t max_bytes) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "The file cannot be read: " + error.message() + ".");
  if (bytes > max_bytes)
    throw InputError(file.string(), "The file has " + std::to_string(bytes) +
                                        " bytes, but the viewer has space for only " +
                                        std::to_string(max_bytes) +
                                        " more bytes. Simplify the mesh.");
  return ReadWholeFile(file, bytes);
}

// Decodes the value of an attribute in the form in which the URDF's printer wrote it.
std::string Unescape(std::string_view text) {
  static constexpr std::pair<std::string_view, char> kEntities[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string plain;
  for (std::size_t i = 0; i < text.size();) {
    const auto entity =
        std::find_if(std::begin(kEntities), std::end(kEntities),
                     [&](const auto& e) { return text.substr(i).starts_with(e.first); });
    const bool found = entity != std::end(kEntities);
    plain += found ? entity->second : text[i];
    i += found ? entity->first.size() : 1;
  }
  return plain;
}

// Returns whether the attribute at `at` belongs to an element that names a file of the model.
// Plugins of simulators have file names too.
bool IsOfModel(const std::string& urdf, std::size_t at) {
  const std::size_t element = urdf.rfind('<', at);
  return element != std::string::npos &&
         (urdf.compare(element, 6, "<mesh ") == 0 || urdf.compare(element, 9, "<texture ") == 0);
}

// Returns the text without comments. The result of `rename` replaces each `filename` of a mesh or
// texture.
std::string RewriteFileNames(const std::string& urdf,
                             const std::function<std::string(const std::string&)>& rename) {
  static constexpr std::string_view kComment = "<!--", kCommentEnd = "-->";
  static constexpr std::string_view kAttribute = " filename=\"";
  std::string out;
  for (std::size_t at = 0;;) {
    const std::size_t comment = urdf.find(kComment, at);
    const std::size_t attribute = urdf.find(kAttribute, at);
    const std::size_t next = std::min(comment, attribute);
    out.append(urdf, at, next == std::string::npos ? next : next - at);
    if (next == std::string::npos) return out;
    const bool is_comment = next == comment;
    const std::size_t begin = next + (is_comment ? kComment : kAttribute).size();
    const std::size_t end = urdf.find(is_comment ? kCommentEnd : "\"", begin);
    if (end == std::string::npos) return out;
    at = end + (is_comment ? kCommentEnd.size() : 1);
    if (is_comment) continue;
    if (!IsOfModel(urdf, next))
      out.append(urdf, next, at - next);
    else
      out.append(kAttribute).append(rename(Unescape({&urdf[begin], end - begin}))) += '"';
  }
}

}  // namespace

void AssetStore::Add(const std::string& path, Asset asset) {
  const std::size_t bytes = asset.bytes.size();
  if (bytes > max_bytes_ - bytes_)
    throw InputError("The models of the scene are too large for the viewer: together more than " +
                     std::to_string(max_bytes_ >> 20) +
                     " MB. Simplify their meshes, or run without the viewer.");
  if (assets_.emplace(path, std::move(asset)).second) bytes_ += bytes;
}

void AssetStore::AddPage() {
  for (const PageFile& file : PageFiles()) {
    Add(file.path, {std::string(file.bytes), file.type});
    // The same page also requests the future events if it is opened at this address.
    if (file.path == "/") Add(kExperimenterPath, {std::string(file.bytes), file.type});
  }
}

std::string AssetStore::AddModel(const UrdfModel& urdf) {
  const auto known = models_.find(urdf.text);
  if (known != models_.end()) return known->second;
  const std::string folder = "/models/" + std::to_string(models_.size()) + "/";
  std::map<std::string, std::string> names;  // path on disk -> name on the server
  const auto rename = [&](const std::string& file) {
    const auto found = names.find(file);
    if (found != names.end()) return found->second;
    const std::string extension = Extension(file);
    const std::string name = std::to_string(names.size()) + "." + extension;
    Add(folder + name, {ReadFile(file, max_bytes_ - bytes_), TypeOf(extension), true});
    return names[file] = name;
  };
  std::string text = RewriteFileNames(urdf.text, rename);
  Add(folder + "model.urdf", {std::move(text), "application/xml", true});
  return models_[urdf.text] = folder + "model.urdf";
}

const Asset* AssetStore::Find(std::string_view path) const {
  const auto found = assets_.find(path);
  return found == assets_.end() ? nullptr : &found->second;
}

}  // namespace predictor::viewer
