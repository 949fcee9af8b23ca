"""png.py - pictures as PNG, read by code of the tests' own"""
import struct
import zlib


def paeth(a, b, c):
    """The predictor of that name, of the PNG specification."""
    return min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]


def png_read(content):
    """(width, height, rows of pixels: red, green, blue); every chunk's check sum is looked at."""
    assert content[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks = 8, []
    while at < len(content):
        size, = struct.unpack_from(">I", content, at)
        kind, body = content[at + 4:at + 8], content[at + 8:at + 8 + size]
        assert struct.unpack_from(">I", content, at + 8 + size)[0] == zlib.crc32(kind + body)
        chunks.append((kind, body))
        at += 12 + size
    assert chunks[0][0] == b"IHDR" and chunks[-1] == (b"IEND", b"")
    width, height, *form = struct.unpack(">IIBBBBB", chunks[0][1])
    step = {2: 3, 6: 4}[form[1]]  # bytes of a pixel: without and with opacity
    assert form == [8, form[1], 0, 0, 0]
    data = zlib.decompress(b"".join(body for kind, body in chunks if kind == b"IDAT"))
    assert len(data) == height * (step * width + 1)
    above, rows = bytearray(step * width), []
    for y in range(height):
        kind, *line = data[y * (step * width + 1):(y + 1) * (step * width + 1)]
        for n in range(step * width):
            left, corner = (line[n - step], above[n - step]) if n >= step else (0, 0)
            line[n] = line[n] + (0, left, above[n], (left + above[n]) // 2, paeth(left, above[n], corner))[kind] & 255
        above = line
        rows.append([tuple(line[n:n + 3]) for n in range(0, step * width, step)])
    return width, height, rows
