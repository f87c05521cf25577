// The heads of requests in the form that the application receives, and the headers of all replies.
#pragma once

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "viewer/connection.h"
#include "viewer/wire.h"

namespace predictor::viewer {

using Request = http::request<http::empty_body>;

inline std::string Text(beast::string_view text) { return {text.data(), text.size()}; }

// Converts "a, b" to a list.
inline std::vector<std::string> Words(beast::string_view list) {
  std::vector<std::string> words;
  for (const auto word : http::token_list(list)) words.push_back(Text(word));
  return words;
}

inline HttpRequest HeadOf(const Request& request, std::uint16_t port) {
  return {Text(request.method_string()),
          Text(request.target()),
          Text(request[http::field::host]),
          Text(request[http::field::origin]),
          Text(request[http::field::authorization]),
          Words(request[http::field::sec_websocket_protocol]),
          request.count(http::field::host),
          port};
}

template <class Message>
void SetHeaders(const HttpReply& reply, Message* message) {
  message->set(http::field::server, "PREDICTOR");
  message->set(http::field::content_type, reply.type.empty() ? "text/plain" : reply.type);
  message->set(http::field::cache_control, "no-store");
  message->set("Content-Security-Policy",
               "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
               "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; "
               "frame-ancestors 'none'");
  message->set("X-Content-Type-Options", "nosniff");
  message->set("Referrer-Policy", "no-referrer");
  message->set("X-Frame-Options", "DENY");
  message->set("Cross-Origin-Opener-Policy", "same-origin");
  message->set("Cross-Origin-Resource-Policy", "same-origin");
  if (reply.status == 405) message->set(http::field::allow, "GET");
  if (reply.status == 401) message->set(http::field::www_authenticate, "Bearer");
}

}  // namespace predictor::viewer
