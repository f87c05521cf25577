// The page's files, compiled in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace predictor::viewer {

struct PageFile {
  std::string path;  // path as in requests: "/", "/app.js", "/app.css"
  std::string type;  // media type, as in Content-Type
  std::string_view bytes;
};

// Returns the built page, or a page that states that the viewer's page was not built.
std::vector<PageFile> PageFiles();

}  // namespace predictor::viewer
