// Triangles as a picture, without a display: perspective, one light, flat shading, a depth buffer.
// The same picture on every machine.
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
  // Size of the picture [px]; it is drawn finer and averaged.
  Raster(int width, int height, const RasterCamera& camera);

  // In W [m]; color: red, green, blue from 0 to 1. `lit` false: the colour as it is. What is not
  // wholly in front of the camera is left out.
  void Triangle(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& color,
                bool lit = true);
  // What is drawn from now on lies before all that was drawn so far.
  void ForgetDepth();

  std::string Png() const;

 private:
  static constexpr int kFiner = 2;
  struct Point {
    double x, y, inverse;  // on the fine picture [px]; 1 / distance along the view [1/m]
  };
  Point Project(const Vector3& p_W) const;
  void Fill(const Point& a, const Point& b, const Point& c, const std::uint8_t (&color)[3]);
  Vector3 Shade(const Vector3& normal, const Vector3& from, const Vector3& color) const;

  int width_, height_;  // of the fine picture
  Vector3 eye_;
  Matrix3 R_CW_;              // rows: right, down, forward
  double focal_;              // [px]
  std::vector<float> depth_;  // 1 / distance [1/m]; 0: nothing
  std::vector<std::uint8_t> rgb_;
};

// Bytes as PNG: 8-bit RGB, rows from the top.
std::string EncodePng(int width, int height, const std::vector<std::uint8_t>& rgb);

}  // namespace predictor
