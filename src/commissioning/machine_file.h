// A machine file that is changed by the program.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>

#include "scenario/machine.h"

namespace predictor {

// Reads the file anew, changes it, checks the result as a reader would, keeps what was there as
// FILE.before-DATE (or FILE.before-DATE-2, ...), and puts the new one in its place at once: nobody
// ever sees a part of it. The whole machine is written, so comments stay in the copy only. Returns
// the copy's path. Throws InputError; the file is then as it was.
std::filesystem::path ChangeMachine(const std::filesystem::path& file, const std::string& date,
                                    const std::function<void(Machine*)>& change);

// Puts `text` into the place of `file`, whether it is there or not, at once and on the disk for
// good. Throws InputError; what was there is then as it was.
void ReplaceFile(const std::filesystem::path& file, const std::string& text, mode_t mode);

}  // namespace predictor
