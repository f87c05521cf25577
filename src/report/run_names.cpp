#include "report/run_names.h"

#include <algorithm>
#include <optional>
#include <set>

namespace predictor {
namespace {

using Names = std::vector<std::string>;

constexpr std::size_t kLongestCondition = 40;  // [bytes]; a longer text is a remark, not a name
constexpr const char* kSeparators = "_ /";     // a hyphen does not separate, so the parts of a date
                                               // stay together

bool Differ(const Names& names) {
  return std::set<std::string>(names.begin(), names.end()).size() == names.size();
}

// Returns the name preceded by a given number of its folders. For a/b/run.mcap and one folder, the
// result is "b/run".
std::string NameOf(const std::filesystem::path& file, int folders) {
  std::string name = file.stem().string();
  std::filesystem::path folder = file.parent_path();
  for (; folders > 0 && folder.has_filename(); --folders, folder = folder.parent_path())
    name.insert(0, folder.filename().string() + "/");
  return name;
}

// Adds as many folders as needed to make the names unique. Returns no value if a file is named
// twice.
std::optional<Names> NamesOf(const std::vector<NamedRun>& runs) {
  constexpr int kMaxFolders = 64;
  for (int folders = 0; folders < kMaxFolders; ++folders) {
    Names names;
    for (const NamedRun& run : runs)
      names.push_back(NameOf(absolute(run.file).lexically_normal(), folders));
    if (Differ(names)) return names;
  }
  return {};
}

// Returns the length of the common beginning of all names, up to and including a separator.
std::size_t CommonStart(const Names& names) {
  std::size_t common = names[0].size();
  for (const std::string& name : names) {
    const auto end = std::mismatch(names[0].begin(), names[0].end(), name.begin(), name.end());
    common = std::min(common, static_cast<std::size_t>(end.first - names[0].begin()));
  }
  const std::size_t last = names[0].substr(0, common).find_last_of(kSeparators);
  return last == std::string::npos ? 0 : last + 1;
}

Names WithoutStart(Names names) {
  const std::size_t common = CommonStart(names);
  const bool none_is_left = std::any_of(
      names.begin(), names.end(), [&](const std::string& name) { return name.size() <= common; });
  for (std::string& name : names)
    if (!none_is_left) name.erase(0, common);
  return names;
}

Names Reversed(Names names) {
  for (std::string& name : names) std::reverse(name.begin(), name.end());
  return names;
}

}  // namespace

std::vector<std::string> ShortNames(const std::vector<NamedRun>& runs) {
  Names names;
  for (const NamedRun& run : runs)
    if (!run.condition.empty() && run.condition.size() <= kLongestCondition)
      names.push_back(run.condition);
  if (names.size() == runs.size() && Differ(names)) return names;
  if (const auto distinct = NamesOf(runs); distinct && runs.size() > 1)
    return Reversed(WithoutStart(Reversed(WithoutStart(*distinct))));
  names.clear();
  for (const NamedRun& run : runs)
    names.push_back(std::to_string(names.size() + 1) + ": " + run.file.stem().string());
  return names;
}

}  // namespace predictor
