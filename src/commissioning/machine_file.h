// Changes a machine file.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>

#include "scenario/machine.h"

namespace predictor::commissioning {

// Reads the file again, changes the content, and checks the result in the same way as a reader of
// the file. The function then keeps the old version as FILE.before-DATE (or FILE.before-DATE-2,
// ...) and replaces the file atomically. The whole file is written from scratch, so comments remain
// only in the copy. Returns the path of the copy. If the function throws InputError, the file is
// unchanged.
std::filesystem::path ChangeMachine(const std::filesystem::path& file, const std::string& date,
                                    const std::function<void(Machine*)>& change);

// Creates or replaces `file` with `text`, atomically and synchronised to the disk. If the function
// throws InputError, the old file is unchanged.
void ReplaceFile(const std::filesystem::path& file, const std::string& text, mode_t mode);

}  // namespace predictor::commissioning
