// Creates fakes by the name of their kind, for the program that hosts them.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "fakes/far_end.h"

namespace predictor {

// The options after the address, as in "ur:127.0.0.2,cb3,register=24". Each option is a word, or a
// key with a value.
using FakeOptions = std::map<std::string, std::string>;

// Throws std::runtime_error with the list of known names if the name is unknown.
std::unique_ptr<FakeDevice> MakeFake(const std::string& kind, const FakeOptions& options);

}  // namespace predictor
