"""The caster sees the very outlines that collide: pymunk's own queries are the judge."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from behaviours.interface import Pose
from sim.raycast import Circle, Outline, Polygon, Rays, Scene, box, cast, crossings, ray

REACH = 5.0


def triangle(size: float) -> Polygon:
    return Polygon(((-size, -size), (size, -size / 2), (0.0, size)))


outlines: st.SearchStrategy[Outline] = st.one_of(
    st.builds(Circle, st.floats(0.05, 1.0)),
    st.builds(box, st.floats(0.1, 6.0), st.floats(0.1, 2.0)),
    st.builds(triangle, st.floats(0.2, 1.5)),
)
poses = st.builds(Pose, st.floats(-6, 6), st.floats(-6, 6), st.floats(-3.1, 3.1))
scenes = st.lists(st.tuples(outlines, poses), max_size=12)


def space_of(things: list[tuple[Outline, Pose]]) -> pymunk.Space:
    space = pymunk.Space()
    for outline, pose in things:
        body = pymunk.Body(body_type=pymunk.Body.STATIC)
        body.position, body.angle = (pose.x, pose.y), pose.theta
        shape = (
            pymunk.Circle(body, outline.radius) if isinstance(outline, Circle) else pymunk.Poly(body, outline.vertices)
        )
        space.add(body, shape)
    return space


def by_pymunk(space: pymunk.Space, start: tuple[float, float], angle: float) -> float:
    """A ray from inside a shape gives alpha 0 there; every shape on the way is asked, the nearest counts."""
    end = start[0] + REACH * math.cos(angle), start[1] + REACH * math.sin(angle)
    found = space.segment_query(start, end, 0.0, pymunk.ShapeFilter())
    inside = any(hit.distance <= 0 for hit in space.point_query(start, 0.0, pymunk.ShapeFilter()))
    return 0.0 if inside else min([REACH * hit.alpha for hit in found], default=REACH)


def scene_of(things: list[tuple[Outline, Pose]]) -> Scene:
    return Scene([outline for outline, _ in things], [pose for _, pose in things], [1.0] * len(things))


@settings(max_examples=150, deadline=None, derandomize=True)
@given(scenes, st.floats(-6, 6), st.floats(-6, 6), st.floats(-3, 3))
def test_every_ray_agrees_with_pymunk(things, x, y, first):
    space = space_of(things)
    angles = first + np.linspace(0, math.tau, 24, endpoint=False)
    rays = Rays(np.full(24, x), np.full(24, y), angles, np.zeros(24))
    ranges, hit = cast(rays, REACH, scene_of(things))
    for angle, got, thing in zip(angles, ranges, hit, strict=True):
        wanted = by_pymunk(space, (x, y), angle)
        nudged = [by_pymunk(space, (x, y), angle + turn) for turn in (-1e-7, 1e-7)]
        grazing = max(nudged) - min(nudged) > 1e-3  # the ray runs along the rim of something: either answer is right
        assert grazing or got == pytest.approx(wanted, abs=1e-6)
        assert (thing == -1) == (got == REACH) or got == pytest.approx(REACH, abs=1e-9)


def test_a_ray_from_inside_a_shape_meets_it_at_once():
    for outline in (Circle(0.5), box(1.0, 1.0)):
        ranges, things = cast(ray((0.1, 0.2), 1.0), REACH, Scene([outline], [Pose(0, 0)], [1.0]))
        assert (ranges[0], things[0]) == (0.0, 0)


def test_no_ray_slips_through_the_corner_between_two_edges():
    scene = Scene([box(1.0, 1.0)], [Pose(2.0, 0.0, math.pi / 4)], [1.0])
    ranges, _ = cast(ray((0.0, 0.0), 0.0), REACH, scene)
    assert ranges[0] == pytest.approx(2 - math.sqrt(0.5))


def test_a_ray_that_leaves_a_surface_does_not_meet_it_again():
    ranges, _ = cast(ray((1.0, 0.0), 0.0), REACH, Scene([Circle(1.0)], [Pose(0, 0)], [1.0]))
    assert ranges[0] == REACH


def test_the_first_of_two_things_at_one_distance_is_the_one_that_is_hit():
    _, things = cast(ray((0.0, 0.0), 0.0), REACH, Scene([Circle(0.5)] * 2, [Pose(2, 0)] * 2, [1.0] * 2))
    assert things[0] == 0


def test_a_ray_above_a_low_thing_goes_on_to_the_tall_one_behind():
    scene = Scene([Circle(0.5), Circle(0.5)], [Pose(2, 0), Pose(4, 0)], [0.3, 1.0])
    assert cast(ray((0, 0), 0.0, 0.2), REACH, scene)[0][0] == pytest.approx(1.5)
    assert cast(ray((0, 0), 0.0, 0.6), REACH, scene)[0][0] == pytest.approx(3.5)


def test_a_thing_that_is_placed_anew_is_seen_there():
    scene = Scene([box(1.0, 1.0)], [Pose(2.0, 0.0)], [1.0])
    scene.place(0, Pose(0.0, 3.0, math.pi / 2))
    assert cast(ray((0, 0), 0.0), REACH, scene)[0][0] == REACH
    assert cast(ray((0, 0), math.pi / 2), REACH, scene)[0][0] == pytest.approx(2.5)


def test_crossings_tell_the_way_in_and_the_way_out():
    met = crossings(ray((0, 0), 0.0), REACH, Scene([Circle(0.5), box(1.0, 2.0)], [Pose(4, 0), Pose(2, 0)], [1.0] * 2))
    assert met.thing.tolist() == [0, 1]
    assert met.enter == pytest.approx([3.5, 1.5])
    assert met.exit == pytest.approx([4.5, 2.5])


def test_an_empty_world_lets_every_ray_pass():
    ranges, things = cast(ray((0, 0), 0.0), REACH, Scene([], [], []))
    assert (ranges[0], things[0]) == (REACH, -1)
