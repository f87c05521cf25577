#include "core/file.h"

#include <algorithm>
#include <array>
#include <fstream>

#include "core/error.h"

namespace predictor {

std::string ReadWholeFile(const std::filesystem::path& file, std::size_t max_bytes) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes;
  std::array<char, 1 << 16> piece;
  while (in && bytes.size() < max_bytes) {
    const std::size_t most = std::min(piece.size(), max_bytes - bytes.size());
    in.read(piece.data(), static_cast<std::streamsize>(most));
    bytes.append(piece.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (!in && !in.eof())
    throw InputError(file.string(), "The file cannot be read. Check its name and permissions.");
  return bytes;
}

void WriteWholeFile(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out << bytes;
  if (!out.flush())
    throw InputError(file.string(),
                     "The file could not be written. Give a writable folder on a disk with free "
                     "space.");
}

}  // namespace predictor
