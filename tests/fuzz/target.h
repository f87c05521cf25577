// Declares the function that each fuzz target defines. libFuzzer calls this function (./dev fuzz
// NAME). Without libFuzzer, replay.cpp calls it once for each file in the target's corpus, as a
// test of the ordinary build.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
