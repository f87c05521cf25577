// Parses any text as a URDF. The parser must accept the text or throw InputError.
#include "models/urdf.h"

#include "core/error.h"
#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    predictor::ParseUrdf(std::string(reinterpret_cast<const char*>(data), size), "fuzz.urdf", ".");
  } catch (const predictor::InputError&) {
  }
  return 0;
}
