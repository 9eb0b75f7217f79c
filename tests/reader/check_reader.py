#!/usr/bin/env python3
"""Holds docs/read_cw2mesh.py against the library, on a scene baked in every form.

Usage: check_reader.py CW2_BAKE DUMP_CW2MESH
"""

import itertools
import math
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "docs"), str(ROOT / "tests")]
sys.dont_write_bytecode = True
import check_documents  # noqa: E402
import read_cw2mesh  # noqa: E402

BAKE, DUMP = sys.argv[1:3]


def write_scene(folder):
    """A bumpy sphere whose UVs are mirrored on one half and whose place is no round number, a
    second material with a mask and vertex colours, a smooth sheet without UVs, rough ones with
    and without UVs, and textures of odd sizes."""
    random.seed(1)
    rows, columns, lines = 24, 40, ["mtllib scene.mtl", "usemtl ball"]
    for i, j in itertools.product(range(rows + 1), range(columns + 1)):
        a, b = math.pi * i / rows, 2 * math.pi * j / columns
        r = 3 + 0.2 * math.sin(5 * a) * math.cos(4 * b)
        lines.append("v %f %f %f" % (-7.3 + r * math.sin(a) * math.cos(b), r * math.cos(a),
                                     11.1 + r * math.sin(a) * math.sin(b)))
        lines.append("vt %f %f" % (abs(2 * j / columns - 1) * 3 - 1, i / rows))
    for i, j in itertools.product(range(rows), range(columns)):
        a = i * (columns + 1) + j + 1
        b, c, d = a + 1, a + columns + 2, a + columns + 1
        lines.append("f " + " ".join(f"{v}/{v}" for v in (a, b, c, d)))
    lines.append("usemtl leaf")
    for i in range(5):
        lines.append("v %f %f %f %f %f 0.25" % (i, 4 + i % 2, random.random(), i / 4, 1 - i / 4))
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "f -5/-3 -4/-2 -3/-1", "f -3/-3 -2/-2 -1/-1", "usemtl sheet", "s 1"]
    first = 1 + sum(line.startswith("v ") for line in lines)
    for i, j in itertools.product(range(30), range(30)):
        lines.append("v %f %f %f" % (j / 9, math.sin(i / 5) * math.cos(j / 7), -i / 9))
    for i, j in itertools.product(range(29), range(29)):
        corners = (30 * i + j, 30 * i + j + 1, 30 * i + j + 31, 30 * i + j + 30)
        lines.append("f " + " ".join(str(first + k) for k in corners))
    for has_uvs in (False, True):
        lines += [f"usemtl rough{+has_uvs}", *rough_sheet(len(lines), has_uvs)]
    lines.append("")
    (folder / "scene.obj").write_text("\n".join(lines))
    (folder / "scene.mtl").write_text(
        "newmtl ball\nmap_Kd color.png\nmap_Pr rough.png\nnorm normal.png\n"
        "newmtl leaf\nKd 0.5 0.6 0.7\nmap_d mask.png\nmap_Ke glow.png\nnewmtl sheet\n"
        "newmtl rough0\nnewmtl rough1\n")
    draw = check_documents.write_png
    draw(folder / "color.png", 22, lambda x, y: (100 + 2 * x, 80 + 3 * x, 60 + x))
    draw(folder / "rough.png", 13, lambda x, y: (19 * x,) * 3)
    draw(folder / "normal.png", 20, lambda x, y: (118 + x, 138 - y, 254))
    # Of two lines through the colours a block; of two parts once it is compressed.
    draw(folder / "glow.png", 190, lambda x, y: (40 + 30 * (x % 4), 60, 80) if y % 4 < 2 else
         (80, 200, 40 + 30 * (x % 4)))
    draw(folder / "mask.png", 9, lambda x, y: (255 * (x > y),) * 3)


def rough_sheet(seed, has_uvs):
    """Lines of an OBJ, with relative indices."""
    chance, side = random.Random(seed), 16
    places = [(j + 0.6 * chance.random(), i + 0.6 * chance.random(), 0.5 * chance.random())
              for i, j in itertools.product(range(side), repeat=2)]
    faces = []
    for i, j in itertools.product(range(side - 1), repeat=2):
        a, b, c, d = (side * i + j, side * i + j + 1, side * i + j + side, side * i + j + side + 1)
        faces += [(a, b, d), (a, d, c)]
    normals = [[0.0] * 3 for _ in places]
    for face in faces:
        for k, corner in enumerate(face):
            p, q, r = (places[face[m]] for m in (k, k - 2, k - 1))
            u, v = [b - a for a, b in zip(p, q)], [b - a for a, b in zip(p, r)]
            normal = [u[m - 2] * v[m - 1] - u[m - 1] * v[m - 2] for m in range(3)]
            normals[corner] = [a + b for a, b in zip(normals[corner], normal)]
    lines = ["v %f %f %f" % place for place in places]
    lines += ["vt %f %f" % (x / side, y / side + 0.2 * chance.random() / side) for x, y, _ in places]
    lines += ["vn %f %f %f" % tuple(c / math.hypot(*normal) for c in normal) for normal in normals]
    form = "{0}/{0}/{0}" if has_uvs else "{0}//{0}"
    return lines + ["f " + " ".join(form.format(corner - side * side) for corner in face) for face in faces]


def raw_zstd_frame(data):
    """A frame of RFC 8878 that holds bytes as they are."""
    frame, size = struct.pack("<IBI", 0xFD2FB528, 0xA0, len(data)), 1 << 17
    for at in range(0, len(data), size):
        block = data[at:at + size]
        frame += struct.pack("<I", len(block) << 3 | (at + size >= len(data)))[:3] + block
    return frame


def put_checksum(data, start, end, at):
    data[at:at + 8] = read_cw2mesh.checksum(data[start:end]).to_bytes(8, "little")


PAGE = (ROOT / "docs" / "format.md").read_text()
TYPES = {"u8": "B", "u32": "I", "u64": "Q", "i32": "i", "f32": "f", "f64": "d"}


class Page(unittest.TestCase):
    """docs/format.md says what the reader does."""

    def test_every_field_of_every_record(self):
        records = dict(re.findall(r"^### (\w+), \d+ bytes\n(.*?)(?=^#)", PAGE, flags=re.M | re.S))
        sizes = {name: int(size) for name, size in re.findall(r"^### (\w+), (\d+) bytes", PAGE, flags=re.M)}
        for name, size in sizes.items():
            record = getattr(read_cw2mesh, name.replace("Record", "").upper())
            self.assertEqual(record.struct.size, size, name)
            at, fields = 0, []
            for field, form in record.fields:
                fields.append((str(at), form.replace("c", "B"), field))
                at += struct.calcsize("<" + form)
            rows = re.findall(r"^\| (\d+) \| (\w+)(?:\[(\d)\])? \| (\w+) \|", records[name], flags=re.M)
            self.assertEqual([(at, count + TYPES[kind], field) for at, kind, count, field in rows], fields)
        self.assertEqual(len(sizes), 8)

    def test_lists(self):
        sections = re.findall(r"^\| (\d+) (\w+(?: \w+)?) \| (?!is)", PAGE, flags=re.M)[:12]
        self.assertEqual([name.replace(" ", "_") for _, name in sections], list(read_cw2mesh.SECTIONS))
        forms = re.findall(r"\| (\d) (\w+) \| (\d+) \|", PAGE)
        self.assertEqual([name for _, name, _ in forms],
                         [*read_cw2mesh.POSITION_FORMS, *read_cw2mesh.FRAME_FORMS,
                          *read_cw2mesh.UV_FORMS, *read_cw2mesh.COLOR_FORMS])
        formats = re.findall(r"^\| (\d) (\w+_(?:unorm|srgb)) \|", PAGE, flags=re.M)
        self.assertEqual([(int(number), name) for number, name in formats],
                         list(enumerate(form[0] for form in read_cw2mesh.FORMATS)))
        self.assertIn(f"Format version {read_cw2mesh.VERSION}.", PAGE)
        self.assertIn(f"| version | {read_cw2mesh.VERSION} |", PAGE)
        self.assertIn(f"format {read_cw2mesh.VERSION};", (ROOT / "CHANGELOG.md").read_text())

    def test_checksums(self):
        for size, value in ((0, "none"), (40, "0, 1, 2 ... 39"), (43, "0, 1, 2 ... 42")):
            self.assertIn(f"| {value} | {read_cw2mesh.checksum(bytes(range(size))):#018x} |", PAGE)


class Reader(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        write_scene(cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def bake(self, *options):
        path = self.folder / "scene.cw2mesh"
        subprocess.run([BAKE, self.folder / "scene.obj", "-o", path, "--quiet", *options], check=True)
        return path

    def compare(self, *options):
        """Every vertex, index and texel is what the library says; returns the scene."""
        return self.compare_file(self.bake(*options))

    def compare_file(self, path):
        scene = read_cw2mesh.read(path)
        dump = subprocess.run([DUMP, path], check=True, stdout=subprocess.PIPE).stdout
        at = 0
        for mesh in scene.meshes:
            self.assertEqual(struct.unpack_from("<2I", dump, at), (len(mesh.vertices), len(mesh.indices)))
            at += 8
            for vertex in mesh.vertices:
                theirs = struct.unpack_from("<12f4B", dump, at)
                at += 52
                self.assertEqual(vertex.position, theirs[:3])
                ours = (*vertex.normal, *vertex.tangent, vertex.handedness, *vertex.uv)
                for a, b in zip(ours, theirs[3:12]):
                    self.assertAlmostEqual(a, b, delta=1e-6)
                self.assertEqual(vertex.color or (255,) * 4, theirs[12:])
            self.assertEqual(mesh.indices, struct.unpack_from(f"<{len(mesh.indices)}H", dump, at))
            at += 2 * len(mesh.indices)
        for texture in scene.textures:
            for level in range(texture.mip_count):
                texels = read_cw2mesh.texels(scene, texture, level)[2]
                self.assertEqual(dump[at:at + len(texels)], texels)
                at += len(texels)
        self.assertEqual(at, len(dump))
        return scene

    def test_every_form_of_a_vertex(self):
        hands, forms, models = set(), set(), set()
        sums = read_cw2mesh.sum_surfaces

        def spy(model, *arguments):
            models.add((frame, model))
            return sums(model, *arguments)

        for frame, positions, compress in itertools.product(
                read_cw2mesh.FRAME_FORMS, ("quantised", "f32"), ([], ["--compress"])):
            with self.subTest(frame=frame, positions=positions, compress=compress), \
                    unittest.mock.patch.object(read_cw2mesh, "sum_surfaces", spy):
                scene = self.compare("--textures", "none", "--tangent-frame", frame,
                                     "--positions", positions, *compress)
                hands |= {vertex.handedness for mesh in scene.meshes for vertex in mesh.vertices}
                forms |= {mesh.forms for mesh in scene.meshes}
        self.assertEqual(hands, {1, -1})
        self.assertEqual({form[1] for form in forms}, set(read_cw2mesh.FRAME_FORMS))
        self.assertEqual({form[0] for form in forms}, {"quantised", "f32"})
        self.assertEqual({form[3] for form in forms}, {"none", "rgba8"})
        self.assertLessEqual(set(itertools.product(("quat48", "quat32"), (1, 2))), models)

    def test_textures(self):
        formats = set()
        for kind, compress in itertools.product(("bc", "lossless"), ([], ["--compress"])):
            scene = self.compare("--textures", kind, *compress)
            self.assertEqual(any(texture.flags & 4 for texture in scene.textures), bool(compress))
            formats |= {read_cw2mesh.FORMATS[texture.format][0] for texture in scene.textures}
            names = {scene.textures[index].name for material in scene.materials
                     for index in material.textures.values() if index is not None}
            self.assertEqual(names, {"color.png", "rough.png", "normal.png", "mask.png", "glow.png"})
        self.assertEqual(formats, {form[0] for form in read_cw2mesh.FORMATS})

    def test_bytes_that_no_bake_writes(self):
        """Random codes of frames, and random blocks; checksums made right again."""
        random.seed(3)
        for frame in ("quat48", "quat32", "half3"):
            path = self.bake("--tangent-frame", frame)
            data = bytearray(path.read_bytes())
            header = read_cw2mesh.HEADER.struct.size
            place = {}
            for i, name in enumerate(read_cw2mesh.SECTIONS):
                place[name] = read_cw2mesh.SECTION.read(data, header + 24 * i)
            for name in ("vertices", "texels"):
                size = place[name].size
                data[place[name].offset:place[name].offset + size] = random.randbytes(size)
            for i, texture in enumerate(read_cw2mesh.read(path).textures):
                start = place["texels"].offset + texture.offset
                record = place["textures"].offset + i * read_cw2mesh.TEXTURE.struct.size
                put_checksum(data, start, start + texture.size, record + 48)
            for i, name in enumerate(read_cw2mesh.SECTIONS):
                start, end = place[name].offset, place[name].offset + place[name].size
                if name != "texels":
                    put_checksum(data, start, end, header + 24 * i + 16)
            data[24:32] = bytes(8)
            put_checksum(data, 0, header + 24 * len(read_cw2mesh.SECTIONS), 24)
            path.write_bytes(data)
            self.compare_file(path)

    def test_encoded_geometry_that_no_bake_writes(self):
        """Whatever is in the parts, the end is a scene or a FormatError."""
        random.seed(4)
        scene = self.bake("--textures", "none", "--compress").read_bytes()
        header, ends = read_cw2mesh.HEADER.struct.size, set()
        for _ in range(60):
            data = bytearray(scene)
            for i in (10, 11):
                place = read_cw2mesh.SECTION.read(data, header + 24 * i)
                for _ in range(random.choice((0, 1, 3))):
                    data[place.offset + random.randrange(place.size)] = random.randrange(256)
                put_checksum(data, place.offset, place.offset + place.size, header + 24 * i + 16)
            data[24:32] = bytes(8)
            put_checksum(data, 0, header + 24 * len(read_cw2mesh.SECTIONS), 24)
            try:
                read_cw2mesh.parse(bytes(data))
                ends.add("read")
            except read_cw2mesh.FormatError:
                ends.add("refused")
        self.assertEqual(ends, {"read", "refused"})

    def test_vertex_streams_of_any_bytes(self):
        """Triangles of all sizes, of every frame model."""
        random.seed(6)
        header, record = read_cw2mesh.HEADER.struct.size, read_cw2mesh.SECTION
        for frame, model in itertools.product(("quat48", "quat32"), range(5)):
            path = self.bake("--textures", "none", "--compress", "--tangent-frame", frame)
            scene, data = read_cw2mesh.read(path), path.read_bytes()
            vertices, indices = (record.read(data, header + 24 * i) for i in (10, 11))
            frames = []
            for mesh in scene.meshes:
                planes = 16 + (frame == "quat32") + 4 * (mesh.forms[3] == "rgba8")
                head = bytes([model, random.randrange(16), random.randrange(16)])
                stream = head + random.randbytes(planes * mesh.vertex_count)
                frames.append(raw_zstd_frame(stream))
            section = b"".join(struct.pack("<I", len(frame)) for frame in frames) + b"".join(frames)
            whole = bytearray(data[:vertices.offset] + section + bytes(-len(section) % 64) +
                              data[indices.offset:])
            moved = vertices.offset + len(section) + -len(section) % 64
            for i, (offset, size) in {10: (vertices.offset, len(section)), 11: (moved, indices.size)}.items():
                struct.pack_into("<2Q", whole, header + 24 * i, offset, size)
                put_checksum(whole, offset, offset + size, header + 24 * i + 16)
            struct.pack_into("<2Q", whole, 16, len(whole), 0)
            put_checksum(whole, 0, header + 24 * len(read_cw2mesh.SECTIONS), 24)
            path.write_bytes(whole)
            with self.subTest(frame=frame, model=model):
                self.compare_file(path)

    def test_damage_is_found(self):
        data = self.bake().read_bytes()
        random.seed(2)
        for _ in range(60):
            at, size = random.randrange(len(data)), random.randrange(len(data))
            altered = data[:at] + bytes([data[at] ^ 1 << random.randrange(8)]) + data[at + 1:]
            for damaged in (altered, data[:size], data + b"\0"):
                with self.assertRaises(read_cw2mesh.FormatError):
                    read_cw2mesh.parse(damaged)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
