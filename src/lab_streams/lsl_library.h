// The functions of liblsl, the library of the Lab Streaming Layer
// (https://github.com/sccn/liblsl, MIT), that the program uses. The library is loaded while the
// program runs, because most installations do not need it.
#pragma once

#include <cstdint>
#include <string>

namespace predictor::lab_streams {

// Objects of the library.
using LslInfo = struct LslInfoObject*;
using LslInlet = struct LslInletObject*;
using LslXml = struct LslXmlObject*;

enum : std::int32_t { kLslNoError = 0, kLslLost = -2 };  // lost: for good
enum : std::int32_t { kLslString = 3 };                  // the channels contain words, not numbers
enum : std::uint32_t { kLslClockSync = 1, kLslMonotonize = 4 };

// The signatures are those of the header lsl_c.h of liblsl 1.13 and later. Times are in seconds.
struct LslLibrary {
  // Loads the library from `file` or, if the name is empty, from where the system looks for
  // libraries. Throws InputError with a remedy.
  explicit LslLibrary(const std::string& file);

  std::int32_t (*protocol_version)();  // the first call reads the library's configuration file
  double (*local_clock)();
  std::int32_t (*resolve_byprop)(LslInfo* found, std::uint32_t most, const char* property,
                                 const char* value, std::int32_t least, double timeout);
  std::int32_t (*resolve_all)(LslInfo* found, std::uint32_t most, double wait);
  void (*destroy_streaminfo)(LslInfo info);
  LslInlet (*create_inlet)(LslInfo info, std::int32_t buffer_seconds, std::int32_t chunk,
                           std::int32_t recover);
  LslInfo (*get_fullinfo)(LslInlet inlet, double timeout, std::int32_t* error);
  void (*open_stream)(LslInlet inlet, double timeout, std::int32_t* error);
  double (*time_correction)(LslInlet inlet, double timeout, std::int32_t* error);
  std::int32_t (*set_postprocessing)(LslInlet inlet, std::uint32_t flags);
  unsigned long (*pull_chunk_d)(LslInlet inlet, double* values, double* times,
                                unsigned long max_values, unsigned long max_times, double timeout,
                                std::int32_t* error);
  const char* (*get_name)(LslInfo info);
  const char* (*get_type)(LslInfo info);
  std::int32_t (*get_channel_count)(LslInfo info);
  double (*get_nominal_srate)(LslInfo info);
  std::int32_t (*get_channel_format)(LslInfo info);
  LslXml (*get_desc)(LslInfo info);
  LslXml (*child)(LslXml element, const char* name);
  LslXml (*next_sibling)(LslXml element);
  const char* (*child_value_n)(LslXml element, const char* name);
};

}  // namespace predictor::lab_streams
