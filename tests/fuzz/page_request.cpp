// Handles any text as a message from a page.
#include "fuzz/target.h"
#include "viewer/protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)predictor::viewer::ParsePageRequest({reinterpret_cast<const char*>(data), size});
  return 0;
}
