#include "viewer/address.h"

#include <arpa/inet.h>

#include <algorithm>
#include <iterator>

namespace predictor::viewer {

bool IsAddress(const std::string& text) {
  unsigned char bytes[sizeof(in6_addr)];
  return inet_pton(AF_INET, text.c_str(), bytes) == 1 ||
         inet_pton(AF_INET6, text.c_str(), bytes) == 1;
}

bool IsLoopback(const std::string& address) {
  in_addr v4;
  in6_addr v6;
  if (inet_pton(AF_INET, address.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
  return inet_pton(AF_INET6, address.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

std::string SourceOf(const std::string& address) {
  constexpr const char* kMapped = "::ffff:";
  std::string source = address.substr(0, address.find('%'));
  if (source.starts_with(kMapped) && source.find('.') != std::string::npos)
    source.erase(0, std::char_traits<char>::length(kMapped));
  if (IsLoopback(source)) return "loopback";
  in6_addr v6;
  if (inet_pton(AF_INET6, source.c_str(), &v6) != 1) return source;
  const bool counts_alone = IN6_IS_ADDR_LINKLOCAL(&v6);
  if (!counts_alone) std::fill(std::begin(v6.s6_addr) + 8, std::end(v6.s6_addr), 0);
  char text[INET6_ADDRSTRLEN];
  inet_ntop(AF_INET6, &v6, text, sizeof text);
  return text + std::string(counts_alone ? "" : "/64");
}

}  // namespace predictor::viewer
