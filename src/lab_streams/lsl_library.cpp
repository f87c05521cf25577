#include "lab_streams/lsl_library.h"

#include <dlfcn.h>

#include "core/error.h"

namespace predictor::lab_streams {
namespace {

constexpr const char* kRemedy =
    " Install the library, for example with `pip install pylsl`, whose folder pylsl/lib contains "
    "liblsl.so, and give this file with --lsl-library.";

void* Open(const std::string& file) {
  if (!file.empty()) {
    if (void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) return library;
    throw InputError(
        file, std::string("The library of the Lab Streaming Layer cannot be loaded: ") + dlerror() +
                  "." + kRemedy);
  }
  for (const char* name : {"liblsl.so.2", "liblsl.so"})
    if (void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
  throw InputError(
      std::string("The library of the Lab Streaming Layer (liblsl.so) is not on this system.") +
      kRemedy);
}

template <class Function>
void Find(void* library, const char* name, Function** function) {
  *function = reinterpret_cast<Function*>(dlsym(library, name));
  if (*function == nullptr)
    throw InputError(std::string("The library of the Lab Streaming Layer has no function ") + name +
                     ". Install liblsl 1.13 or newer.");
}

}  // namespace

LslLibrary::LslLibrary(const std::string& file) {
  void* library = Open(file);
  Find(library, "lsl_protocol_version", &protocol_version);
  Find(library, "lsl_local_clock", &local_clock);
  Find(library, "lsl_resolve_byprop", &resolve_byprop);
  Find(library, "lsl_resolve_all", &resolve_all);
  Find(library, "lsl_destroy_streaminfo", &destroy_streaminfo);
  Find(library, "lsl_create_inlet", &create_inlet);
  Find(library, "lsl_get_fullinfo", &get_fullinfo);
  Find(library, "lsl_open_stream", &open_stream);
  Find(library, "lsl_time_correction", &time_correction);
  Find(library, "lsl_set_postprocessing", &set_postprocessing);
  Find(library, "lsl_pull_chunk_d", &pull_chunk_d);
  Find(library, "lsl_get_name", &get_name);
  Find(library, "lsl_get_type", &get_type);
  Find(library, "lsl_get_channel_count", &get_channel_count);
  Find(library, "lsl_get_nominal_srate", &get_nominal_srate);
  Find(library, "lsl_get_channel_format", &get_channel_format);
  Find(library, "lsl_get_desc", &get_desc);
  Find(library, "lsl_child", &child);
  Find(library, "lsl_next_sibling", &next_sibling);
  Find(library, "lsl_child_value_n", &child_value_n);
}

}  // namespace predictor::lab_streams
