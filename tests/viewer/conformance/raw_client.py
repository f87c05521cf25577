"""A WebSocket on a plain socket, so that a test controls every byte."""

import base64
import json
import os
import socket
import struct
import urllib.parse

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10


class RawClient:
    """Offers `subprotocols`. status: the HTTP status. subprotocol: the server's choice, or None without one."""

    def __init__(self, url, subprotocols, patience=30):
        parts = urllib.parse.urlsplit(url)
        self._socket = socket.create_connection((parts.hostname, parts.port), patience)
        target = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
        self._socket.sendall(
            f"GET {target} HTTP/1.1\r\nHost: {parts.netloc}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n"
            f"Sec-WebSocket-Protocol: {', '.join(subprotocols)}\r\n\r\n".encode())
        self._buffer = b""
        while b"\r\n\r\n" not in self._buffer:
            self._receive()
        head, self._buffer = self._buffer.split(b"\r\n\r\n", 1)
        lines = head.decode().split("\r\n")
        self.status = int(lines[0].split()[1])
        headers = {k.lower(): v.strip() for k, v in (line.split(":", 1) for line in lines[1:])}
        self.subprotocol = headers.get("sec-websocket-protocol")

    def _receive(self):
        part = self._socket.recv(1 << 16)
        if not part:
            raise ConnectionError("the server ended the connection")
        self._buffer += part

    def _take(self, count):
        while len(self._buffer) < count:
            self._receive()
        taken, self._buffer = self._buffer[:count], self._buffer[count:]
        return taken

    def _send(self, opcode, payload):
        mask = os.urandom(4)
        length = len(payload)
        size = bytes([0x80 | length]) if length < 126 else b"\xfe" + struct.pack(">H", length)
        self._socket.sendall(bytes([0x80 | opcode]) + size + mask +
                             bytes(byte ^ mask[k % 4] for k, byte in enumerate(payload)))

    def send(self, message):
        self._send(TEXT, json.dumps(message).encode())

    def next(self):
        """Returns the next message as a dict, or as bytes if it is binary. Answers pings."""
        whole, kind = b"", None
        while True:
            first, second = self._take(2)
            length = second & 0x7F
            if length == 126:
                (length,) = struct.unpack(">H", self._take(2))
            elif length == 127:
                (length,) = struct.unpack(">Q", self._take(8))
            opcode, payload = first & 0x0F, self._take(length)
            if opcode == PING:
                self._send(PONG, payload)
            elif opcode == CLOSE:
                raise ConnectionError(f"closed: {payload!r}")
            elif opcode != PONG:
                kind = opcode or kind
                whole += payload
                if first & 0x80:
                    return json.loads(whole) if kind == TEXT else whole

    def next_op(self, op):
        while True:
            message = self.next()
            if isinstance(message, dict) and message["op"] == op:
                return message

    def next_data(self):
        """Returns (subscription id, log time [ns], payload) of the next MESSAGE_DATA."""
        while True:
            message = self.next()
            if isinstance(message, bytes) and message[0] == 1:
                subscription, time = struct.unpack_from("<IQ", message, 1)
                return subscription, time, message[13:]

    def close(self):
        self._socket.close()
