// The page's files, compiled in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace predictor {

struct PageFile {
  std::string path;  // as requested: "/", "/app.js", "/app.css"
  std::string type;  // as in Content-Type
  std::string_view bytes;
};

// The built page, or one that says that it was not built.
std::vector<PageFile> PageFiles();

}  // namespace predictor
