#include "export/package_meshes.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <sstream>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "scenario/paths.h"

namespace predictor::scene_export {
namespace {

namespace fs = std::filesystem;

using Rename = std::function<std::string(const std::string&)>;

constexpr const char* kFolder = "meshes/";

std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string Extension(const fs::path& file) { return LowerCase(file.extension().string()); }

// Keeps only characters that every file system and URI accepts.
std::string Plain(std::string name) {
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 || (std::isalnum(byte) == 0 && c != '-')) c = '_';
  }
  return name;
}

// In COLLADA, the name of an image file is in <init_from> (version 1.4) or in the <ref> of
// <init_from> (version 1.5).
std::string RewriteCollada(const std::string& text, const Rename& rename) {
  std::string out;
  std::size_t at = 0;
  const std::size_t images = text.find("<library_images");
  const std::size_t end = std::min(text.find("</library_images>", images), text.size());
  while (images != std::string::npos) {
    const std::size_t from = std::max(at, images);
    const std::size_t tag = std::min(text.find("<init_from>", from), text.find("<ref>", from));
    if (tag >= end) break;
    const std::size_t value = text.find('>', tag) + 1;
    const std::size_t value_end = text.find('<', value);
    if (value_end == std::string::npos) break;
    const std::string uri(Trimmed(std::string_view(text).substr(value, value_end - value)));
    out.append(text, at, value - at);
    out += uri.empty() ? text.substr(value, value_end - value) : rename(uri);
    at = value_end;
  }
  return out.append(text, std::min(at, text.size()));
}

// Returns the file name at the end of a line of an OBJ file or of its material library, or "" if
// the line contains no file name.
std::string FileOfLine(const std::string& line, bool is_library) {
  std::istringstream words(line);
  std::string word;
  words >> word;
  if (!is_library) {
    std::string rest;
    std::getline(words, rest);
    return word == "mtllib" ? std::string(Trimmed(rest)) : "";
  }
  const bool names_file = word.rfind("map_", 0) == 0 || word == "bump" || word == "disp" ||
                          word == "decal" || word == "refl" || word == "norm";
  std::string last;
  while (words >> word) last = word;  // options precede the name
  return names_file ? last : "";
}

std::string RewriteObj(const std::string& text, bool is_library, const Rename& rename) {
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string file = FileOfLine(line, is_library);
    if (!file.empty()) line.replace(line.rfind(file), file.size(), rename(file));
    out += line;
    if (!lines.eof()) out += '\n';
  }
  return out;
}

std::string NameOnly(const std::string& uri) { return uri.substr(uri.find_last_of("/\\") + 1); }

}  // namespace

std::string PackageMeshes::Add(const ModelShape& shape, const std::string& role) {
  const std::string extension = Extension(shape.mesh);
  if (extension != ".dae" && extension != ".stl" && extension != ".obj") {
    throw InputError(
        shape.place,
        "The mesh " + shape.mesh.string() + " has the format " + Quote(extension) +
            ", but Unity's URDF-Importer reads only .dae, .stl and .obj. Save the mesh in one of "
            "these formats, or give the link a box, cylinder or sphere.");
  }
  return kFolder + AddReferring(shape.mesh, role);
}

std::string PackageMeshes::AddTexture(const fs::path& file) {
  return kFolder + AddReferring(file, "texture");
}

std::string PackageMeshes::NewName(const std::string& role, const fs::path& file) {
  const std::string stem = role + "_" + Plain(file.stem().string());
  std::string name = stem;
  for (int i = 2; !stems_.insert(LowerCase(name)).second; ++i) {
    name = stem + "_" + std::to_string(i);
  }
  return name + Extension(file);
}

std::string PackageMeshes::AddReferring(const fs::path& file, const std::string& role) {
  const auto known = names_.find(file);
  if (known != names_.end()) return known->second;
  const std::string name = names_[file] = NewName(role, file);
  PackageFile& entry = files_[kFolder + name];
  entry.source = file;
  const std::string extension = Extension(file);
  const bool is_library = extension == ".mtl";
  if (extension != ".dae" && extension != ".obj" && !is_library) return name;
  const std::string text = ReadWholeFile(file);
  const auto rename = [&](const std::string& uri) { return AddReferred(uri, file); };
  std::string rewritten =
      extension == ".dae" ? RewriteCollada(text, rename) : RewriteObj(text, is_library, rename);
  if (rewritten != text) entry = {std::move(rewritten), {}};
  return name;
}

// If a file cannot be copied, only a colour is wrong. The scene is therefore exported nevertheless.
std::string PackageMeshes::AddReferred(const std::string& uri, const fs::path& by) {
  try {
    const fs::path file = ResolveModelPath(uri, by.parent_path(), scenario_folder_);
    return AddReferring(file, Extension(file) == ".mtl" ? "material" : "texture");
  } catch (const InputError& error) {
    const std::string name = NameOnly(uri);
    left_out_.push_back(name + " of " + by.filename().string());
    notes_.push_back("Omitted: " + left_out_.back() + ". " + error.what());
    return name;
  }
}

}  // namespace predictor::scene_export
