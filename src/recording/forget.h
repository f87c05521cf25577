// Finds the files of one person below a folder, deletes them, and looks whether any is left.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace predictor {

struct PersonalFile {
  std::filesystem::path path;  // a file, a link, or a folder with all that is in it
  std::string why;             // "it contains the pseudonym"
};

struct PersonSearch {
  std::vector<PersonalFile> found;  // sorted by path
  // Places whose content could not be searched for the pseudonym, and why: unreadable or damaged
  // files, compressed files of other programs, histories of Git.
  std::vector<PersonalFile> not_searched;
  std::vector<PersonalFile> linked;  // found files that have another name outside of the folder
  std::uint64_t files = 0;           // that were searched
};

// All below `folder` that belongs to the person: what has the pseudonym in its name, in its bytes,
// or in the compressed parts of a recording; copies of such a recording (WriteShared, Recover); and
// what was made from one under its default name, such as NAME.html beside NAME.mcap. Links are not
// followed. Throws InputError if the pseudonym is invalid or the folder is missing.
PersonSearch FindPerson(const std::filesystem::path& folder, const std::string& pseudonym,
                        const std::function<void(std::uint64_t files)>& progress = {});

// Deletes what was found. Returns what could not be deleted, and why.
std::vector<PersonalFile> Delete(const std::vector<PersonalFile>& found);

}  // namespace predictor
