#include "recording/forget.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "recording/input.h"
#include "recording/opening.h"
#include "scenario/pseudonym.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
using recording::InputFile;

constexpr std::uint64_t kBlock = 1U << 20U;  // part of a file that is searched at once [bytes]

// ---- contents ---------------------------------------------------------------------------------

bool HasBytes(const InputFile& file, const std::string& text) {
  for (std::uint64_t at = 0; at < file.size(); at += kBlock) {
    const std::uint64_t n = std::min(kBlock + text.size() - 1, file.size() - at);
    if (file.Read(at, n).find(text) != std::string::npos) return true;
  }
  return false;
}

bool IsMcap(const InputFile& file) {
  const std::uint64_t n = mcap::kMagic.size();
  return file.size() >= n && file.Read(0, n) == mcap::kMagic;
}

// Returns the name of the compression of the chunk at `at`, or "" if the chunk is not compressed.
std::string CompressionAt(const InputFile& file, std::uint64_t at, std::uint64_t length) {
  const std::string head = file.Read(at + mcap::kHead, std::min<std::uint64_t>(length, 64));
  mcap::Parser from{head};
  from.Take(8 + 8 + 8 + 4);
  return std::string(from.String());
}

// Returns whether a compressed chunk contains the text. Throws InputError if a chunk cannot be
// read.
bool HasInChunks(const InputFile& file, const std::string& text) {
  for (std::uint64_t at = mcap::kMagic.size();;) {
    const auto head = ReadHead(file, at);
    if (!head) file.Fail(at, "The file is damaged or truncated here.");
    if (head->op == mcap::Op::kDataEnd) return false;  // the rest of the file is not compressed
    if (head->op == mcap::Op::kChunk && !CompressionAt(file, at, head->length).empty()) {
      const auto index = recording::ChunkAt(file, at);
      if (!index)
        file.Fail(
            at, "The chunks of the file are compressed in a way that this program does not know.");
      if (ReadChunk(file, *index).find(text) != std::string::npos) return true;
    }
    at += mcap::kHead + head->length;
  }
}

// Returns the name of the program that compressed the file, or null if the program is not known.
const char* ArchiveKind(const InputFile& file) {
  using namespace std::string_view_literals;
  static constexpr std::array<std::pair<std::string_view, const char*>, 8> kMagics = {
      {{"\x1f\x8b"sv, "gzip"},
       {"PK\3\4"sv, "ZIP"},
       {"\x28\xb5\x2f\xfd"sv, "zstd"},
       {"\xfd"
        "7zXZ\0"sv,
        "xz"},
       {"BZh"sv, "bzip2"},
       {"7z\xbc\xaf\x27\x1c"sv, "7z"},
       {"\x04\x22\x4d\x18"sv, "lz4"},
       {"%PDF-"sv, "PDF"}}};
  const std::string start = file.Read(0, std::min<std::uint64_t>(file.size(), 8));
  for (const auto& [magic, kind] : kMagics)
    if (start.starts_with(magic)) return kind;
  return nullptr;
}

// Returns the time at which the run of a recording started [ns]. Copies of a recording return the
// same time as the original.
std::optional<std::int64_t> StartOf(const InputFile& file) {
  try {
    const std::int64_t start = ReadOpening(file).header.start_unix_ns;
    if (start != 0) return start;
  } catch (const InputError&) {
    // Another program wrote the file.
  }
  return {};
}

// ---- the search -------------------------------------------------------------------------------

// Maps "run.mcap" to "run" and "lift.person.csv" to "lift". Returns "" for other files.
std::string StemOfRun(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const std::string ending : {".mcap", ".person.csv"})
    if (name.size() > ending.size() && name.ends_with(ending))
      return name.substr(0, name.size() - ending.size());
  return "";
}

// Returns whether this is a default name of a file that the program makes from the run STEM.
bool IsMadeFrom(const std::string& stem, const fs::path& file) {
  const std::string name = file.filename().string();
  if (!name.starts_with(stem + ".") || name.ends_with(".survey.json")) return false;
  return std::ranges::any_of(std::array{".html", ".csv", ".json", ".mcap", ".opensim"},
                             [&](std::string_view ending) { return name.ends_with(ending); });
}

class Search {
 public:
  Search(const std::string& pseudonym, const std::function<void(std::uint64_t)>& progress)
      : pseudonym_(pseudonym), progress_(progress) {}

  PersonSearch Run(const fs::path& folder) {
    Walk(folder);
    AddCopies();
    AddMade();
    AddLinked();
    const auto by_path = [](const PersonalFile& a, const PersonalFile& b) {
      return a.path < b.path;
    };
    std::ranges::sort(result_.found, by_path);
    std::ranges::sort(result_.not_searched, by_path);
    return std::move(result_);
  }

 private:
  bool Names(const fs::path& path) const {
    return path.filename().string().find(pseudonym_) != std::string::npos;
  }

  void Walk(const fs::path& folder) {
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
      Visit(*at);
    if (error) result_.not_searched.push_back({folder, "cannot be read: " + error.message()});
  }

  void Visit(const fs::directory_entry& entry) {
    const fs::path& path = entry.path();
    std::error_code error;
    const fs::file_type type = entry.symlink_status(error).type();
    if (type == fs::file_type::symlink) {
      const fs::path target = fs::read_symlink(path, error);
      if (Names(path) || target.string().find(pseudonym_) != std::string::npos)
        result_.found.push_back({path, "a link with the pseudonym"});
    } else if (Names(path)) {
      result_.found.push_back({path, "its name contains the pseudonym"});
    } else if (type == fs::file_type::directory && path.filename() == ".git") {
      result_.not_searched.push_back({path, "the history of a Git repository is compressed"});
    } else if (type == fs::file_type::directory) {
      others_.push_back(path);
      Walk(path);
    } else if (type == fs::file_type::regular) {
      VisitFile(path);
    } else if (error || type == fs::file_type::none) {
      result_.not_searched.push_back({path, "cannot be read: " + error.message()});
    }
  }

  void VisitFile(const fs::path& path) {
    ++result_.files;
    if (progress_) progress_(result_.files);
    try {
      const InputFile file(path.string());
      const bool mcap = IsMcap(file);
      const auto start = mcap ? StartOf(file) : std::nullopt;
      if (HasBytes(file, pseudonym_)) {
        result_.found.push_back({path, "it contains the pseudonym"});
        if (start) starts_[*start] = path.filename().string();
        return;
      }
      others_.push_back(path);
      if (start) recordings_.emplace_back(path, *start);
      if (mcap && HasInChunks(file, pseudonym_))
        result_.found.push_back({path, "a marker contains the pseudonym"});
      else if (const char* kind = ArchiveKind(file))
        result_.not_searched.push_back({path, std::string("compressed (") + kind + ")"});
    } catch (const InputError& error) {
      result_.not_searched.push_back({path, error.what()});
    }
  }

  bool IsFound(const fs::path& path) const {
    return std::ranges::any_of(result_.found,
                               [&](const PersonalFile& f) { return f.path == path; });
  }

  void AddCopies() {
    // A recording that was found by its name has not been opened yet.
    for (const PersonalFile& found : std::vector(result_.found))
      if (found.path.extension() == ".mcap" && fs::is_regular_file(fs::symlink_status(found.path)))
        try {
          if (const auto start = StartOf(InputFile(found.path.string())))
            starts_[*start] = found.path.filename().string();
        } catch (const InputError&) {
          // A damaged file needs no start time, because the file is deleted in any case.
        }
    for (const auto& [path, start] : recordings_)
      if (const auto of = starts_.find(start); of != starts_.end() && !IsFound(path))
        result_.found.push_back({path, "a copy of " + of->second});
  }

  void AddMade() {
    for (const PersonalFile& run : std::vector(result_.found)) {
      const std::string stem = StemOfRun(run.path);
      if (stem.empty()) continue;
      for (const fs::path& other : others_)
        if (other.parent_path() == run.path.parent_path() && IsMadeFrom(stem, other) &&
            !IsFound(other))
          result_.found.push_back({other, "made from " + run.path.filename().string()});
    }
    // A file that will be deleted does not need to be searched.
    std::erase_if(result_.not_searched, [&](const PersonalFile& f) { return IsFound(f.path); });
  }

  void AddLinked() {
    std::map<std::pair<dev_t, ino_t>, nlink_t> names;
    const auto stat_of = [](const fs::path& path, struct stat* info) {
      return ::lstat(path.c_str(), info) == 0 && S_ISREG(info->st_mode);
    };
    struct stat info {};
    for (const PersonalFile& f : result_.found)
      if (stat_of(f.path, &info)) ++names[{info.st_dev, info.st_ino}];
    for (const PersonalFile& f : result_.found)
      if (stat_of(f.path, &info) && info.st_nlink > names[{info.st_dev, info.st_ino}])
        result_.linked.push_back(f);
  }

  const std::string& pseudonym_;
  const std::function<void(std::uint64_t)>& progress_;
  PersonSearch result_;
  std::vector<fs::path> others_;  // files in which no pseudonym was found
  std::vector<std::pair<fs::path, std::int64_t>> recordings_;  // recordings with their starts
  std::map<std::int64_t, std::string> starts_;  // starts of found recordings, with their names
};

}  // namespace

PersonSearch FindPerson(const fs::path& folder, const std::string& pseudonym,
                        const std::function<void(std::uint64_t files)>& progress) {
  if (!IsPseudonym(pseudonym))
    throw InputError(Quote(pseudonym) + " is not a pseudonym. Check for typing errors.");
  if (!fs::is_directory(folder)) throw InputError(folder.string(), "There is no such folder.");
  const fs::path whole = fs::canonical(folder);
  if (whole.string().find(pseudonym) != std::string::npos)
    throw InputError(folder.string(),
                     "The name of this folder contains the pseudonym, so it must be deleted too. "
                     "Give the parent folder.");
  return Search(pseudonym, progress).Run(folder);
}

std::vector<PersonalFile> Delete(const std::vector<PersonalFile>& found) {
  std::vector<PersonalFile> failed;
  for (const PersonalFile& entry : found) {
    std::error_code error;
    fs::remove_all(entry.path, error);
    if (error) failed.push_back({entry.path, error.message()});
  }
  return failed;
}

}  // namespace predictor
