#include "analysis/reproduce/raster.h"

#include <libdeflate.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>

namespace predictor {
namespace {

constexpr double kNearest = 0.05;                              // [m]
constexpr double kAmbient = 0.42;                              // share of ambient light
constexpr double kSky = 0.14;                                  // share of light from straight above
const Vector3 kLight = Vector3(0.5, -0.55, 0.8).normalized();  // direction towards the light
constexpr std::uint8_t kTop = 0xf4, kBottom = 0xe4;            // grey of the background

void AppendBigEndian(std::uint32_t x, std::string* to) {
  for (int shift = 24; shift >= 0; shift -= 8) *to += static_cast<char>((x >> shift) & 0xffU);
}

void AppendChunk(const char* type, const std::string& data, std::string* png) {
  AppendBigEndian(static_cast<std::uint32_t>(data.size()), png);
  const std::string body = type + data;
  *png += body;
  AppendBigEndian(libdeflate_crc32(0, body.data(), body.size()), png);
}

std::string Deflated(const std::string& bytes) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(9), libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::string packed(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  const std::size_t size = libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(),
                                                    packed.data(), packed.size());
  packed.resize(size);  // shrink to the compressed size, which is at most the bound
  return packed;
}

// Returns twice the signed area of a triangle.
template <class Point>
double Area(const Point& a, const Point& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

}  // namespace

Raster::Raster(int width, int height, const RasterCamera& camera)
    : width_(kFiner * width),
      height_(kFiner * height),
      eye_(camera.eye),
      focal_(0.5 * kFiner * height / std::tan(camera.field / 2)),
      depth_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      rgb_(3 * depth_.size()) {
  const Vector3 forward = (camera.target - camera.eye).normalized();
  const Vector3 right = forward.cross(Vector3::UnitZ()).normalized();
  R_CW_.row(0) = right;
  R_CW_.row(1) = forward.cross(right);
  R_CW_.row(2) = forward;
  for (int y = 0; y < height_; ++y) {
    const auto grey = static_cast<std::uint8_t>(kTop + (kBottom - kTop) * y / height_);
    const std::size_t row = 3 * static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    std::fill_n(rgb_.begin() + static_cast<std::ptrdiff_t>(row), 3 * width_, grey);
  }
}

void Raster::ForgetDepth() { std::fill(depth_.begin(), depth_.end(), 0.0F); }

Raster::Point Raster::Project(const Vector3& p_W) const {
  const Vector3 p = R_CW_ * (p_W - eye_);
  if (p.z() < kNearest) return {0, 0, 0};
  return {0.5 * width_ + focal_ * p.x() / p.z(), 0.5 * height_ + focal_ * p.y() / p.z(), 1 / p.z()};
}

Vector3 Raster::Shade(const Vector3& normal, const Vector3& from, const Vector3& color) const {
  // The normal must point towards the viewer.
  const Vector3 n = normal.dot(eye_ - from) < 0 ? Vector3(-normal) : normal;
  const double light =
      kAmbient + kSky * (0.5 + 0.5 * n.z()) + (1 - kAmbient - kSky) * std::max(0.0, n.dot(kLight));
  return light * color;
}

void Raster::Triangle(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& color,
                      bool lit) {
  const Point pa = Project(a), pb = Project(b), pc = Project(c);
  if (pa.inverse == 0 || pb.inverse == 0 || pc.inverse == 0) return;
  const Vector3 normal = (b - a).cross(c - a);
  if (!(normal.squaredNorm() > 0)) return;
  const Vector3 shown = lit ? Shade(normal.normalized(), a, color) : color;
  std::uint8_t rgb[3];
  for (int k = 0; k < 3; ++k)
    rgb[k] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(shown[k], 0.0, 1.0)));
  Fill(pa, pb, pc, rgb);
}

void Raster::Fill(const Point& a, const Point& b, const Point& c, const std::uint8_t (&color)[3]) {
  const double area = Area(a, b, c.x, c.y);
  if (area == 0) return;
  const auto low = [](double x) { return static_cast<int>(std::max(0.0, std::floor(x))); };
  const auto high = [](double x, int size) {
    return static_cast<int>(std::min(static_cast<double>(size), std::ceil(x)));
  };
  const int x1 = high(std::max({a.x, b.x, c.x}), width_);
  const int y1 = high(std::max({a.y, b.y, c.y}), height_);
  for (int y = low(std::min({a.y, b.y, c.y})); y < y1; ++y)
    for (int x = low(std::min({a.x, b.x, c.x})); x < x1; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const double wa = Area(b, c, px, py) / area, wb = Area(c, a, px, py) / area;
      const double wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const auto inverse = static_cast<float>(wa * a.inverse + wb * b.inverse + wc * c.inverse);
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(x);
      if (inverse <= depth_[i]) continue;
      depth_[i] = inverse;
      std::copy_n(color, 3, rgb_.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
}

std::string Raster::Png() const {
  const int width = width_ / kFiner, height = height_ / kFiner;
  std::vector<std::uint8_t> picture;
  picture.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t k = 0; k < 3; ++k) {
        int sum = 0;
        for (int j = 0; j < kFiner * kFiner; ++j) {
          const auto row = static_cast<std::size_t>(kFiner * y + j / kFiner);
          const auto column = static_cast<std::size_t>(kFiner * x + j % kFiner);
          sum += rgb_[3 * (row * static_cast<std::size_t>(width_) + column) + k];
        }
        picture.push_back(static_cast<std::uint8_t>(sum / (kFiner * kFiner)));
      }
  return EncodePng(width, height, picture);
}

std::string EncodePng(int width, int height, const std::vector<std::uint8_t>& rgb) {
  std::string rows;
  const std::size_t row = 3 * static_cast<std::size_t>(width);
  rows.reserve((row + 1) * static_cast<std::size_t>(height));
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    rows += '\0';  // filter type: none
    rows.append(reinterpret_cast<const char*>(rgb.data()) + y * row, row);
  }
  std::string header;
  AppendBigEndian(static_cast<std::uint32_t>(width), &header);
  AppendBigEndian(static_cast<std::uint32_t>(height), &header);
  header += std::string("\x08\x02\x00\x00\x00", 5);  // 8 bits, RGB, not interlaced
  std::string png = "\x89PNG\r\n\x1a\n";
  AppendChunk("IHDR", header, &png);
  AppendChunk("IDAT", Deflated(rows), &png);
  AppendChunk("IEND", "", &png);
  return png;
}

}  // namespace predictor
