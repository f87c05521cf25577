// What every fuzz target has in common. libFuzzer calls the function (./dev fuzz NAME); without it,
// replay.cpp does, once for each file of the target's corpus (a test of the ordinary build).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
