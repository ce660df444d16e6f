"""A run as a film: the lot, the robot on its way, and what drives it.

Takes: a `Recording`, how many frames a second, how fast time goes, and where to write. Gives: an MP4. Leaves alone: the
judgement of the run, and how a run is drawn as one picture (plot.py, which this borrows from).

What stands is drawn once; for each frame the moving parts are drawn over it (Agg, blit) and go through a pipe to
ffmpeg. Needs matplotlib (`rplan[plot]`) and the program ffmpeg.
"""

from __future__ import annotations

import math
import shutil
import subprocess
from bisect import bisect_right
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import islice
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from behaviours.interface import Scan
from rplan.apps.drawing import plot
from rplan.apps.drawing.plot import Pose, Track
from sim.plain import listed, mapping
from sim.recording import Json, Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, LEAST_HEIGHT, MOST_HEIGHT = 960, 320, 1080  # [pixels]
DPI = 100
NOSE = {"polygon": [[0.0, -0.02], [0.5, -0.02], [0.5, 0.02], [0.0, 0.02]]}
"""Shows where the robot looks."""
SCAN_AGE_S = 0.5
"""A scan is shown for so long [s]."""


class VideoError(Exception):
    """No film can be made: what is missing or went wrong, in one line."""


def film(recording: Recording, path: Path | str, *, fps: int = 25, speed: float = 4.0) -> int:
    """Write the film and give the number of its frames; speed: simulated seconds in one second of it.

    Raises VideoError without ffmpeg or where it fails, ImportError without matplotlib, ValueError where the recording
    has no ticks, OSError.
    """
    ffmpeg = shutil.which("ffmpeg")
    if ffmpeg is None:
        raise VideoError("a film needs the program ffmpeg: install it (apt-get install ffmpeg)")
    track = plot.track_of(recording)
    if not track.t:
        raise ValueError("the recording has no ticks: there is nothing to show")
    stage = _Stage(recording, track)
    frames = math.floor((track.t[-1] - track.t[0]) * fps / speed + 1e-9) + 1
    with _encoder(ffmpeg, Path(path), stage.size, fps) as pipe:
        for k in islice(_ticks(track, fps, speed), frames):
            pipe.write(stage.frame(k))
    return frames


def _ticks(track: Track, fps: int, speed: float) -> Iterator[int]:
    """For each frame the tick that it shows."""
    frame = 0
    while True:
        now = track.t[0] + frame * speed / fps
        yield max(0, min(len(track.t), bisect_right(track.t, now + 1e-9)) - 1)
        frame += 1


@contextmanager
def _encoder(ffmpeg: str, path: Path, size: tuple[int, int], fps: int) -> Iterator[IO[bytes]]:
    """Where frames go: the standard input of ffmpeg."""
    path.open("wb").close()  # a place that cannot be written is an OSError, not a word of ffmpeg
    given = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{size[0]}x{size[1]}", "-r", str(fps), "-i", "-"]
    made = ["-an", "-c:v", "libx264", "-preset", "veryfast", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
    command = [ffmpeg, "-y", "-loglevel", "error", *given, *made, "-f", "mp4", str(path)]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdin is not None and process.stderr is not None
    try:
        yield process.stdin
    except BrokenPipeError:
        pass  # it says why, below
    except BaseException:
        process.kill()
        raise
    finally:
        with suppress(BrokenPipeError):
            process.stdin.close()
        said = process.stderr.read().decode("utf-8", errors="replace").strip()
        process.stderr.close()
        code = process.wait()
    if code:
        raise VideoError(f"ffmpeg could not make {path}: {said.splitlines()[-1] if said else f'exit code {code}'}")


class _Stage:
    """The lot with what stands on it, and the parts that move."""

    def __init__(self, recording: Recording, track: Track) -> None:
        world = plot.world_of(recording.header)
        self._track, self._hull, self._donor = track, plot.hull(world), plot.donor_id_of(world)
        self._movers = {str(m.get("id")): m for m in map(mapping, listed(world.get("movers")))}
        self._poses, self._scans = _movers(recording), _scans(recording)
        self._colours = plot.colours_of(recording.header, plot.bands_of(track.act))
        self._figure, self._axes = _figure(plot.bounds_of(world, track))
        plot.draw_standing(self._axes, world)
        self._words = self._figure.text(0.012, 0.985, "", va="top", fontsize=11, family="monospace", parse_math=False)
        (self._way,) = self._axes.plot([], [], color=plot.DRIVEN, lw=1.6, alpha=0.8)
        (self._echoes,) = self._axes.plot([], [], ".", color=plot.SCAN, ms=2.5)
        self._canvas = _canvas(self._figure)
        self.size: tuple[int, int] = self._canvas.get_width_height()
        self._canvas.draw()
        self._ground = self._canvas.copy_from_bbox(self._figure.bbox)

    def frame(self, k: int) -> bytes:
        """The picture of tick k, RGBA."""
        track, act = self._track, self._track.act[k]
        pose, colour = track.pose[k], self._colours[act]
        self._canvas.restore_region(self._ground)
        self._way.set_data([p[0] for p in track.pose[: k + 1]], [p[1] for p in track.pose[: k + 1]])
        self._axes.draw_artist(self._way)
        self._draw_scan(k)
        for name, at in self._poses[k].items():
            is_donor = name == self._donor
            edge = plot.DONOR if is_donor else plot.THING_EDGE
            self._draw(self._movers.get(name, {}), at, "white" if is_donor else plot.MOVER, edge)
        self._draw({"shape": self._hull}, pose, colour, plot.INK)
        self._draw({"shape": NOSE}, pose, plot.INK, plot.INK)
        self._words.set_text(f"{plot.clock(track.t[k]):>8}  {track.stage[k]}  {plot.name_of(act)}")
        self._figure.draw_artist(self._words)
        return bytes(self._canvas.buffer_rgba())

    def _draw(self, thing: Json, at: Pose, face: str, edge: str) -> None:
        patch = plot.outline(mapping(thing.get("shape")), at, face, edge)
        self._axes.add_patch(patch)
        self._axes.draw_artist(patch)
        patch.remove()

    def _draw_scan(self, k: int) -> None:
        """The last scan, unless it is old, from where the robot was then."""
        last = bisect_right(self._scans, self._track.t[k] + 1e-9, key=lambda found: found[0]) - 1
        if last < 0 or self._track.t[k] - self._scans[last][0] > SCAN_AGE_S:
            return
        stamp, scan = self._scans[last]
        then = max(0, bisect_right(self._track.t, stamp + 1e-9) - 1)
        points = plot.seen(scan, self._track.pose[then])
        self._echoes.set_data(points[:, 0], points[:, 1])
        self._axes.draw_artist(self._echoes)


def _canvas(figure: Figure) -> Any:
    """Where frames are drawn; its methods are not typed."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    return FigureCanvasAgg(figure)


def _scans(recording: Recording) -> list[tuple[float, Scan]]:
    """When each scan was made [s], and the scan."""
    found = [reading.lidar for reading in recording.readings if reading.lidar is not None and reading.lidar.fresh]
    return sorted(((scan.stamp, scan) for scan in found), key=lambda pair: pair[0])


def _movers(recording: Recording) -> list[dict[str, Pose]]:
    """For each tick where the things are that move."""
    every = []
    for tick in recording.ticks:
        movers = mapping(mapping(tick.get("world")).get("movers"))
        every.append({str(name): pose for name, value in movers.items() if (pose := plot.pose_of(value))})
    return every


def _figure(bounds: tuple[float, float, float, float]) -> tuple[Figure, Axes]:
    """As wide as it may be; both sides are even numbers of pixels, as the coding wants it."""
    from matplotlib.figure import Figure

    xmin, ymin, xmax, ymax = bounds
    height = min(max(WIDTH * (ymax - ymin) / (xmax - xmin), LEAST_HEIGHT), MOST_HEIGHT)
    figure = Figure(figsize=(WIDTH / DPI, 2 * round(height / 2) / DPI), dpi=DPI)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    plot.frame_axes(axes, bounds)
    axes.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
    return figure, axes
