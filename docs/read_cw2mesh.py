#!/usr/bin/env python3
"""Reads .cw2mesh files of format version 9, as docs/format.md describes them.

    import read_cw2mesh
    scene = read_cw2mesh.read("model.cw2mesh")
    for mesh in scene.meshes:
        print(scene.materials[mesh.material].name, len(mesh.vertices), mesh.vertices[0].position)

It needs Python 3.8, for compressed files the library libzstd, and nothing else. `python3 read_cw2mesh.py FILE` prints what is in a file. What is
no sound file raises FormatError.
"""

import collections
import ctypes
import functools
import math
import struct
import sys

VERSION = 9
SECTIONS = ("scene", "meshes", "chunks", "materials", "textures", "sources", "strings", "vertices",
            "indices", "texels", "encoded_vertices", "encoded_indices")
MAP_USES = ("base_color", "roughness", "metalness", "normal", "alpha_mask", "emission")
POSITION_FORMS = ("quantised", "f32")
FRAME_FORMS = ("quat48", "quat32", "half3", "f32")
UV_FORMS = ("quantised", "f32")
COLOR_FORMS = ("none", "rgba8")
NO_TEXTURE = 0xFFFFFFFF

# Texture formats: name, texels along a side of a block, bytes of a block, channels of a texel.
FORMATS = (("r8_unorm", 1, 1, 1), ("rg8_unorm", 1, 2, 2), ("rgba8_srgb", 1, 4, 4),
           ("bc1_srgb", 4, 8, 4), ("bc4_unorm", 4, 8, 1), ("bc5_unorm", 4, 16, 2), ("bc7_srgb", 4, 16, 4))


class FormatError(ValueError):
    """Bytes that are no sound file of this format."""


def require(condition, what):
    if not condition:
        raise FormatError(what)


class Record:
    """A record of the file: "name 3f" is a field of three floats, "name I" one uint32."""

    def __init__(self, *fields):
        self.fields = [field.split() for field in fields]
        self.struct = struct.Struct("<" + "".join(form for _, form in self.fields))

    def read(self, data, offset=0):
        values = iter(self.struct.unpack_from(data, offset))
        result = Values()
        for name, form in self.fields:
            count = int(form[:-1]) if len(form) > 1 else 0
            value = tuple(next(values) for _ in range(count)) if count else next(values)
            setattr(result, name, value)
        return result

    def read_all(self, data, what):
        require(len(data) % self.struct.size == 0, f"section {what} ends within a record")
        return [self.read(data, offset) for offset in range(0, len(data), self.struct.size)]


class Values:
    """What a record holds, by the names of its fields."""

    def __repr__(self):
        return repr(self.__dict__)


SECTION = Record("offset Q", "size Q", "checksum Q")
HEADER = Record("magic 8c", "version I", "header_size I", "file_size Q", "checksum Q")
SCENE = Record(
    "origin 3d", "vertex_bytes Q", "index_count Q", "bounds_min 3f", "bounds_max 3f", "radius f",
    "position_step f", "position_error f", "frame_error_mean f", "frame_error_max f", "uv_error f",
    "flags I", "camera_position 3f", "camera_target 3f", "camera_fov f", "light_position 3f",
    "light_color 3f")
MESH = Record(
    "material I", "forms 4B", "vertex_count I", "index_count I", "vertex_offset Q", "first_index Q",
    "origin 3i", "uv_origin 2f", "uv_step 2f", "bounds_min 3f", "bounds_max 3f", "first_chunk I",
    "chunk_count I", "reserved I")
CHUNK = Record("first_index I", "index_count I", "center 3f", "radius f", "cone_axis 3f", "cone_cutoff f")
MATERIAL = Record(
    "name 2I", "base_color 3f", "roughness f", "metalness f", "alpha_cutoff f", "normal_scale f",
    "emission 3f", "opacity f", "flags I", "textures 6I")
TEXTURE = Record(
    "name 2I", "format I", "flags I", "width I", "height I", "mip_count I", "psnr f", "offset Q", "size Q",
    "checksum Q")
SOURCE = Record("key 2Q", "texture I", "alpha_mask I", "flags I", "reserved I")

Vertex = collections.namedtuple("Vertex", "position normal tangent handedness uv color")
Vertex.__doc__ = """A vertex as numbers: position in scene units relative to the scene's origin; unit
normal and tangent, and handedness s = 1 or -1, with bitangent s cross(normal, tangent); uv, whose v = 0
is the top row of an image; color as four bytes, or None."""


def checksum(data):
    """Of bytes, as the file's records state it."""
    words = struct.iter_unpack("<Q", bytes(data) + bytes(-len(data) % 8))
    lanes = [0, 1, 2, 3]
    for i, (word,) in enumerate(words):
        lanes[i & 3] = fold(lanes[i & 3], word)
    result = len(data)
    for lane in lanes:
        result = fold(result, lane)
    return result


def fold(lane, word):
    product = (lane ^ word) * 0x9E3779B97F4A7C15 & 0xFFFFFFFFFFFFFFFF
    return (product << 29 | product >> 35) & 0xFFFFFFFFFFFFFFFF


def split_sections(data):
    """The header's sections by name, once their places and checksums are found to be right."""
    require(data[:8] == b"CW2MESH\0", "is no .cw2mesh file")
    require(len(data) >= HEADER.struct.size + 24 * len(SECTIONS), "is truncated")
    header = HEADER.read(data)
    require(header.version == VERSION, f"has format version {header.version}, not {VERSION}")
    require(header.header_size == HEADER.struct.size + 24 * len(SECTIONS), "the header's size is wrong")
    blank = data[:24] + bytes(8) + data[32:header.header_size]
    require(header.checksum == checksum(blank), "is altered: wrong header checksum")
    require(header.file_size == len(data), "is truncated, or has bytes after its end")
    sections, end = {}, header.header_size
    for i, name in enumerate(SECTIONS):
        section = SECTION.read(data, HEADER.struct.size + 24 * i)
        require(section.offset == (end + 63) // 64 * 64, f"section {name} is not where it belongs")
        require(not any(data[end:section.offset]), "is altered: a byte between two sections")
        end = section.offset + section.size
        require(end <= len(data), f"section {name} is not where it belongs")
        sections[name] = data[section.offset:end]
        if name != "texels":  # each texture has its own
            require(checksum(sections[name]) == section.checksum, f"is altered: section {name}")
    require(end == len(data), "is altered: bytes after the last section")
    return sections


def align(offset, is_wide):
    return (offset + 3) // 4 * 4 if is_wide else offset


def vertex_layout(forms):
    """Offsets of frame, UV and colour in a vertex, and its bytes in all."""
    position, frame, uv, color = forms
    wide = "f32" in (position, frame, uv)
    frame_at = align(12 if position == "f32" else 6, frame == "f32")
    uv_at = align(frame_at + {"quat48": 6, "quat32": 4, "half3": 6, "f32": 16}[frame], uv == "f32")
    color_at = uv_at + (8 if uv == "f32" else 4)
    return frame_at, uv_at, color_at, align(color_at + (4 if color == "rgba8" else 0), wide)


TAN_COEFFICIENTS = (0.00047622071, 0.000476221874, 0.0035121711, 0.0132167106, 0.0531149842, 0.214601785)


def tan_quarter_pi(x):
    """tan(x pi / 4) for |x| <= 1, the polynomial that all decoders share."""
    y = x * x
    q = 0.0
    for c in TAN_COEFFICIENTS:
        q = q * y + c
    return x * (1 - (1 - y) * q)


def digits_to_quaternion(digits, half, largest):
    q = [tan_quarter_pi((digit - half) / half) for digit in digits]
    q.insert(largest, 1.0)
    return q


def half_to_float(word):
    """An IEEE half whose bit 14 is in use for something else."""
    return struct.unpack("<e", struct.pack("<H", word & 0xBFFF))[0]


def single(x):
    """The 32-bit float nearest to a number."""
    return struct.unpack("<f", struct.pack("<f", x))[0]


def unpack_quat48(data, at):
    words = struct.unpack_from("<3H", data, at)
    largest = words[1] >> 15 | words[2] >> 15 << 1
    return digits_to_quaternion([min(w & 0x7FFF, 32766) for w in words], 16383, largest), words[0] >> 15


def unpack_quat32(data, at):
    code, digits = struct.unpack_from("<I", data, at)[0], []
    for _ in range(3):
        code, digit = divmod(code, 811)
        digits.append(digit)
    return digits_to_quaternion(digits, 405, code & 3), code >> 2 & 1


def unpack_half3(data, at):
    words = struct.unpack_from("<3H", data, at)
    x, y, z = map(half_to_float, words)
    square = single(single(x * x + y * y) + z * z)  # in 32 bits: near w = 0 it matters
    w = 1.0 if words[1] & 0x4000 else math.sqrt(max(0.0, 1 - square))
    return (x, y, z, w), words[0] >> 14 & 1


def unpack_f32(data, at):
    x, y, z, w = (min(max(c, -1.0), 1.0) for c in struct.unpack_from("<4f", data, at))
    if x * x + y * y + z * z + w * w < 0.5:  # no writer leaves less than 1
        w = 1.0
    return (x, y, z, abs(w)), data[at + 15] >> 7


UNPACK_FRAME = {"quat48": unpack_quat48, "quat32": unpack_quat32, "half3": unpack_half3, "f32": unpack_f32}


def rotate(q):
    """The images of +x (the tangent) and +z (the normal) under a quaternion of any length."""
    x, y, z, w = q
    s = 2 / (x * x + y * y + z * z + w * w)
    tangent = 1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)
    normal = s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)
    return tangent, normal


def unpack_vertices(data, mesh, step):
    """The vertices of `mesh`, whose first is at the start of `data`; `step` is the scene's."""
    position_form, frame_form, uv_form, color_form = mesh.forms
    frame_at, uv_at, color_at, stride = vertex_layout(mesh.forms)
    unpack_frame = UNPACK_FRAME[frame_form]
    vertices = []
    for at in range(0, mesh.vertex_count * stride, stride):
        if position_form == "quantised":
            words = struct.unpack_from("<3H", data, at)
            position = tuple(step * (o + q) for o, q in zip(mesh.origin, words))
        else:
            position = struct.unpack_from("<3f", data, at)
        quaternion, left_handed = unpack_frame(data, at + frame_at)
        tangent, normal = rotate(quaternion)
        if uv_form == "quantised":
            words = struct.unpack_from("<2H", data, at + uv_at)
            uv = tuple(o + s * q for o, s, q in zip(mesh.uv_origin, mesh.uv_step, words))
        else:
            uv = struct.unpack_from("<2f", data, at + uv_at)
        color = tuple(data[at + color_at:at + color_at + 4]) if color_form == "rgba8" else None
        vertices.append(Vertex(position, normal, tangent, -1 if left_handed else 1, uv, color))
    return vertices


def level_sizes(texture):
    """Width, height, offset in the payload and bytes of each level, largest first."""
    _, side, block_bytes, _ = FORMATS[texture.format]
    offset = 0
    for level in range(texture.mip_count):
        width, height = max(texture.width >> level, 1), max(texture.height >> level, 1)
        size = -(-width // side) * -(-height // side) * block_bytes
        yield width, height, offset, size
        offset += (size + 15) // 16 * 16


def whole_size(texture):
    return sum((size + 15) // 16 * 16 for _, _, _, size in level_sizes(texture))


def bc1_texels(block):
    """The 16 texels of a block, row by row."""
    first, second, indices = struct.unpack("<HHI", block)

    def expand(c):
        r, g, b = c >> 11, c >> 5 & 63, c & 31
        return r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2

    a, b = expand(first), expand(second)
    if first > second:
        rest = [tuple((2 * x + y + 1) // 3 for x, y in zip(a, b)),
                tuple((x + 2 * y + 1) // 3 for x, y in zip(a, b))]
    else:
        rest = [tuple((x + y + 1) // 2 for x, y in zip(a, b)), (0, 0, 0)]
    colors = [bytes(c) + b"\xff" for c in (a, b, *rest)]
    return [colors[indices >> 2 * i & 3] for i in range(16)]


def bc4_texels(block):
    a, b = block[0], block[1]
    steps = 7 if a > b else 5
    values = [a, b] + [((steps - i) * a + i * b + steps // 2) // steps for i in range(1, steps)]
    values += [0, 255] if steps == 5 else []
    indices = int.from_bytes(block[2:], "little")
    return [bytes((values[indices >> 3 * i & 7],)) for i in range(16)]


def bc5_texels(block):
    return [red + green for red, green in zip(bc4_texels(block[:8]), bc4_texels(block[8:]))]


# Of BC7's partitions for two subsets the texels, from the lowest bit, that are in subset 1.
BC7_SUBSETS = (0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80,
               0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8, 0xFF00, 0xFFF0, 0xF000)
BC7_WEIGHTS = (0, 9, 18, 27, 37, 46, 55, 64)


def bc7_texels(block):
    bits = int.from_bytes(block, "little")
    partition = bits >> 2 & 63
    if bits & 3 != 2 or partition >= len(BC7_SUBSETS):
        return [b"\0\0\0\xff"] * 16
    ends = []  # the two of subset 0, the two of subset 1
    for i in range(4):
        seven = [(bits >> 8 + 24 * c + 6 * i & 63) << 1 | bits >> 80 + i // 2 & 1 for c in range(3)]
        ends.append([v << 1 | v >> 6 for v in seven])
    steps, result = bits >> 82, []
    for i in range(16):
        size = 2 if i in (0, 15) else 3
        weight = BC7_WEIGHTS[steps & (1 << size) - 1]
        steps >>= size
        subset = BC7_SUBSETS[partition] >> i & 1
        result.append(bytes((64 - weight) * a + weight * b + 32 >> 6
                            for a, b in zip(ends[2 * subset], ends[2 * subset + 1])) + b"\xff")
    return result


BLOCK_TEXELS = {"bc1_srgb": bc1_texels, "bc4_unorm": bc4_texels, "bc5_unorm": bc5_texels,
                "bc7_srgb": bc7_texels}
PART_BYTES = 128 << 10


def payload(scene, texture):
    """All levels of a texture, as in a plain file."""
    stored = scene.texels[texture.offset:texture.offset + texture.size]
    if not texture.flags & 4:
        return stored
    size = whole_size(texture)
    count = -(-size // PART_BYTES)
    parts = [unwrap(part, PART_BYTES) for part in split_parts(stored, count)]
    require([len(part) for part in parts] ==
            [min(PART_BYTES, size - i * PART_BYTES) for i in range(count)], "compressed texels are damaged")
    return b"".join(parts)


def texels(scene, texture, level=0):
    """Width, height and the texels of a level: rows from the top, 8 bits a channel, of which r8 and bc4
    have one, rg8 and bc5 two (x and y of a normal), and the others four."""
    width, height, offset, size = list(level_sizes(texture))[level]
    name, side, block_bytes, channels = FORMATS[texture.format]
    data = payload(scene, texture)[offset:offset + size]
    if side == 1:
        return width, height, data
    across = -(-width // side)
    rows = [bytearray() for _ in range(-(-height // side) * side)]
    for i in range(0, size, block_bytes):
        block = BLOCK_TEXELS[name](data[i:i + block_bytes])
        top = i // block_bytes // across * side
        for y in range(side):
            rows[top + y] += b"".join(block[side * y:side * (y + 1)])
    return width, height, b"".join(bytes(row[:width * channels]) for row in rows[:height])


# --- Compressed parts -----------------------------------------------------------------------------


@functools.lru_cache(None)
def zstd():
    """The library."""
    for name in ("libzstd.so.1", "libzstd.1.dylib", "libzstd.dll"):
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        library.ZSTD_decompress.restype = ctypes.c_size_t
        library.ZSTD_decompress.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_char_p,
                                            ctypes.c_size_t]
        return library
    raise OSError("compressed files need the library libzstd")


def unwrap(frames, largest):
    """What is in Zstandard frames, one after the other, if that is at most `largest` bytes."""
    data = ctypes.create_string_buffer(largest)
    size = zstd().ZSTD_decompress(data, largest, frames, len(frames))
    require(size <= largest, "compressed bytes are damaged")  # errors are the largest values
    return data.raw[:size]


def split_parts(data, count):
    """The parts of a section of encoded geometry, one a mesh, or of a compressed payload."""
    require(len(data) >= 4 * count, "sizes of parts do not fit")
    at, parts = 4 * count, []
    for size in struct.unpack_from(f"<{count}I", data):
        parts.append(data[at:at + size])
        at += size
    require(at == len(data), "sizes of parts do not fit")
    return parts


GOES_ON, PIVOT_NUMBER, NEXT_TWO, TWO_NUMBERS = 0, 29, 30, 31
CLOSES_PIVOT, CLOSES_SECOND, THIRD_NUMBER = 1, 2, 4


class IndexDecoder:
    """Triangles, each at the border of those before it, and the vertices that each vertex is predicted
    from."""

    def __init__(self, data, triangle_count, vertex_count):
        count, odd = divmod(len(data) - triangle_count, 2)
        require(count >= 0 and not odd, "encoded indices are damaged")
        self.codes = data[:triangle_count]
        self.numbers = [low | high << 8 for low, high in zip(data[triangle_count:][:count],
                                                             data[triangle_count + count:])]
        self.used = self.last = 0
        self.vertex_count = vertex_count
        self.neighbours = []
        # Of each vertex that was reached its place on the border: where the edge to it comes from, the
        # third vertex of that edge's triangle, where the edge from it goes; and one that this hides.
        self.places = {0: [0, 0, 0, None]}
        self.seen = [0] * 32

    def number(self):
        require(self.used < len(self.numbers), "encoded indices are damaged")
        number = self.numbers[self.used]
        self.used += 1
        self.last = self.last + (number >> 1 ^ -(number & 1)) & 0xFFFF
        return self.last

    def reach(self, vertex, neighbours=None):
        """The vertices up to one; without neighbours it has the one before."""
        require(vertex < self.vertex_count, "an index is out of range")
        while len(self.neighbours) <= vertex:
            v = len(self.neighbours)
            self.places[v] = [0, 0, 0, None]
            self.neighbours.append(neighbours if neighbours and v == vertex else (max(v - 1, 0),) * 3)

    def uncover(self, vertex):
        if self.places[vertex][3]:
            self.places[vertex] = self.places[vertex][3]

    def decode(self):
        indices, p, z, beyond = [], 0, 0, 0
        for code in self.codes:
            start, end, y = code >> 3, code & 7, z
            if start != GOES_ON:
                if start < PIVOT_NUMBER:
                    p = self.seen[-start]
                else:
                    p, y = len(self.neighbours), len(self.neighbours) + 1
                    p = p if start == NEXT_TWO else self.number()
                    self.reach(p)
                if start <= PIVOT_NUMBER:
                    y, beyond = self.places[p][:2]
                else:
                    y = self.number() if start == TWO_NUMBERS else y
                    self.reach(y, (p, p, p))
                    beyond = y
                self.seen.append(y)
            z = self.end(end, p, y, beyond)
            if start > PIVOT_NUMBER:
                self.places[p][2] = y
                self.places[y][:2] = p, z
            self.seen.append(z)
            indices += [p, y, z]
            beyond = y
        require(self.used == len(self.numbers), "encoded indices are damaged")
        self.reach(self.vertex_count - 1)
        return tuple(indices), self.neighbours

    def end(self, end, p, y, beyond):
        """The third vertex; the border goes round the triangle from now on."""
        places = self.places
        if end == CLOSES_PIVOT | CLOSES_SECOND:
            z = places[p][2]
            for vertex in (p, y, z):
                self.uncover(vertex)
        elif end == CLOSES_PIVOT:
            z = places[p][2]
            self.uncover(p)
            places[z][:2] = y, p
            places[y][2] = z
        elif end == CLOSES_SECOND:
            z = places[y][0]
            self.uncover(y)
            places[z][2] = p
            places[p][:2] = z, y
        else:
            require(end in (0, THIRD_NUMBER), "encoded indices are damaged")
            z = self.number() if end else len(self.neighbours)
            if z >= len(self.neighbours):
                self.reach(z, (p, y, beyond))
                places[z] = [y, p, p, None]
            else:
                places[z] = places[z][:2] + [p, [y, p, places[z][2], None]]
            places[y][2] = z
            places[p][:2] = z, y
        return z


def read_numbers(stream, at, count, numbers, size):
    """The differences of a part of `numbers` numbers of `size` bytes: a list for each number."""
    result = []
    for k in range(numbers):
        planes = [stream[at + (byte * numbers + k) * count:][:count] for byte in range(size)]
        codes = (int.from_bytes(bytes(code), "little") for code in zip(*planes))
        result.append([code >> 1 ^ -(code & 1) for code in codes])
    return result


def decode_words(differences, neighbours, size, expected=None):
    """The values of a number of `size` bytes of all vertices; floats are numbers of their order."""
    mask, values = 256 ** size - 1, []
    for i, (a, b, c) in enumerate(neighbours):
        if expected:
            value = expected[i]
        else:
            value = values[a] + values[b] - values[c] if i else 0
        values.append(value + differences[i] & mask)
    return values


def to_float_bits(value):
    return value & 0x7FFFFFFF if value >> 31 else ~value & 0xFFFFFFFF


def put_words(columns, size, out, offset, stride):
    """The numbers of a part of all vertices, a list for each number, into `out`."""
    form = struct.Struct("<" + {1: "B", 2: "H", 4: "I"}[size] * len(columns))
    for i, values in enumerate(zip(*columns)):
        form.pack_into(out, i * stride + offset, *values)


def code_differences(stream, at, count):
    """What the codes of quat32 differ by."""
    tops, = read_numbers(stream, at, count, 1, 1)
    digits = read_numbers(stream, at + count, count, 3, 2)
    return [((t * 811 + f) * 811 + e) * 811 + d for t, d, e, f in zip(tops, *digits)]


# --- What triangles tell of frames ------------------------------------------------------------------

UV_MODELS = 1, 3
BY_ANGLE_MODELS = 3, 4


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def shortened(v):
    """Halved until all components have 14 bits and a sign."""
    while any(not -16384 <= c < 16384 for c in v):
        v = [c >> 1 for c in v]
    return list(v)


def nearly_unit(v):
    """Of a length of about 2^14."""
    square, bits = dot(v, v) | 1, 15
    while square < 1 << 28:
        square, bits = square << 2, bits - 1
    x = square >> 16
    y = 43759 - (x * (53827 - (x * 26846 >> 14)) >> 14)
    inverse_root = y * (49152 - (x * (y * y >> 14) >> 14)) >> 15
    return [c * inverse_root >> bits for c in v]


def signed(number, bits):
    return (number + (1 << bits - 1)) % (1 << bits) - (1 << bits - 1)


def parts_by_area(p, q, r, shifts):
    """The normal and the tangent that a triangle of these places adds to each of its corners."""
    e, minus_e, minus_f = ([signed(a - b, 16) for a, b in zip(*ends)] for ends in ((q, p), (p, q), (p, r)))
    normal = [signed(e[k] * minus_f[m] + minus_e[m] * minus_f[k], 32) >> shifts[0]
              for k, m in ((2, 1), (0, 2), (1, 0))]
    along_u = [signed(e[k] * minus_f[4] + minus_f[k] * minus_e[4], 32) for k in range(4)]
    tangent = [c >> shifts[1] for c in along_u]
    if along_u[3] < 0:
        tangent[:3] = [-c for c in tangent[:3]]
    return [(normal, tangent)] * 3


def arc_cosine(cosine):
    cosine = min(max(cosine, -16384), 16384)
    square = cosine * cosine >> 14
    series = 17207 - (square * (2785 - (square * 8582 >> 14)) >> 14)
    return max(25736 - (cosine * series >> 14), 0)


def parts_by_angle(p, q, r):
    """The same by angle."""
    e, f, g = ([signed(a - b, 16) for a, b in zip(*ends)] for ends in ((q, p), (r, p), (r, q)))
    normal = nearly_unit(shortened([signed(c, 32) for c in cross(e, f)]))
    along_u = [signed(f[k] * e[4] - e[k] * f[4], 32) for k in range(4)]
    if along_u[3] < 0:
        along_u[:3] = [signed(-c, 32) for c in along_u[:3]]
    tangent = nearly_unit(shortened(along_u[:3])) + [((along_u[3] > 0) - (along_u[3] < 0)) << 14]
    along_e, along_f, along_g = (nearly_unit(shortened(edge[:3])) for edge in (e, f, g))
    angles = [arc_cosine(dot(along_e, along_f) >> 14), arc_cosine(-dot(along_e, along_g) >> 14),
              arc_cosine(dot(along_f, along_g) >> 14)]
    return [([c * angle >> 14 for c in normal], [c * angle >> 14 for c in tangent]) for angle in angles]


def sum_surfaces(model, indices, count, shifts, out, uv_at, stride):
    """The sums of the normals and of the tangents of each vertex's triangles."""
    places = [struct.unpack_from("<3H", out, i * stride) + struct.unpack_from("<2H", out, i * stride + uv_at)
              for i in range(count)]
    sums = [([0] * 3, [0] * 4) for _ in places]
    for i in range(0, len(indices), 3):
        corners = indices[i:i + 3]
        ends = [places[c] for c in corners]
        parts = parts_by_angle(*ends) if model in BY_ANGLE_MODELS else parts_by_area(*ends, shifts)
        for corner, (normal, tangent) in zip(corners, parts):
            for k in range(3):
                sums[corner][0][k] += normal[k]
            for k in range(4 if model in UV_MODELS else 0):
                sums[corner][1][k] += tangent[k]
    return [([signed(c, 32) for c in normal], [signed(c, 32) for c in tangent]) for normal, tangent in sums]


def angle_of(ratio):
    square = ratio * ratio >> 14
    series = 6700 - (square * (3051 - (square * 813 >> 14)) >> 14)
    return ratio * (20843 - (square * series >> 14)) >> 14


def rotation_of(normal, tangent):
    """The largest component's number, the angles of the other three in units of 45 degrees / 16383, and
    whether it is left-handed, of the quaternion of (t, cross(n, t), n)."""
    n, t = nearly_unit(shortened(normal)), tangent[:3]
    if all(c in (0, -1) for c in t):
        t[0] = 1 << 14
    else:
        t = shortened(t)
    along = dot(t, n) >> 14
    t = nearly_unit([a - (b * along >> 14) for a, b in zip(t, n)])
    b = [c >> 14 for c in cross(n, t)]
    xy, xz, yz = t[1] + b[0], t[2] + n[0], b[2] + n[1]
    xw, yw, zw = b[2] - n[1], n[0] - t[2], t[1] - b[0]
    one = 1 << 14
    rows = [[one + t[0] - b[1] - n[2], xy, xz, xw], [xy, one - t[0] + b[1] - n[2], yz, yw],
            [xz, yz, one - t[0] - b[1] + n[2], zw], [xw, yw, zw, one + t[0] + b[1] + n[2]]]
    largest = max(range(4), key=lambda k: rows[k][k])
    row = rows[largest]
    best = row.pop(largest)
    x = best >> 2
    y = 90124 - (x * (102269 - (x * 40908 >> 14)) >> 14)
    y = 4 * (32758 - (x * y >> 14))
    for _ in range(2):
        y = y * (32768 - (best * y >> 16)) >> 14
    return largest, [angle_of(signed(c * y, 32) >> 16) for c in row], tangent[3] < 0


def expected_frames(form, sums):
    """What is expected of the numbers of each frame: a list for each number."""
    frames = []
    for largest, angles, is_left in (rotation_of(*each) for each in sums):
        if form == "quat48":
            bits = (is_left, largest & 1, largest >> 1)
            frames.append([a + 16383 + (bit << 15) for a, bit in zip(angles, bits)])
        else:
            code = largest + 4 * is_left
            for a in reversed(angles):
                code = code * 811 + (a * 405 + 8192 >> 14) + 405
            frames.append([code])
    return [list(column) for column in zip(*frames)]


def decode_vertices(mesh, indices, neighbours, part):
    """The vertices of a mesh, as in a plain file."""
    position, frame, uv, color = mesh.forms
    frame_at, uv_at, color_at, stride = vertex_layout(mesh.forms)
    count = mesh.vertex_count
    words = [(0, 3, 2 if position == "quantised" else 4), (uv_at, 2, 2 if uv == "quantised" else 4)]
    words += [(color_at, 4, 1)] if color == "rgba8" else []
    words += [(frame_at, *{"quat48": (3, 2), "quat32": (1, 4), "half3": (3, 2), "f32": (4, 4)}[frame])]
    size = 3 + count * (sum(numbers * size for _, numbers, size in words) + 3 * (frame == "quat32"))
    stream = unwrap(part, size)
    require(len(stream) == size, "encoded geometry is damaged")
    model, *shifts = stream[:3]
    require(max(shifts) <= 15 and model <= 4 and
            (model == 0 or frame in ("quat48", "quat32") and position == uv == "quantised"),
            "encoded geometry is damaged")
    out, at = bytearray(count * stride), 3
    for offset, numbers, size in words:
        is_code = offset == frame_at and frame == "quat32"
        differences = [code_differences(stream, at, count)] if is_code else \
            read_numbers(stream, at, count, numbers, size)
        expected = [None] * numbers
        if offset == frame_at and model:
            sums = sum_surfaces(model, indices, count, shifts, out, uv_at, stride)
            expected = expected_frames(frame, sums)
        columns = [decode_words(d, neighbours, size, e) for d, e in zip(differences, expected)]
        if size == 4 and not is_code:
            columns = [[to_float_bits(value) for value in column] for column in columns]
        put_words(columns, size, out, offset, stride)
        at += (7 if is_code else numbers * size) * count
    return out


# --- The file -------------------------------------------------------------------------------------


def read(path):
    """The scene in a file: the fields of its scene record, meshes, materials, textures ..., whose
    fields are those of docs/format.md; meshes have vertices and indices, too."""
    with open(path, "rb") as file:
        return parse(file.read())


def parse(data):
    sections = split_sections(data)
    require(len(sections["scene"]) == SCENE.struct.size, "section scene does not hold one record")
    scene = SCENE.read(sections["scene"])
    scene.meshes = MESH.read_all(sections["meshes"], "meshes")
    scene.chunks = CHUNK.read_all(sections["chunks"], "chunks")
    scene.materials = MATERIAL.read_all(sections["materials"], "materials")
    scene.textures = TEXTURE.read_all(sections["textures"], "textures")
    scene.sources = SOURCE.read_all(sections["sources"], "sources")
    scene.texels = sections["texels"]
    for named in scene.materials + scene.textures:
        offset, length = named.name
        require(offset + length <= len(sections["strings"]), "a name lies outside the strings")
        named.name = sections["strings"][offset:offset + length].decode(errors="replace")
    for material in scene.materials:
        material.textures = {use: None if index == NO_TEXTURE else index
                             for use, index in zip(MAP_USES, material.textures)}
        require(all(index is None or index < len(scene.textures)
                    for index in material.textures.values()), "a texture does not exist")
    for texture in scene.textures:
        check_texture(texture, scene.texels)
    for mesh in scene.meshes:
        check_mesh(scene, mesh)
    if sections["encoded_vertices"]:
        encoded = zip(scene.meshes, split_parts(sections["encoded_vertices"], len(scene.meshes)),
                      split_parts(sections["encoded_indices"], len(scene.meshes)))
        for mesh, vertices, indices in encoded:
            decode_mesh(scene, mesh, vertices, indices)
    else:
        for mesh in scene.meshes:
            unpack_mesh(scene, mesh, sections["vertices"], sections["indices"])
    return scene


def check_texture(texture, data):
    require(texture.format < len(FORMATS), "a texture has an unknown format")
    require(0 < texture.width <= 16384 and 0 < texture.height <= 16384, "a texture's size is out of range")
    require(texture.mip_count == max(texture.width, texture.height).bit_length(), "a mip count is wrong")
    require(texture.flags < 8, "a texture has unknown flags")
    whole = whole_size(texture)
    require(texture.size < whole if texture.flags & 4 else texture.size == whole,
            "a texture's texels do not fit its size")
    require(texture.size * 1000 >= whole, "a texture's compressed texels are implausibly few")
    stored = data[texture.offset:texture.offset + texture.size]
    require(len(stored) == texture.size and checksum(stored) == texture.checksum,
            "is altered: wrong checksum of a texture's texels")


def check_mesh(scene, mesh):
    names = (POSITION_FORMS, FRAME_FORMS, UV_FORMS, COLOR_FORMS)
    require(all(form < len(forms) for form, forms in zip(mesh.forms, names)), "unknown vertex form")
    mesh.forms = tuple(forms[form] for form, forms in zip(mesh.forms, names))
    require(mesh.material < len(scene.materials), "a material does not exist")
    require(0 < mesh.vertex_count <= 65536, "vertex count out of range")
    require(mesh.index_count > 0 and mesh.index_count % 3 == 0, "index count is no multiple of 3")
    require(mesh.vertex_offset + mesh.vertex_count * vertex_layout(mesh.forms)[3] <= scene.vertex_bytes,
            "vertices lie outside their section")
    require(mesh.first_index + mesh.index_count <= scene.index_count, "indices lie outside their section")


def unpack_mesh(scene, mesh, vertices, indices):
    require(len(vertices) == scene.vertex_bytes and len(indices) == 2 * scene.index_count,
            "the scene's sizes do not fit its sections")
    mesh.indices = struct.unpack_from(f"<{mesh.index_count}H", indices, 2 * mesh.first_index)
    require(max(mesh.indices) < mesh.vertex_count, "an index is out of range")
    mesh.vertices = unpack_vertices(vertices[mesh.vertex_offset:], mesh, scene.position_step)


def decode_mesh(scene, mesh, vertices, indices):
    # No triangle takes more than a code, a byte, and three numbers of two.
    stream = unwrap(indices, mesh.index_count // 3 * 7)
    decoder = IndexDecoder(stream, mesh.index_count // 3, mesh.vertex_count)
    mesh.indices, neighbours = decoder.decode()
    data = decode_vertices(mesh, mesh.indices, neighbours, vertices)
    mesh.vertices = unpack_vertices(data, mesh, scene.position_step)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        scene = read(sys.argv[1])
    except (OSError, FormatError) as error:
        sys.exit(f"{sys.argv[1]}: {error}")
    for mesh in scene.meshes:
        print(f"mesh: {mesh.vertex_count} vertices ({', '.join(mesh.forms)}), {mesh.index_count // 3} "
              f"triangles, material {scene.materials[mesh.material].name}")
    for texture in scene.textures:
        print(f"texture {texture.name}: {texture.width} x {texture.height}, {FORMATS[texture.format][0]}")


if __name__ == "__main__":
    main()
