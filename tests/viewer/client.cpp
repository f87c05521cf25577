#include "viewer/client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace predictor::testing_client {

Socket::Socket(std::uint16_t port, int receive_buffer, const char* source)
    : descriptor_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const timeval patience{10, 0};
  setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  setsockopt(descriptor_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  if (receive_buffer > 0)
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  if (source != nullptr) {
    inet_pton(AF_INET, source, &address.sin_addr);
    (void)!bind(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address);
  }
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    close(descriptor_);
    descriptor_ = -1;
  }
}

Socket::~Socket() {
  if (descriptor_ >= 0) close(descriptor_);
}

Socket::Socket(Socket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), transport_(std::move(other.transport_)) {}

bool Socket::Send(const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const char* rest = bytes.data() + sent;
    const ssize_t n = transport_ ? transport_->Write(rest, bytes.size() - sent)
                                 : send(descriptor_, rest, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

std::string Socket::Receive(std::size_t most) {
  std::string bytes(most, '\0');
  const ssize_t n =
      transport_ ? transport_->Read(bytes.data(), most) : recv(descriptor_, bytes.data(), most, 0);
  bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return bytes;
}

std::string Socket::ReceiveAll() {
  std::string all;
  for (std::string part; !(part = Receive(65536)).empty();) all += part;
  return all;
}

bool Socket::Ended() {
  char byte;
  for (;;) {
    const ssize_t n = recv(descriptor_, &byte, 1, 0);
    if (n > 0) continue;
    return n == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
  }
}

Answer ParseAnswer(const std::string& bytes) {
  Answer answer;
  const std::size_t end = bytes.find("\r\n\r\n");
  if (end == std::string::npos || !bytes.starts_with("HTTP/1.1 ")) return answer;
  answer.status = std::atoi(bytes.c_str() + 9);
  answer.head = bytes.substr(0, end + 2);
  answer.body = bytes.substr(end + 4);
  return answer;
}

Answer Get(std::uint16_t port, const std::string& target, const std::string& head,
           const std::string& method, const std::string& host) {
  Socket socket(port);
  const std::string name = host.empty() ? "127.0.0.1:" + std::to_string(port) : host;
  socket.Send(method + " " + target + " HTTP/1.1\r\nHost: " + name + "\r\nConnection: close\r\n" +
              head + "\r\n");
  return ParseAnswer(socket.ReceiveAll());
}

int Message::close_code() const {
  if (opcode != 8 || payload.size() < 2) return 0;
  return static_cast<unsigned char>(payload[0]) << 8 | static_cast<unsigned char>(payload[1]);
}

WebSocket::WebSocket(std::uint16_t port, const std::string& target, const std::string& subprotocol,
                     const std::string& head, int receive_buffer)
    : WebSocket(Socket(port, receive_buffer), port, target, subprotocol, head) {}

WebSocket::WebSocket(Socket socket, std::uint16_t port, const std::string& target,
                     const std::string& subprotocol, const std::string& head)
    : socket_(std::move(socket)) {
  const std::string host = head.find("Host:") == std::string::npos
                               ? "Host: 127.0.0.1:" + std::to_string(port) + "\r\n"
                               : "";
  socket_.Send("GET " + target + " HTTP/1.1\r\n" + host +
               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
               (subprotocol.empty() ? "" : "Sec-WebSocket-Protocol: " + subprotocol + "\r\n") +
               head + "\r\n");
  std::string bytes;
  while (bytes.find("\r\n\r\n") == std::string::npos) {
    const std::string part = socket_.Receive(4096);
    if (part.empty()) break;
    bytes += part;
  }
  answer_ = ParseAnswer(bytes);
  buffer_ = answer_.body;
}

bool WebSocket::SendFrame(int opcode, const std::string& payload, bool final) {
  std::string frame(1, static_cast<char>(opcode | (final ? 0x80 : 0)));
  const std::size_t n = payload.size();
  if (n < 126) {
    frame += static_cast<char>(0x80 | n);
  } else if (n < 65536) {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(n >> 8);
    frame += static_cast<char>(n);
  } else {
    frame += static_cast<char>(0x80 | 127);
    for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(n >> shift);
  }
  const char mask[4] = {1, 2, 3, 4};
  frame.append(mask, 4);
  for (std::size_t i = 0; i < n; ++i) frame += static_cast<char>(payload[i] ^ mask[i % 4]);
  return socket_.Send(frame);
}

bool WebSocket::Fill(std::size_t bytes) {
  while (buffer_.size() < bytes) {
    const std::string part = socket_.Receive(65536);
    if (part.empty()) return false;
    buffer_ += part;
  }
  return true;
}

std::optional<Message> WebSocket::ReadFrame() {
  if (!Fill(2)) return {};
  const auto byte = [this](std::size_t i) { return static_cast<unsigned char>(buffer_[i]); };
  std::size_t size = byte(1) & 127u, head = 2;
  const std::size_t extra = size == 126 ? 2 : size == 127 ? 8 : 0;
  if (!Fill(head + extra)) return {};
  if (extra > 0) size = 0;
  for (std::size_t i = 0; i < extra; ++i) size = size << 8 | byte(2 + i);
  head += extra;
  if (!Fill(head + size)) return {};
  Message message{byte(0) & 15, buffer_.substr(head, size)};
  buffer_.erase(0, head + size);
  return message;
}

std::optional<Message> WebSocket::Next() {
  for (;;) {
    std::optional<Message> message = ReadFrame();
    if (!message || message->opcode != 9) return message;
    SendFrame(10, message->payload);
  }
}

std::optional<std::string> WebSocket::NextText(const std::string& type) {
  while (const auto message = Next()) {
    if (message->opcode == 8) return {};
    if (message->opcode == 1 &&
        message->payload.find("\"type\":\"" + type + "\"") != std::string::npos)
      return message->payload;
  }
  return {};
}

int WebSocket::CloseCode() {
  while (const auto message = Next())
    if (message->opcode == 8) return message->close_code();
  return 0;
}

std::string WebSocket::Hello(const std::string& code) {
  SendText("{\"type\":\"hello\",\"code\":\"" + code + "\"}");
  return NextText("welcome").value_or("");
}

}  // namespace predictor::testing_client
