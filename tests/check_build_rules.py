#!/usr/bin/env python3
"""The rules of docs/build-systems.md bake what has changed, and nothing else.

Usage: check_build_rules.py BUILD
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import check_documents

BUILD = sys.argv[1]
PAGE = pathlib.Path(__file__).resolve().parents[1] / "docs" / "build-systems.md"


class BuildRules(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.TemporaryDirectory()
        prefix = check_documents.install_library(BUILD, cls.home.name)
        cls.environment = check_documents.environment(BUILD, prefix, cls.home.name)

    @classmethod
    def tearDownClass(cls):
        cls.home.cleanup()

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        check_documents.make_model(self.folder)
        check_documents.write_files(PAGE, self.folder)
        self.run_in(".", "cw2-bake", "model.obj", "-o", "other.glb", "--quiet")

    def run_in(self, folder, *command):
        outcome = subprocess.run(command, cwd=self.folder / folder, env=self.environment, text=True,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(outcome.returncode, 0, outcome.stdout)

    def check(self, outputs, *command):
        """`command`, run in the page's folder, bakes into the folder `outputs`."""
        def baked():
            """Which models the next build makes anew: a bake replaces its output."""
            def inodes():
                return {path.stem: path.stat().st_ino for path in outputs.glob("*.cw2mesh")}
            before = inodes()
            # What is made after this must not have the number of what it replaces.
            keep = [path.open() for path in outputs.glob("*.cw2mesh")]
            self.run_in(".", *command)
            after = inodes()
            for file in keep:
                file.close()
            return {name for name in after if after[name] != before.get(name)}

        outputs = self.folder / outputs
        self.assertEqual(baked(), {"model", "other"})
        self.assertEqual(baked(), set())
        check_documents.write_png(self.folder / "wood.png", 8, lambda x, y: (30 * x, 60, 30 * y))
        self.assertEqual(baked(), {"model"})
        self.assertEqual(baked(), set())
        (self.folder / "model.mtl").write_text("newmtl wood\nmap_Kd wood.png\nmap_Pr rough.png\n")
        check_documents.write_png(self.folder / "rough.png", 8, lambda x, y: (30 * x,) * 3)
        self.assertEqual(baked(), {"model"})
        check_documents.write_png(self.folder / "rough.png", 8, lambda x, y: (30 * y,) * 3)
        self.assertEqual(baked(), {"model"})
        (outputs / "other.cw2mesh").unlink()
        self.assertEqual(baked(), {"other"})
        self.assertEqual(baked(), set())

    def test_make(self):
        self.check("make", "make", "-C", "make")

    def test_ninja(self):
        self.check("ninja", "ninja", "-C", "ninja")

    def check_cmake(self, generator):
        self.run_in("cmake", "cmake", "-G", generator, "-B", "build")
        self.check("cmake/build", "cmake", "--build", "cmake/build")
        model = self.folder / "cmake/build/model.cw2mesh"
        before = model.read_bytes()
        lists = self.folder / "cmake/CMakeLists.txt"
        lists.write_text(lists.read_text().replace("--compress", "--textures none"))
        self.run_in(".", "cmake", "--build", "cmake/build")
        self.assertNotEqual(model.read_bytes(), before)

    def test_cmake_with_ninja(self):
        self.check_cmake("Ninja")

    def test_cmake_with_make(self):
        self.check_cmake("Unix Makefiles")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
