// Draws triangles without a display, with perspective, one light, flat shading and a depth buffer.
// The picture is identical on every computer.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types.h"

namespace predictor {

struct RasterCamera {
  Vector3 eye, target;  // in W [m]; up is +z
  double field = 0.62;  // vertical angle of view [rad]
};

class Raster {
 public:
  // The arguments are the size of the picture [px]. The picture is drawn at a higher resolution and
  // averaged.
  Raster(int width, int height, const RasterCamera& camera);

  // The corners are in W [m]. `color` contains red, green and blue from 0 to 1. If `lit` is false,
  // the colour is not shaded. A triangle that is not completely in front of the camera is omitted.
  void Triangle(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& color,
                bool lit = true);
  // Anything that is drawn after this call covers everything that was drawn before.
  void ForgetDepth();

  std::string Png() const;

 private:
  static constexpr int kFiner = 2;
  struct Point {
    double x, y, inverse;  // position in the high-resolution picture [px]; 1 / distance along the
                           // view [1/m]
  };
  Point Project(const Vector3& p_W) const;
  void Fill(const Point& a, const Point& b, const Point& c, const std::uint8_t (&color)[3]);
  Vector3 Shade(const Vector3& normal, const Vector3& from, const Vector3& color) const;

  int width_, height_;  // of the high-resolution picture
  Vector3 eye_;
  Matrix3 R_CW_;              // rows: right, down, forward
  double focal_;              // [px]
  std::vector<float> depth_;  // 1 / distance [1/m]; 0: empty
  std::vector<std::uint8_t> rgb_;
};

// Encodes pixels as a PNG image in 8-bit RGB, with the rows from top to bottom.
std::string EncodePng(int width, int height, const std::vector<std::uint8_t>& rgb);

}  // namespace predictor
