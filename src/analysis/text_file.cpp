#include "analysis/text_file.h"

#include <fstream>

#include "core/error.h"

namespace predictor {

void WriteText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush())
    throw InputError("'" + file.string() +
                     "' could not be written. Give a writable folder on a disk with free space.");
}

}  // namespace predictor
