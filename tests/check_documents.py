#!/usr/bin/env python3
"""Runs the commands that documents show, and follows their links.

Usage: check_documents.py links ROOT                   every link of every page leads somewhere
       check_documents.py run BUILD LAVAPIPE PAGE...   every command works

A page's ```sh blocks run one after the other in one folder, as a reader would type them: with the
programs of BUILD in PATH, the library installed, docs/ in PYTHONPATH, and the model of make_model() there. A comment of
the page before a block says otherwise: `<!-- file: NAME -->` makes it a file of that folder,
`<!-- not run: REASON -->` leaves it out.
"""

import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

DOCS = pathlib.Path(__file__).resolve().parents[1] / "docs"
MARK = re.compile(r"<!-- (file|not run): (.+) -->")


class Block:
    """A fenced block: its line, language, text, and what the comment before it says."""

    def __init__(self, line, language, text, mark):
        self.line, self.language, self.text = line, language, text
        self.kind, self.value = mark or (None, None)


def blocks_of(page):
    blocks, mark, block, first = [], None, None, 0
    language = ""
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if line.startswith("```"):
            if block is None:
                block, language, first = [], line[3:].strip(), number
            else:
                blocks.append(Block(first, language, "\n".join(block) + "\n", mark))
                block = mark = None
        elif block is not None:
            block.append(line)
        elif match := MARK.fullmatch(line):
            mark = match.groups()
        elif line.strip():
            mark = None
    return blocks


def write_png(path, size, texel):
    """An RGB picture, size x size, of texel(x, y)."""
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(size)) for y in range(size))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", size, size, 8, 2, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def make_model(folder):
    """A reader's own model.obj: a cube with a texture."""
    write_png(folder / "wood.png", 16, lambda x, y: (160 + 5 * (x % 7), 110 + 3 * (y % 5), 70))
    (folder / "model.mtl").write_text("newmtl wood\nmap_Kd wood.png\nPr 0.4\n")
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    text = "mtllib model.mtl\nusemtl wood\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    text += "".join("v %d %d %d\n" % corner for corner in corners)
    text += "".join("f " + " ".join(f"{v}/{t}" for t, v in enumerate(face, 1)) + "\n" for face in faces)
    (folder / "model.obj").write_text(text)


def install_library(build, folder):
    """The library of a build, as it is installed, in a folder of `folder`."""
    prefix = pathlib.Path(folder) / "prefix"
    subprocess.run(["cmake", "--install", build, "--prefix", prefix, "--component", "library"],
                   check=True, stdout=subprocess.DEVNULL)
    return prefix


def environment(build, prefix, home):
    """What commands of a page run in: the programs of a build, the library in `prefix`, no display."""
    variables = dict(os.environ, PATH=f"{build}/bin:{os.environ['PATH']}", HOME=home,
                     XDG_CACHE_HOME=home, CMAKE_PREFIX_PATH=str(prefix),
                     PKG_CONFIG_PATH=f"{prefix}/lib/pkgconfig", PYTHONPATH=str(DOCS),
                     PYTHONDONTWRITEBYTECODE="1")
    variables.pop("DISPLAY", None)
    return variables


def write_files(page, folder):
    for block in blocks_of(page):
        if block.kind == "file":
            path = folder / block.value
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text)


def run_commands(page, folder, variables):
    """Runs the page's commands up to the first that fails; returns whether one did."""
    make_model(folder)
    write_files(page, folder)
    for block in blocks_of(page):
        if block.language != "sh" or block.kind is not None:
            continue
        outcome = subprocess.run(["bash", "-euo", "pipefail", "-c", block.text], cwd=folder,
                                 env=variables, stdin=subprocess.DEVNULL, text=True,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if outcome.returncode != 0:
            print(f"{page}:{block.line}: status {outcome.returncode}\n{outcome.stdout}")
            return True
    return False


def run(build, lavapipe, pages):
    failed = False
    with tempfile.TemporaryDirectory() as home:
        variables = environment(build, install_library(build, home), home)
        variables["VK_DRIVER_FILES"] = lavapipe
        for page in map(pathlib.Path, pages):
            folder = pathlib.Path(home) / page.stem
            folder.mkdir()
            failed = run_commands(page, folder, variables) or failed
    return failed


def text_of(page):
    """A page without its fenced blocks and code spans."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    return re.sub(r"`[^`\n]*`", lambda span: "" if "](" in span.group() else span.group(), text)


def anchors_of(page):
    """What a heading is called in a link."""
    headings = re.findall(r"^#+ (.+)$", text_of(page), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def check_links(root):
    failed = False
    folders = [place for place in root.iterdir() if place.is_dir() and place.name not in ("build", ".git")]
    pages = [*root.glob("*.md"), *(page for folder in folders for page in folder.rglob("*.md"))]
    for page in sorted(pages):
        text = text_of(page)
        links = re.findall(r"\]\(([^()\s]+)\)", text) + re.findall(r"(?:src|href)=\"([^\"]+)\"", text)
        for link in links:
            if re.match(r"[a-z]+:", link):
                continue
            name, _, anchor = link.partition("#")
            target = (page.parent / name).resolve() if name else page
            if not target.exists():
                print(f"{page}: {link} leads nowhere")
            elif anchor and re.fullmatch(r"L\d+", anchor):
                continue
            elif anchor and anchor not in anchors_of(target):
                print(f"{page}: {link}: there is no such heading")
            else:
                continue
            failed = True
    return failed


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "links":
        sys.exit(check_links(pathlib.Path(sys.argv[2])))
    if len(sys.argv) > 4 and sys.argv[1] == "run":
        sys.exit(run(sys.argv[2], sys.argv[3], sys.argv[4:]))
    sys.exit(__doc__)
