// Finds the files of one person below a folder, deletes them, and checks whether any are left.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace predictor {

struct PersonalFile {
  std::filesystem::path path;  // a file, a link, or a folder with its contents
  std::string why;             // "it contains the pseudonym"
};

struct PersonSearch {
  std::vector<PersonalFile> found;  // sorted by path
  // The places whose contents could not be searched for the pseudonym, each with the reason. These
  // places are unreadable or damaged files, compressed files of other programs, and histories of
  // Git.
  std::vector<PersonalFile> not_searched;
  std::vector<PersonalFile> linked;  // found files that have another name outside of the folder
  std::uint64_t files = 0;           // number of searched files
};

// Finds everything below `folder` that belongs to the person. The result includes files that have
// the pseudonym in their name, in their bytes, or in the compressed parts of a recording. The
// result also includes copies of such a recording (WriteShared, Recover), and files that were made
// from one and still have their default name, such as NAME.html next to NAME.mcap. Links are not
// followed. Throws InputError if the pseudonym is invalid or the folder is missing.
PersonSearch FindPerson(const std::filesystem::path& folder, const std::string& pseudonym,
                        const std::function<void(std::uint64_t files)>& progress = {});

// Deletes the files that were found. Returns the files that could not be deleted, each with the
// reason.
std::vector<PersonalFile> Delete(const std::vector<PersonalFile>& found);

}  // namespace predictor
