// The kinds of fakes by name, for the program that hosts them.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "fakes/far_end.h"

namespace predictor {

// What stands after the name, as in "ur:127.0.0.2,cb3,register=24": words, or keys with values.
using FakeOptions = std::map<std::string, std::string>;

// Throws std::runtime_error for a name that is not known, and says which are.
std::unique_ptr<FakeDevice> MakeFake(const std::string& kind, const FakeOptions& options);

}  // namespace predictor
