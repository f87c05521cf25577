// Repairs any file as a recording. The result must be an intact recording or an InputError.
#include "recording/recover.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "fuzz/target.h"
#include "recording/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string in = "/tmp/predictor_fuzz_" + std::to_string(getpid()) + ".mcap";
  const std::string out = "/tmp/predictor_fuzz_" + std::to_string(getpid()) + "_mended.mcap";
  std::ofstream(in, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  bool mended = false;
  try {
    (void)predictor::Recover(in, out).Text();
    mended = true;
  } catch (const predictor::InputError&) {
  }
  if (mended) predictor::RecordingReader(out).Check();  // throws if it is damaged
  unlink(in.c_str());
  unlink(out.c_str());
  return 0;
}
