// Reads any file as a recording. The reader must accept the file or throw InputError, and the
// memory use of the reader must stay bounded.
#include <unistd.h>

#include <fstream>

#include "core/error.h"
#include "fuzz/target.h"
#include "recording/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = "/tmp/predictor_fuzz_" + std::to_string(getpid()) + ".mcap";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    predictor::RecordingReader reader(path);
    reader.events();
    predictor::TickRecord record;
    for (int k = 0; k < 1000 && reader.Next(&record); ++k) {
    }
  } catch (const predictor::InputError&) {
  }
  unlink(path.c_str());
  return 0;
}
