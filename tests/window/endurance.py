#!/usr/bin/env python3
"""A window that much happens to.

Usage: endurance.py events COUNT CW2 SCENE [SEED]
           so many sizes, keys and mouse events at random, under the validation layer: the window
           goes on, ends when it is told to, and nobody complains
       endurance.py memory COUNT CW2 SCENE
           so many frames in changing views, with reloads, in changing sizes: in the first size
           again, the window has no more memory than after all views and reloads in that alone
"""

import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from support.display import Display  # noqa: E402

KEYS = [*"wasdqenmvrhbcflptxzijk123456789", "space", "Tab", "F5", "F12", "shift+F12", "shift+v",
        "shift+3", "Home", "Page_Down", "Page_Up", "question", "Left", "Right", "Return",
        "BackSpace", "ctrl+a", "ctrl+s", "ctrl+c", "alt+x"]
HELD = [*"wasdqe", "shift", "ctrl"]


class Window:
    """cw2 with a display of its own, in a folder of its own."""

    def __init__(self, cw2, scene, *options):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="cw2-endurance-"))
        for name in ("scene.cw2mesh", "other.cw2mesh"):
            shutil.copy(scene, self.folder / name)
        self.display = Display()
        self.environment = dict(os.environ, DISPLAY=self.display.name)
        self.process = subprocess.Popen(
            [cw2, "scene.cw2mesh", "other.cw2mesh", "--size", "200x150", *options],
            cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
            stdout=open(self.folder / "out", "w"), stderr=open(self.folder / "err", "w"))
        self.wait_until(lambda: self.tool("search --onlyvisible --name cw2mesh"))
        self.window = self.tool("search --onlyvisible --name cw2mesh")
        self.wait_until(lambda: self.tool(f"windowfocus {self.window}") == "" and
                        self.tool("getwindowfocus") == self.window)
        self.wait_until(lambda: " ms" in self.title())

    def tool(self, *commands):
        """Output of xdotool for these commands, all by one process."""
        return subprocess.run(["xdotool", "-"], input="\n".join(commands) + "\n", text=True,
                              env=self.environment, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL).stdout.strip()

    def title(self):
        return self.tool(f"getwindowname {self.window}")

    def said(self):
        return (self.folder / "err").read_text()

    def wait_until(self, condition, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            if self.process.poll() is not None:
                sys.exit(f"cw2 has ended with status {self.process.returncode}: {self.said()}")
            if time.monotonic() > end:
                sys.exit("waited in vain: " + self.said())
            time.sleep(0.01)

    def resident(self):
        """Memory in use, KiB."""
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0])

    def end(self):
        """Presses Escape, which may first close something; the status must be 0."""
        for _ in range(20):
            self.tool(f"windowfocus {self.window}", "key Escape")
            try:
                status = self.process.wait(1)
                break
            except subprocess.TimeoutExpired:
                continue
        else:
            sys.exit("Escape does not end it")
        self.display.end()
        if status != 0:
            sys.exit(f"ends with status {status}: {self.said()}")
        said = self.said()
        shutil.rmtree(self.folder)
        return said


def random_event(draw, window):
    kind = draw.random()
    x, y = draw.randint(0, 420), draw.randint(0, 320)
    if kind < 0.15:
        return f"windowsize {window} {draw.randint(1, 400)} {draw.randint(1, 300)}"
    if kind < 0.45:
        return f"mousemove {x} {y}"
    if kind < 0.60:
        return f"{draw.choice(['mousedown', 'mouseup'])} {draw.randint(1, 3)}"
    if kind < 0.70:
        return f"click {draw.randint(1, 5)}"
    if kind < 0.80:
        return f"{draw.choice(['keydown', 'keyup'])} {draw.choice(HELD)}"
    return f"key {draw.choice(KEYS)}"


def check_events(count, cw2, scene, seed=1):
    draw = random.Random(int(seed))
    window = Window(cw2, scene, "--samples", "4", "--validation")
    for first in range(0, count, 10):
        events = [random_event(draw, window.window) for _ in range(min(10, count - first))]
        if first % 500 == 250:
            shutil.copy(scene, window.folder / "new")
            os.replace(window.folder / "new", window.folder / "scene.cw2mesh")
        window.tool(f"windowfocus {window.window}", *events)
        time.sleep(0.03)
        if window.process.poll() is not None:
            sys.exit(f"cw2 has ended with status {window.process.returncode} near event {first} "
                     f"of seed {seed}: {window.said()}")
    window.tool(*(f"keyup {key}" for key in HELD), *(f"mouseup {n}" for n in (1, 2, 3)))
    said = window.end()
    # Of paths that were typed at random.
    wrong = [line for line in said.splitlines()
             if not line.startswith("cw2: ") or "validation" in line]
    if wrong:
        sys.exit("\n".join([f"seed {seed}:", *wrong]))
    print(f"{count} events, seed {seed}: nothing wrong")


def check_memory(count, cw2, scene):
    window = Window(cw2, scene, "--samples", "1")
    draw = random.Random(1)

    def show(frames, resizes):
        """Returns the memory in use where the size is the first one again, MiB."""
        for frame in range(frames):
            before = window.title()
            if frame % 50 == 25:
                shutil.copy(scene, window.folder / "new")
                os.replace(window.folder / "new", window.folder / "scene.cw2mesh")
            size = f"{draw.randint(50, 1280)} {draw.randint(50, 1024)}"
            window.tool(*([f"windowsize {window.window} {size}"] if resizes and frame % 4 == 0 else []),
                        "key v")
            window.wait_until(lambda: window.title().split(" - ")[1] != before.split(" - ")[1])
        window.tool(f"windowsize {window.window} 200 150", "key 1", "key Tab", "key Tab")
        time.sleep(2)
        return window.resident() / 1024

    before = show(60, False)
    after = show(count, True)
    window.end()
    print(f"{before:.1f} MiB before {count} frames, {after:.1f} MiB after them")
    if after > before + 24:
        sys.exit("memory grows")


if __name__ == "__main__":
    kind, count, cw2, scene, *seed = sys.argv[1:]
    {"events": check_events, "memory": check_memory}[kind](
        int(count), pathlib.Path(cw2).resolve(), pathlib.Path(scene).resolve(), *seed)
