// Reading and checking URDF before any engine sees it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

// The text of a URDF after checking it, with `remove_links` (and all that hangs on them) cut out.
// Refuses, by InputError that names file:line, link or joint, value and what to change: files over
// 8 MiB, entity declarations, malformed XML, no or two roots, a cycle, duplicate names, unknown
// parents, non-finite numbers, negative mass, moving links without mass, inertia that is not
// positive semidefinite or violates the triangle rule, missing limits, lower > upper, missing mesh
// files, mesh paths outside the allowed roots, mimic joints that remain, joint types not supported.
std::string ReadUrdf(const std::filesystem::path& file, const std::vector<std::string>& remove_links);

// Names of the links of a URDF text, in the file's order.
std::vector<std::string> UrdfLinks(const std::string& urdf);

}  // namespace predictor
