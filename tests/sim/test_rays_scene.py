"""What a scene sees of rings, of starts inside things, of heights and of what moves; and that no cache shows."""

from __future__ import annotations

import math

import numpy as np
import pytest
from experiments.rays_exact import outline, pose

from behaviours.interface import Pose
from sim import raycast, raycast_c
from sim.raycast import Circle, Fan, Polygon, Rays, Rings, Scene, box, cast, crossings, ray, sweep, sweep_things

FAN = Fan(np.arange(72) / 72 * math.tau)
YARD = Rings(
    (
        ((-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)),
        ((-2.0, -2.0), (-2.0, 2.0), (2.0, 2.0), (2.0, -2.0)),
        ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)),
    )
)
BOTH = pytest.mark.parametrize("loops", [raycast_c.loops, lambda: None], ids=["compiled where it can be", "arrays"])


def ring_of(scene: Scene, at: Pose, height: float = 0.1, max_range: float = 5.0) -> tuple[bytes, ...]:
    """All bits of a sweep and of a cast from a hull."""
    hull = np.arange(12) / 12 * math.tau + at.theta
    x, y = at.x + 0.35 * np.cos(hull), at.y + 0.35 * np.sin(hull)
    swept = sweep_things(FAN, at, height, max_range, scene)
    return tuple(array.tobytes() for array in (*swept, *cast(Rays(x, y, hull, np.full(12, height)), max_range, scene)))


# --- starts inside --------------------------------------------------------------------------------


@BOTH
@pytest.mark.parametrize(
    ("x", "y", "inside"),
    [(0.0, 0.0, True), (1.0, 0.0, False), (2.5, 0.1, True), (-2.5, -2.5, True), (1.9, 1.9, False), (3.1, 0.0, False)],
)
def test_a_ray_that_starts_in_the_solid_of_rings_has_no_way_to_go_and_one_in_a_hole_has(loops, x, y, inside):
    for moved in (False, True):
        scene = Scene([Circle(0.1), YARD], [Pose(50, 50), Pose(9, 9) if moved else Pose(0, 0)], [1.0] * 2, loops)
        scene.place(1, Pose(0, 0))
        ranges, things = sweep_things(FAN, Pose(x, y), 0.0, 5.0, scene)
        assert (ranges == 0).all() == inside
        assert (things == 1).all() or not inside
        assert (cast(ray((x, y), 0.3), 5.0, scene)[0][0] == 0) == inside


@BOTH
def test_a_start_deep_in_a_solid_without_an_edge_in_reach_is_inside(loops):
    scene = Scene([box(100.0, 100.0)], [Pose(0, 0)], [1.0], loops)
    assert not sweep(FAN, Pose(3, 4), 0.0, 5.0, scene).any()
    assert not cast(ray((3, 4), 1.0), 5.0, scene)[0].any()


@BOTH
def test_the_first_of_two_things_that_a_ray_starts_in_is_the_one_that_is_hit(loops):
    for outlines in ([Circle(1.0), box(1.0, 1.0)], [box(1.0, 1.0), Circle(1.0)]):
        scene = Scene(outlines, [Pose(0, 0)] * 2, [1.0] * 2, loops)
        assert (sweep_things(FAN, Pose(0.1, 0.1), 0.0, 5.0, scene)[1] == 0).all()
        assert cast(ray((0.1, 0.1), 1.0), 5.0, scene)[1][0] == 0


@BOTH
def test_a_start_in_a_low_thing_sees_what_is_higher(loops):
    scene = Scene([box(1.0, 1.0), Circle(0.5)], [Pose(0, 0), Pose(3, 0)], [0.3, 1.0], loops)
    assert sweep(FAN, Pose(0, 0), 0.2, 5.0, scene)[0] == 0
    assert sweep(FAN, Pose(0, 0), 0.3, 5.0, scene)[0] == 2.5
    assert cast(Rays(*np.array([[0, 0], [0, 0], [0, 0], [0.2, 0.3]], dtype=float)), 5.0, scene)[0].tolist() == [0, 2.5]


# --- rims -----------------------------------------------------------------------------------------


@BOTH
@pytest.mark.parametrize("shape", [box(2.0, 2.0), YARD.rings[0], Circle(1.0)], ids=["box", "rings", "disc"])
@pytest.mark.parametrize("still", [True, False])
def test_a_start_on_a_rim_meets_the_thing_where_the_ray_leads_in_and_not_where_it_leads_away(loops, shape, still):
    thing = Rings((tuple((x / 3, y / 3) for x, y in shape),)) if isinstance(shape, tuple) else shape
    scene = Scene([thing], [Pose(0, 0) if still else Pose(9, 9)], [1.0], loops)
    scene.place(0, Pose(0, 0))
    for x, y in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
        out = math.atan2(y, x)
        angles = out + np.array([0.0, 1.0, -1.0, math.pi, math.pi - 1.0, math.pi + 1.0])
        away = np.array([True] * 3 + [False] * 3)
        ranges, _ = cast(Rays(np.full(6, x), np.full(6, y), angles, np.zeros(6)), 5.0, scene)
        assert ((ranges == 5.0) == away).all()
        assert (ranges[~away] < 1e-12).all()
        one = [sweep(Fan(np.array([angle])), Pose(x, y), 0.0, 5.0, scene)[0] for angle in angles]
        assert ((np.array(one) == 5.0) == away).all()


@BOTH
@pytest.mark.parametrize("many", [1000, 0])
def test_edges_through_the_very_middle_of_a_cell_leave_no_doubt_where_a_start_lies(monkeypatch, loops, many):
    monkeypatch.setattr(raycast, "MANY", many)
    for x, y in ((0.5, 1.5), (0.5, 0.5), (-0.5, 0.5), (1.0, 0.5)):  # with 8 m the middle of the cell is (0.5, 0.5)
        outline = ((x - 1, y - 1), (x, y - 1), (x, y), (x - 1, y))
        for turned in (outline, tuple((b, a) for a, b in reversed(outline))):
            scene = Scene([Rings((turned,)), YARD], [Pose(0, 0), Pose(20, 0)], [1.0] * 2, loops)
            low, high = np.array(turned).min(axis=0), np.array(turned).max(axis=0)
            for at in np.random.default_rng(1).uniform(0, 1, (40, 2)):
                inside = bool(((low < at) & (at < high)).all())
                assert (sweep(FAN, Pose(*at), 0.0, 8.0, scene) == 0).all() == inside
                assert (cast(ray(tuple(at), 0.3), 8.0, scene)[0][0] == 0) == inside


# --- corners --------------------------------------------------------------------------------------


@BOTH
def test_no_ray_slips_between_edges_that_share_a_corner(loops):
    chance = np.random.default_rng(5)
    for _ in range(200):
        turn, count = float(chance.uniform(-3, 3)), int(chance.integers(3, 9))
        ring = tuple((math.cos(k / count * math.tau), math.sin(k / count * math.tau)) for k in range(count))
        at = Pose(*chance.uniform(-1, 1, 2) * 0.3, turn)
        hollow = Rings((tuple((3 * x, 3 * y) for x, y in ring), tuple(reversed(ring))))
        scene = Scene([hollow], [at], [1.0], loops)
        corners = [math.atan2(y - at.y, x - at.x) for x, y in zip(*scene.edges[:2, :], strict=True)]
        fan = Fan(np.unique(corners))
        assert (sweep(fan, Pose(at.x, at.y), 0.0, 9.0, scene) < 3.2).all()
        angles, zeros = np.array(corners), np.zeros(len(corners))
        assert (cast(Rays(zeros + at.x, zeros + at.y, angles, zeros), 9.0, scene)[0] < 3.2).all()


# --- what a cache may not show --------------------------------------------------------------------


@BOTH
@pytest.mark.parametrize(("cells", "many"), [(8, 1000), (1, 1000), (50, 0), (3, 0)])
def test_what_is_kept_and_how_it_is_sorted_never_shows_in_a_bit(monkeypatch, loops, cells, many):
    chance = np.random.default_rng(11)
    outlines, poses = [outline(chance) for _ in range(40)], [pose(chance, 8) for _ in range(40)]
    heights = [float(height) for height in chance.uniform(0, 1, 40)]
    long_lived = Scene(outlines, poses, heights, loops)
    for step in range(40):
        if step % 4 == 0:
            moved = int(chance.integers(40))
            poses[moved] = Pose(1000.0 * (1 + moved), 1000.0) if step % 8 else pose(chance, 8)
            long_lived.place(moved, poses[moved])
        at = pose(chance, 8)
        kept = ring_of(long_lived, at)
        with monkeypatch.context() as other:
            other.setattr(raycast, "CELLS", cells)
            other.setattr(raycast, "MANY", many)
            assert ring_of(Scene(outlines, poses, heights, loops), at) == kept
        assert ring_of(long_lived, at) == kept


def test_the_areas_that_are_kept_are_bounded():
    scene = Scene([Circle(0.5)], [Pose(0, 0)], [1.0])
    for number in range(3 * raycast.KEPT):
        sweep(FAN, Pose(number * 3.0, 0), 0.1, 5.0, scene)
    assert len(scene._areas) <= raycast.KEPT


@BOTH
def test_a_crowd_that_moves_is_seen_wherever_it_goes(loops):
    chance = np.random.default_rng(2)
    outlines = [Circle(0.2) if k % 2 else box(0.4, 0.3) for k in range(200)]
    scene = Scene(outlines, [Pose(0, 0)] * 200, [1.0] * 200, loops)
    for _ in range(5):
        poses = [pose(chance, 15) for _ in outlines]
        for index, there in enumerate(poses):
            scene.place(index, there)
        still = Scene(outlines, poses, [1.0] * 200, loops)
        for at in (pose(chance, 12) for _ in range(5)):
            assert ring_of(scene, at) == ring_of(still, at)


@BOTH
def test_a_thing_that_was_taken_out_is_not_met_and_is_met_again_when_it_is_back(loops):
    scene = Scene([box(1.0, 1.0), Circle(0.5)], [Pose(2, 0), Pose(4, 0)], [1.0] * 2, loops)
    scene.place(0, Pose(1000.0, 1000.0))
    assert sweep_things(FAN, Pose(0, 0), 0.0, 5.0, scene)[1][0] == 1
    scene.place(0, Pose(2, 0))
    assert sweep_things(FAN, Pose(0, 0), 0.0, 5.0, scene)[1][0] == 0


# --- fans -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "bearings", [[], [1.0, 0.0], [0.0, 0.0], [math.nan], [0.0, math.inf], [0.0, 7.0], [[0.0, 1.0]]]
)
def test_bearings_that_make_no_fan_are_refused(bearings):
    with pytest.raises(ValueError, match="must be finite and rise"):
        Fan(np.array(bearings))


@BOTH
def test_a_fan_may_close_the_turn_with_a_second_ray_straight_back(loops):
    scene = Scene([Circle(0.5)], [Pose(-2, 0)], [1.0], loops)
    ranges = sweep(Fan(np.linspace(-math.pi, math.pi, 361)), Pose(0, 0), 0.0, 5.0, scene)
    assert ranges[0] == pytest.approx(1.5) == ranges[-1]


@BOTH
def test_a_sweep_is_the_cast_of_its_rays(loops):
    chance = np.random.default_rng(3)
    outlines, poses = [outline(chance) for _ in range(30)], [pose(chance, 6) for _ in range(30)]
    scene = Scene(outlines, poses, [1.0] * 30, loops)
    for _ in range(30):
        at, ones = pose(chance, 6), np.ones(72)
        ranges, things = cast(Rays(ones * at.x, ones * at.y, FAN.bearings + at.theta, ones * 0), 9.0, scene)
        swept, met = sweep_things(FAN, at, 0.0, 9.0, scene)
        assert np.abs(swept - ranges).max() < 1e-9
        assert (met == things).all()


# --- crossings ------------------------------------------------------------------------------------


def test_a_ray_enters_and_leaves_a_thing_of_rings_several_times():
    met = crossings(ray((-5, 0.1), 0.0), 20.0, Scene([Circle(0.1), YARD], [Pose(0, 9), Pose(0, 0)], [1.0] * 2))
    assert met.thing.tolist() == [1, 1, 1]
    assert met.enter == pytest.approx([2.0, 4.5, 7.0])
    assert met.exit == pytest.approx([3.0, 5.5, 8.0])


def test_crossings_begin_at_the_start_inside_and_end_beyond_the_reach():
    met = crossings(ray((2.5, 0.1), math.pi), 2.2, Scene([YARD], [Pose(0, 0)], [1.0]))
    assert met.enter == pytest.approx([0.0, 2.0])
    assert met.exit == pytest.approx([0.5, 3.0])


def test_the_first_way_in_is_the_range():
    chance = np.random.default_rng(4)
    scene = Scene([outline(chance) for _ in range(30)], [pose(chance, 6) for _ in range(30)], [0.5] * 30)
    for _ in range(40):
        at = pose(chance, 6)
        rays = Rays(np.full(72, at.x), np.full(72, at.y), FAN.bearings, np.linspace(0, 1, 72))
        met, nearest = crossings(rays, 9.0, scene), np.full(72, 9.0)
        np.minimum.at(nearest, met.ray, met.enter)
        assert np.abs(nearest - cast(rays, 9.0, scene)[0]).max() < 1e-9
        assert (met.enter <= met.exit).all()


def test_corners_that_are_grazed_leave_no_way_in_without_a_way_out():
    diamond = Polygon(((-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0)))
    met = crossings(ray((-3, 0.0), 0.0), 9.0, Scene([diamond, diamond], [Pose(0, 0), Pose(0, 1)], [1.0] * 2))
    assert met.enter[0] == pytest.approx(2.0)
    assert met.exit[0] == pytest.approx(4.0)
    assert met.thing.tolist() in ([0], [0, 1])


def test_things_of_many_edges_are_crossed_as_those_of_few(monkeypatch):
    chance = np.random.default_rng(8)
    scene = Scene([outline(chance) for _ in range(30)], [pose(chance, 6) for _ in range(30)], [0.5] * 30)
    for _ in range(10):
        rays = Rays(*chance.uniform(-6, 6, (2, 20)), chance.uniform(-9, 9, 20), chance.uniform(0, 0.8, 20))
        few = crossings(rays, 9.0, scene)
        with monkeypatch.context() as other:
            other.setattr(raycast, "MANY", 0)
            many = crossings(rays, 9.0, scene)
        for name in ("ray", "thing", "enter", "exit"):
            assert getattr(few, name).tobytes() == getattr(many, name).tobytes()


# --- what makes no sense --------------------------------------------------------------------------


def test_no_rays_meet_nothing():
    rays, scene = Rays(*np.zeros((4, 0))), Scene([Circle(0.5), YARD], [Pose(0, 0)] * 2, [1.0] * 2)
    assert [array.size for array in cast(rays, 5.0, scene)] == [0, 0]
    assert crossings(rays, 5.0, scene).ray.size == 0


def test_rays_and_scenes_whose_parts_differ_in_number_are_refused():
    scene = Scene([Circle(0.5)], [Pose(0, 0)], [1.0])
    rays = Rays(np.zeros(1), np.zeros(1), np.zeros(5), np.zeros(5))
    for look in (cast, crossings):
        with pytest.raises(ValueError, match="of one length"):
            look(rays, 5.0, scene)
    with pytest.raises(ValueError, match="2 outlines, 1 poses and 1 heights"):
        Scene([Circle(0.5)] * 2, [Pose(0, 0)], [1.0])
