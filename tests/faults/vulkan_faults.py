#!/usr/bin/env python3
"""Lets calls of Vulkan fail, one a run of cw2, under the validation layer and the layer vulkan_layer.cpp.

Usage: vulkan_faults.py files|window CW2 LAYERS SCENE
LAYERS is the folder of the layer's manifest, SCENE a baked file.

Each function fails with each of its errors in turn at its first call and at a later one, or with
CW2_EVERY_FAULT=1 at every call. It must be survived, or be the end: one line on standard error and
status 1. Files are old or new, whole; no object is left, no validation message comes, none waits.
"""

import concurrent.futures
import itertools
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from support.display import Display  # noqa: E402

HOST, DEVICE, START, LOST, MAP = -1, -2, -3, -4, -5
LAYER, EXTENSION, FEATURE, DRIVER, TOO_MANY, FORMAT, FRAGMENTED = -6, -7, -8, -9, -10, -11, -12
POOL, SURFACE, IN_USE, OUT_OF_DATE = -1000069000, -1000000000, -1000000001, -1000001004
NOT_READY, TIMEOUT, SUBOPTIMAL = 1, 2, 1000001003
MEMORY = [HOST, DEVICE]
# What the specification lets them return beside lack of memory. Unlisted ones return only that.
ERRORS = {
    "vkAcquireNextImageKHR": [*MEMORY, LOST, OUT_OF_DATE, SURFACE, SUBOPTIMAL, TIMEOUT, NOT_READY],
    "vkAllocateDescriptorSets": [*MEMORY, FRAGMENTED, POOL],
    "vkAllocateMemory": [*MEMORY, TOO_MANY],
    "vkCreateDescriptorPool": [*MEMORY, FRAGMENTED],
    "vkCreateDevice": [*MEMORY, START, EXTENSION, FEATURE, TOO_MANY, LOST],
    "vkCreateInstance": [*MEMORY, START, LAYER, EXTENSION, DRIVER],
    "vkCreateSampler": [*MEMORY, TOO_MANY],
    "vkCreateSwapchainKHR": [*MEMORY, LOST, SURFACE, IN_USE, START],
    "vkDeviceWaitIdle": [*MEMORY, LOST],
    "vkEnumeratePhysicalDevices": [*MEMORY, START],
    "vkGetPhysicalDeviceImageFormatProperties": [*MEMORY, FORMAT],
    "vkGetPhysicalDeviceSurfaceCapabilitiesKHR": [*MEMORY, SURFACE],
    "vkGetPhysicalDeviceSurfaceFormatsKHR": [*MEMORY, SURFACE],
    "vkGetPhysicalDeviceSurfaceSupportKHR": [*MEMORY, SURFACE],
    "vkGetQueryPoolResults": [*MEMORY, LOST, NOT_READY],
    "vkMapMemory": [*MEMORY, MAP],
    "vkQueuePresentKHR": [*MEMORY, LOST, OUT_OF_DATE, SURFACE, SUBOPTIMAL],
    "vkQueueSubmit": [*MEMORY, LOST],
    "vkQueueSubmit2": [*MEMORY, LOST],
    "vkQueueWaitIdle": [*MEMORY, LOST],
    "vkWaitForFences": [*MEMORY, LOST],
}
# What is no error in a window; the picture is shown again.
PASSING = {OUT_OF_DATE, SUBOPTIMAL, TIMEOUT, NOT_READY}
# The validation layer asks these for itself, whenever something is made, and trusts the answers. It
# crashes where there are no devices, and that of Debian 13 where there are no images.
TRUSTED = {"vkGetPhysicalDeviceImageFormatProperties", "vkGetPhysicalDeviceSurfaceCapabilitiesKHR",
           "vkGetPhysicalDeviceSurfaceFormatsKHR", "vkGetPhysicalDeviceSurfaceSupportKHR"}
NOT_VALIDATED = {"vkEnumeratePhysicalDevices": 2,  # calls without it
                 "vkGetSwapchainImagesKHR": 2}
# From 1.90 on Dear ImGui uploads its font itself, waits for it, and lets go of nothing when that fails.
IMGUI = subprocess.run(["pkg-config", "--modversion", "imgui"], text=True, stdout=subprocess.PIPE,
                       check=True).stdout
UPLOADS_FONT = tuple(map(int, IMGUI.split(".")[:2])) >= (1, 90)
FONT_UPLOAD = {"Buffer": 1, "DeviceMemory": 1}
# What a lost device was doing goes on for it.
OF_LOST = ["in use", "pending state"]
LONGEST = 60  # seconds of a run
EVERY = "CW2_EVERY_FAULT" in os.environ


class Report:
    """What the layer has counted."""

    def __init__(self, path):
        lines = [line.split() for line in path.read_text().splitlines()] if path.exists() else []
        self.calls = {line[1]: int(line[2]) for line in lines if line[0] == "call"}
        self.live = {line[1]: int(line[2]) for line in lines if line[0] == "live"}
        self.failed = ["failed"] in lines


class Run:
    """One run of cw2 in a folder of its own, with what it is given there."""

    def __init__(self, cw2, layers, scene, fault=None, display=None):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="cw2-faults-"))
        for name in ("scene.cw2mesh", "other.cw2mesh"):
            (self.folder / name).symlink_to(scene)
        self.cw2, self.fault, self.display = cw2, fault, display
        system = "/usr/share/vulkan/explicit_layer.d"
        # Older loaders take layers in the order in which they find them.
        self.environment = dict(
            os.environ, VK_LAYER_PATH=f"{system}:{layers}",
            VK_INSTANCE_LAYERS="VK_LAYER_CW2_faults",
            NODEVICE_SELECT="1",  # Mesa's own layer would ask the device for itself, too
            VULKAN_REPORT=str(self.folder / "report"))
        self.validated = not fault or fault[0] not in NOT_VALIDATED
        if self.validated:
            self.environment["VK_INSTANCE_LAYERS"] = (
                "VK_LAYER_KHRONOS_validation:VK_LAYER_CW2_faults")
        if fault:
            self.environment["VULKAN_FAULT"] = " ".join(map(str, fault))
        if display:
            self.environment["DISPLAY"] = display

    def start(self, arguments):
        self.out, self.err = open(self.folder / "out", "w+"), open(self.folder / "err", "w+")
        validation = ["--validation"] if self.validated else []
        return subprocess.Popen([self.cw2, *arguments, *validation], cwd=self.folder,
                                env=self.environment, stdin=subprocess.DEVNULL, stdout=self.out,
                                stderr=self.err)

    def finish(self, process):
        """Waits. Returns what is wrong with the end, whatever it did."""
        try:
            self.status = process.wait(LONGEST)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return ["does not end"]
        said = (self.folder / "err").read_text().splitlines()
        self.report = Report(self.folder / "report")
        lines = [line for line in said if not self.is_mistaken(line)]
        if UPLOADS_FONT and self.report.live == FONT_UPLOAD and said[-1].startswith(
                "cw2: Dear ImGui failed"):
            self.report.live, lines = {}, lines[-1:]
        self.message = "\n".join(lines)
        wrong = []
        if self.status not in (0, 1):
            wrong.append(f"status {self.status}")
        if self.report.live:
            wrong.append(f"leaves {self.report.live}")
        # How often a window is drawn is a matter of time.
        if self.fault and not self.report.failed and (self.status or said or not self.display):
            wrong.append("nothing has failed")
        if len(lines) > 1 or any(not line.startswith("cw2: ") for line in lines):
            wrong.append("says more than one line")
        if "validation" in self.message:
            wrong.append("has a validation message")
        if self.status == 1 and not said:
            wrong.append("says nothing")
        return wrong

    def is_mistaken(self, line):
        """Whether the validation layer says it that knows no better."""
        name, _, result = self.fault or (None, None, None)
        if name in TRUSTED:
            return "validation" in line or not line.startswith("cw2:")
        return result == LOST and "validation:" in line and any(words in line for words in OF_LOST)

    def lines(self):
        """What it has printed."""
        return (self.folder / "out").read_text().splitlines()

    def remove(self):
        shutil.rmtree(self.folder)


PICTURE = ["--size", "24x18", "--samples", "4"]
FILES = {
    "picture": [*PICTURE, "--output", "a.png", "--stats", "a.json"],
    "turn": ["--size", "24x18", "--samples", "1", "--frames", "3", "--output", "%d.exr"],
    "numbers": [*PICTURE, "--pixel", "12,9", "--bench", "2"],
}


WINDOW = ["--size", "80x60", "--samples", "4"]
# Of a scene that is loaded; frames that are drawn meanwhile do without.
RELOADING = ["vkAllocateDescriptorSets", "vkAllocateMemory", "vkBindBufferMemory",
             "vkBindImageMemory", "vkCreateBuffer", "vkCreateCommandPool", "vkCreateDescriptorPool",
             "vkCreateImage", "vkCreateImageView"]
# By these the thread that loads a scene learns of the loss.
LOADING = ["vkQueueSubmit2", "vkQueueWaitIdle"]


def run_files(arguments, old, new, *setting):
    """Returns the run and what is wrong with it. `old` is what is there before, `new` what a run makes."""
    run = Run(*setting)
    for name, contents in old.items():
        (run.folder / name).write_bytes(contents)
    own = {path.name for path in run.folder.iterdir()}
    wrong = run.finish(run.start(["scene.cw2mesh", *arguments]))
    files = {path.name: path.read_bytes() for path in run.folder.iterdir()
             if path.name not in (own - set(old)) | {"out", "err", "report"}}
    run.files = files
    if new is None:
        return run, wrong
    for name, contents in files.items():
        if name not in new:
            wrong.append(f"leaves a file {name}")
        elif not name.endswith(".json") and contents not in (old.get(name), new[name]):
            wrong.append(f"{name} is neither old nor new")
        elif getattr(run, "status", 0) == 0 and contents == old.get(name):
            wrong.append(f"{name} is old, and no error")
    if wrong == [] and run.status == 0 and (run.message or files.keys() != new.keys()):
        wrong.append("succeeds, but not quite")
    if set(old) - set(files):
        wrong.append(f"loses {set(old) - set(files)}")
    return run, wrong


def faults_of(calls):
    """Each of the errors of each function: the first call, and one that is later the longer; or every call."""
    later = itertools.cycle([2, 3, 5, 8, 13, 21, 34, 55, 89])
    for name, count in sorted(calls.items()):
        count = NOT_VALIDATED.get(name, count)
        for result in ERRORS.get(name, MEMORY):
            numbers = range(1, count + 1) if EVERY else {1, min(next(later), count)}
            yield from ((name, number, result) for number in numbers)


def check_files(*setting):
    tasks = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for scenario, arguments in FILES.items():
            run, wrong = run_files(arguments, {}, None, *setting)
            assert not wrong and run.status == 0 and run.report.calls, (wrong, run.message)
            new = run.files
            old = {name: b"what was there" for name in new}
            faults = list(faults_of(run.report.calls))
            if scenario != "picture" and not EVERY:
                faults = faults[::3]
            run.remove()
            for fault in faults:
                tasks.append((scenario, fault, pool.submit(run_files, arguments, old, new, *setting,
                                                           fault)))
        return conclude((scenario, fault, *task.result()) for scenario, fault, task in tasks)


class User:
    """Who looks at the window of a run and presses keys."""

    def __init__(self, run, process):
        self.run, self.process, self.window = run, process, ""
        self.environment = dict(os.environ, DISPLAY=run.display)

    def tool(self, *arguments):
        return subprocess.run(["xdotool", *arguments], env=self.environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout.strip()

    def wait_until(self, condition):
        """False if it does not come to pass, or cw2 ends first."""
        end = time.monotonic() + LONGEST
        while self.process.poll() is None and time.monotonic() < end:
            if condition():
                return True
            time.sleep(0.01)
        return False

    def sees_a_picture(self):
        return (self.wait_until(self.finds_it) and self.wait_until(self.has_the_keyboard)
                and self.wait_until(lambda: " ms" in self.title()))

    def finds_it(self):
        self.window = self.tool("search", "--onlyvisible", "--name", "cw2mesh")
        return self.window

    def has_the_keyboard(self):
        self.tool("windowfocus", self.window)
        return self.tool("getwindowfocus") == self.window

    def title(self):
        return self.tool("getwindowname", self.window)

    def errors(self):
        return (self.run.folder / "err").stat().st_size

    def takes_a_picture(self, key):
        """The path of what it is saved in, None if it is not."""
        printed, errors = len(self.run.lines()), self.errors()
        self.tool("key", key)
        self.wait_until(lambda: len(self.run.lines()) > printed or self.errors() > errors)
        return self.run.folder / self.run.lines()[-1] if len(self.run.lines()) > printed else None


def run_window(display, *setting):
    """A window is sized, shows the panel, opens another file, saves pictures, and ends."""
    run = Run(*setting, display=display.name)
    process = run.start([*WINDOW, "scene.cw2mesh", "other.cw2mesh"])
    user, title = User(run, process), ""
    if user.sees_a_picture():
        user.tool("key", "Tab", "windowsize", user.window, "100", "70", "key", "Page_Down")
        user.wait_until(lambda: user.title().startswith("other") or user.errors() > 0)
        user.takes_a_picture("F12")
        user.takes_a_picture("shift+F12")
        title = user.title()
        user.tool("windowsize", user.window, "90", "80", "key", "Escape")
    wrong = run.finish(process)
    if not wrong and run.status == 0 and run.message and not title.startswith("scene"):
        wrong.append("does not show the old scene")
    fault = run.fault
    if not wrong and fault and fault[2] in PASSING and (run.status != 0 or run.message):
        wrong.append("is no error in a window")
    return run, wrong


def run_reload(display, *setting):
    """A scene that changes and cannot be loaded leaves the old picture, and may change again."""
    run = Run(*setting, display=display.name)
    run.environment["VULKAN_FAULT_AFTER"] = str(run.folder / "armed")
    process = run.start([*WINDOW, "scene.cw2mesh"])
    user, pictures = User(run, process), []

    def change():
        shutil.copy(run.folder / "other.cw2mesh", run.folder / "new")
        os.replace(run.folder / "new", run.folder / "scene.cw2mesh")

    if user.sees_a_picture():
        pictures.append(user.takes_a_picture("F12"))
        (run.folder / "armed").touch()
        change()
        user.wait_until(lambda: " failed: " in user.title())
        pictures.append(user.takes_a_picture("F12"))
        change()
        user.wait_until(lambda: " failed: " not in user.title())
        pictures.append(user.takes_a_picture("F12"))
        user.tool("key", "Escape")
    wrong = run.finish(process)
    if getattr(run, "status", 1) != 0 or not run.message:
        wrong.append("does not go on with a message")
    elif len({picture and picture.read_bytes() for picture in pictures}) != 1:
        wrong.append("does not keep the picture")
    return run, wrong


def run_loss(display, *setting):
    """A device that is lost while another file is loaded is the end, which is said once."""
    run = Run(*setting, display=display.name)
    run.environment["VULKAN_FAULT_AFTER"] = str(run.folder / "armed")
    process = run.start([*WINDOW, "scene.cw2mesh", "other.cw2mesh"])
    user = User(run, process)
    if user.sees_a_picture():
        user.tool("key", "Tab", "Tab")  # nothing lies over the picture any more
        time.sleep(1)  # no frames are drawn
        (run.folder / "armed").touch()
        user.tool("key", "Page_Down")
    wrong = run.finish(process)
    if getattr(run, "status", 1) == 0:
        wrong.append("goes on")
    return run, wrong


def check_window(*setting):
    displays = [Display() for _ in range(os.cpu_count())]
    free = list(displays)

    def somewhere(run, *setting):
        display = free.pop()
        try:
            return run(display, *setting)
        finally:
            free.append(display)

    try:
        with concurrent.futures.ThreadPoolExecutor(len(displays)) as pool:
            run, wrong = somewhere(run_window, *setting)
            assert not wrong and not run.message and run.report.calls, (wrong, run.message)
            faults = [("window", run_window, fault) for fault in faults_of(run.report.calls)]
            faults += [("reload", run_reload, (name, 1, DEVICE)) for name in RELOADING]
            faults += [("loss", run_loss, (name, 1, LOST)) for name in LOADING]
            run.remove()
            tasks = [(scenario, fault, pool.submit(somewhere, run, *setting, fault))
                     for scenario, run, fault in faults]
            return conclude((scenario, fault, *task.result()) for scenario, fault, task in tasks)
    finally:
        for display in displays:
            display.end()


def conclude(outcomes):
    """Prints what is wrong, and how it went. Returns the number of failures."""
    ended, survived, failures = 0, 0, 0
    for scenario, fault, run, wrong in outcomes:
        if wrong:
            failures += 1
            print(f"{scenario}: {' '.join(map(str, fault))}: {', '.join(wrong)}", flush=True)
            print("    " + (run.folder / "err").read_text()[:3000].replace("\n", "\n    "))
        elif run.status == 0:
            survived += 1
        else:
            ended += 1
        run.remove()
    print(f"{ended + survived + failures} faults: {ended} ended with a message, "
          f"{survived} survived, {failures} wrong")
    return failures


if __name__ == "__main__":
    kind = sys.argv[1]
    check = {"files": check_files, "window": check_window}[kind]
    sys.exit(1 if check(*(pathlib.Path(argument).resolve() for argument in sys.argv[2:])) else 0)
