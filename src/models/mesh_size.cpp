#include "models/mesh_size.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <string>

namespace predictor {
namespace {

// Reads 32-bit integers from the file at `offset`, or zeros beyond its end.
template <std::size_t N>
std::array<std::uint32_t, N> ReadNumbers(std::ifstream* stream, std::streamoff offset) {
  std::array<std::uint32_t, N> numbers = {};
  stream->seekg(offset);
  if (!stream->read(reinterpret_cast<char*>(numbers.data()), sizeof numbers)) numbers = {};
  return numbers;
}

// Returns whether the file has at least this many bytes. If the file is shorter, its first bytes
// are not a binary header, because the first bytes of a text file also form a number.
bool HasBytes(std::ifstream* stream, std::uint64_t bytes) {
  stream->seekg(0, std::ios::end);
  const std::streamoff end = stream->tellg();
  return end >= 0 && static_cast<std::uint64_t>(end) >= bytes;
}

std::size_t OfStl(std::ifstream* stream) {
  constexpr std::uint64_t kHeader = 80, kTriangle = 50;  // [B]
  const std::uint64_t triangles = ReadNumbers<1>(stream, kHeader)[0];
  return HasBytes(stream, kHeader + 4 + kTriangle * triangles) ? triangles : 0;
}

std::size_t OfMsh(std::ifstream* stream) {
  constexpr std::uint64_t kHeader = 16, kVertex = 12, kFace = 12;  // [B]
  const auto numbers = ReadNumbers<4>(stream, 0);  // vertices, normals, texture coordinates, faces
  const std::uint64_t vertices = numbers[0], faces = numbers[3];
  if (!HasBytes(stream, kHeader + kVertex * vertices + kFace * faces)) return 0;
  return std::max(faces, vertices / 3);
}

// Returns the number of words in a line, not counting the first.
std::size_t CountWords(const std::string& line) {
  std::size_t words = 0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const bool starts = std::isspace(static_cast<unsigned char>(line[i - 1])) != 0 &&
                        std::isspace(static_cast<unsigned char>(line[i])) == 0;
    words += starts ? 1 : 0;
  }
  return words;
}

std::size_t OfObj(std::ifstream* stream) {
  std::size_t triangles = 0, vertices = 0;
  for (std::string line; std::getline(*stream, line);) {
    if (line.rfind("v ", 0) == 0) ++vertices;
    if (line.rfind("f ", 0) == 0) triangles += std::max<std::size_t>(CountWords(line), 2) - 2;
  }
  return std::max(triangles, vertices / 3);
}

}  // namespace

std::size_t CountTriangles(const std::filesystem::path& mesh) {
  std::string form = mesh.extension().string();
  std::transform(form.begin(), form.end(), form.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::ifstream stream(mesh, std::ios::binary);
  if (form == ".stl") return OfStl(&stream);
  if (form == ".obj") return OfObj(&stream);
  if (form == ".msh") return OfMsh(&stream);
  return 0;
}

}  // namespace predictor
