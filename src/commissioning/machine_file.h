// Changes a machine file.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>

#include "scenario/machine.h"

namespace predictor::commissioning {

// Reads the file again, changes it, and checks the result as a reader would. The function then
// keeps the old version as FILE.before-DATE (or FILE.before-DATE-2, ...) and replaces the file
// atomically. The whole file is written from scratch, so comments remain only in the copy. Returns
// the path of the copy. Throws InputError, in which case the file is unchanged.
std::filesystem::path ChangeMachine(const std::filesystem::path& file, const std::string& date,
                                    const std::function<void(Machine*)>& change);

// Creates or replaces `file` with `text`, atomically and synchronised to the disk. Throws
// InputError, in which case the old file is unchanged.
void ReplaceFile(const std::filesystem::path& file, const std::string& text, mode_t mode);

}  // namespace predictor::commissioning
