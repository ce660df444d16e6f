"""The compiled loops give the bits of the arrays, and nothing needs them."""

from __future__ import annotations

import math
import shutil
import subprocess

import numpy as np
import pytest
from experiments.rays_exact import outline, pose

from behaviours.interface import Pose
from sim import raycast_c
from sim.raycast import Circle, Fan, Rays, Scene, box, cast, sweep_things

FANS = [Fan(np.arange(n) / n * math.tau - 2.0) for n in (1, 24, 360)] + [Fan(np.array([-3.0, -0.1, 0.0, 0.11, 3.1]))]


def both(chance: np.random.Generator, count: int, half: float) -> tuple[Scene, Scene]:
    outlines, poses = [outline(chance) for _ in range(count)], [pose(chance, half) for _ in range(count)]
    heights = [float(height) for height in chance.uniform(0, 1, count)]
    return Scene(outlines, poses, heights), Scene(outlines, poses, heights, lambda: None)


def test_loops_and_arrays_give_the_same_bits():
    chance = np.random.default_rng(9)
    for count, half in ((0, 3.0), (1, 2.0), (20, 5.0), (120, 20.0)):
        compiled, arrays = both(chance, count, half)
        for step in range(30):
            if count and step % 3 == 0:
                index, there = int(chance.integers(count)), pose(chance, half)
                compiled.place(index, there)
                arrays.place(index, there)
            at, height = pose(chance, half), float(chance.uniform(0, 0.8))
            for fan in FANS:
                one, other = sweep_things(fan, at, height, 8.0, compiled), sweep_things(fan, at, height, 8.0, arrays)
                assert [array.tobytes() for array in one] == [array.tobytes() for array in other]
            rays = Rays(*chance.uniform(-half, half, (2, 50)), chance.uniform(-9, 9, 50), chance.uniform(0, 0.8, 50))
            one, other = cast(rays, 8.0, compiled), cast(rays, 8.0, arrays)
            assert [array.tobytes() for array in one] == [array.tobytes() for array in other]


@pytest.mark.parametrize("at", [(0.0, 0.0), (0.5, 0.0), (-0.5, 0.5), (0.5, 0.5), (2.0, 0.0), (0.0, 1e-300)])
def test_loops_and_arrays_agree_on_middles_rims_sides_and_corners(at):
    for thing in (Circle(0.5), box(1.0, 1.0)):
        there = [Pose(0, 0), Pose(2, 0)]
        scenes = [Scene([thing] * 2, there, [1.0] * 2, loops) for loops in (raycast_c.loops, lambda: None)]
        for fan in FANS:
            swept = [sweep_things(fan, Pose(*at, 0.0), 0.0, 5.0, scene) for scene in scenes]
            assert [a.tobytes() for a in swept[0]] == [a.tobytes() for a in swept[1]]


def test_where_there_is_a_compiler_the_source_compiles_without_a_warning(tmp_path):
    compiler = next((found for name in raycast_c.COMPILERS if (found := shutil.which(name))), None)
    if compiler is not None:
        strict = ("-Wall", "-Wextra", "-Werror", "-pedantic", "-o", str(tmp_path / "rays.so"))
        command = [compiler, *raycast_c.FLAGS, *strict, str(raycast_c.SOURCE), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        assert raycast_c.loops() is not None


def test_without_a_compiler_there_are_no_loops(monkeypatch, tmp_path):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert raycast_c.compiled(tmp_path) is None


def test_a_compiler_that_fails_or_hangs_leaves_no_loops_and_no_rest(monkeypatch, tmp_path):
    for error in (subprocess.CalledProcessError(1, "cc"), subprocess.TimeoutExpired("cc", 60)):

        def fails(*args, error=error, **more):
            raise error

        monkeypatch.setattr(shutil, "which", lambda name: "cc")
        monkeypatch.setattr(subprocess, "run", fails)
        assert raycast_c.compiled(tmp_path / "made") is None
        assert list((tmp_path / "made").iterdir()) == []


def test_a_folder_that_cannot_be_made_leaves_no_loops(tmp_path):
    (tmp_path / "file").write_text("not a folder")
    assert raycast_c.compiled(tmp_path / "file" / "below") is None


def test_a_library_that_is_there_is_not_compiled_again(monkeypatch, tmp_path):
    compiles = raycast_c.compiled(tmp_path) is not None
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert (raycast_c.compiled(tmp_path) is not None) == compiles
