// Any text as what a page sends.
#include "fuzz/target.h"
#include "viewer/protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)predictor::ParsePageRequest({reinterpret_cast<const char*>(data), size});
  return 0;
}
