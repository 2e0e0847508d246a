"""Motors on a serial line: the datagrams of `control.robot.messages` in frames, and a bridge between line and socket.

A frame is a datagram and its little-endian CRC-32, encoded by consistent overhead byte stuffing (S. Cheshire, M. Baker,
IEEE/ACM Transactions on Networking 7, 1999), and a zero byte. The encoding contains no zero byte.
"""

import os
import select
import socket
import zlib
from typing import Protocol

from control.robot.link import LARGEST

CHECK = 4  # bytes of a CRC-32
BLOCK = 254  # largest number of bytes after a length


class Line(Protocol):
    """An open serial line with a file descriptor: `serial.Serial` of pyserial on Linux and macOS, or a raw file."""

    def fileno(self) -> int:
        """The file descriptor."""
        ...

    def write(self, data: bytes, /) -> int | None:
        """Write all bytes."""
        ...


def framed(datagram: bytes) -> bytes:
    """Encode a datagram as a frame."""
    frame = bytearray()
    for part in (datagram + zlib.crc32(datagram).to_bytes(CHECK, "little")).split(b"\0"):
        # a length replaces the zero at the end of a part; 255 marks a full block without a zero
        while len(part) >= BLOCK:
            frame += b"\xff" + part[:BLOCK]
            part = part[BLOCK:]
        frame += bytes([len(part) + 1]) + part
    return bytes(frame) + b"\0"


def datagram_of(frame: bytes) -> bytes | None:
    """Decode a frame without its last zero; None if bytes were lost or changed."""
    decoded, k = bytearray(), 0
    while k < len(frame):
        length = frame[k]
        part = frame[k + 1 : k + length]
        if len(part) != length - 1:
            return None
        decoded, k = decoded + part, k + length
        if length <= BLOCK and k < len(frame):
            decoded.append(0)
    datagram = bytes(decoded[:-CHECK])
    return datagram if decoded[-CHECK:] == zlib.crc32(datagram).to_bytes(CHECK, "little") else None


class SerialBridge:
    """Forwards datagrams between a serial line and a UDP socket, to which a `Link` connects.

    Attributes:
        address: host and port of the socket.
        broken: number of damaged frames, which are dropped.

    Args:
        line: the open line.
        peer: host and port that receive the line's datagrams; by default the last sender.
    """

    def __init__(self, line: Line, peer: tuple[str, int] | None = None):
        self._line, self._peer, self._begun = line, peer, b""
        self.broken = 0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.setblocking(False)
        self.address: tuple[str, int] = self._socket.getsockname()

    def close(self) -> None:
        """Close the socket; the line stays open."""
        self._socket.close()

    def forward(self, wait: float = 0.0) -> int:
        """Forward all pending datagrams, and return their number; wait at most `wait` [s] for the first."""
        line, own = self._line.fileno(), self._socket.fileno()
        ready, _, _ = select.select([line, own], [], [], wait)
        count = self._from_line() if line in ready else 0
        return count + self._from_socket() if own in ready else count

    def _from_line(self) -> int:
        """Send the datagrams of all complete frames; keep the begun frame."""
        *frames, begun = (self._begun + os.read(self._line.fileno(), LARGEST)).split(b"\0")
        self._begun = begun[-LARGEST:]
        decoded = [datagram_of(one) for one in frames]
        datagrams = [one for one in decoded if one is not None]
        self.broken += len(decoded) - len(datagrams)
        if self._peer:
            for one in datagrams:
                self._socket.sendto(one, self._peer)
        return len(datagrams)

    def _from_socket(self) -> int:
        """Write all datagrams to the line."""
        count = 0
        while True:
            try:
                datagram, self._peer = self._socket.recvfrom(LARGEST)
            except BlockingIOError:
                return count
            self._line.write(framed(datagram))
            count += 1
