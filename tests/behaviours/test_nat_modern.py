"""What the preset `modern` adds to navigation: memory, tracking, giving way, commitment, a lidar in place of sonars."""

import math

import numpy as np
import pytest

from behaviours.catalogue import library
from behaviours.competences.natigation import as_details, behind, nearest_within
from behaviours.cores.circles import Circle
from behaviours.cores.collision import GateSettings, gate, least_gap
from behaviours.cores.commitment import CommitmentSettings, Lock, commit, inherit, turned
from behaviours.cores.evidence import FIRST_IDENT, Evidence, EvidenceSettings
from behaviours.cores.nat import NatSettings, link, make_plan
from behaviours.cores.sectors import LidarRing, sectors_of
from behaviours.cores.tracking import Tracks, TrackSettings, cluster_of, follow
from behaviours.estimators.obstacles import Obstacles
from behaviours.interface import Odometry, Pose, Ranges, Reading, Scan, Workshop

ORIGIN = Pose(0.0, 0.0)
BEARINGS = np.arange(24) / 24 * math.tau


def ring(stamp=0.0, **heard):
    """Nothing within 5 m but what is heard: sector -> range."""
    ranges = np.full(24, 5.0)
    for sector, reach in heard.items():
        ranges[int(sector[1:])] = reach
    return Ranges(stamp, True, BEARINGS, ranges, 5.0, 0.35)


# --- what is remembered ---------------------------------------------------------------------------


def test_an_echo_where_it_was_free_a_moment_ago_is_of_something_that_moves():
    evidence, echo = Evidence(EvidenceSettings()), [(2.0, (2.35, 0.0))]
    assert evidence.sweep(ring(s0=2.0), ORIGIN, echo, 0.0) == [False]
    for k in range(3):
        evidence.sweep(ring(), ORIGIN, [], 0.3 * (k + 1))
    assert evidence.sweep(ring(s0=2.0), ORIGIN, echo, 1.5) == [True]
    assert evidence.sweep(ring(s0=2.0), ORIGIN, echo, 60.0) == [False]


def test_what_stands_is_remembered_until_beams_go_through_it_again_and_again():
    evidence = Evidence(EvidenceSettings())
    evidence.hear([(2.35, 0.0)], 0.0)
    (circle,) = evidence.circles(ORIGIN, 100.0)
    assert (circle.x, circle.y) == (2.35, 0.0) and circle.ident >= FIRST_IDENT
    for k in range(3):
        evidence.sweep(ring(), ORIGIN, [], 0.3 * k)
    assert len(evidence.circles(ORIGIN, 1.0)) == 1
    evidence.sweep(ring(), ORIGIN, [], 1.2)
    assert evidence.circles(ORIGIN, 1.2) == ()


def test_a_dropout_now_and_then_erases_nothing():
    evidence = Evidence(EvidenceSettings())
    evidence.hear([(2.35, 0.0)], 0.0)
    for k in range(20):
        evidence.sweep(ring() if k % 2 else ring(s0=2.0), ORIGIN, [], 0.3 * k)
    assert len(evidence.circles(ORIGIN, 6.0)) == 1


def test_memory_fades_and_is_bounded():
    evidence = Evidence(EvidenceSettings(keep=10.0, kept_obstacles=5))
    evidence.hear([(0.5 * k, 1.0) for k in range(1, 12)], 0.0)
    assert len(evidence.circles(ORIGIN, 9.0)) == 5
    assert evidence.circles(ORIGIN, 11.0) == ()


# --- what moves -----------------------------------------------------------------------------------


def tracked(velocity, sweeps=12, period=0.3, length=0.0):
    tracks = Tracks()
    for k in range(sweeps):
        x, y = 4.0 + velocity[0] * period * k, -3.0 + velocity[1] * period * k
        points = [(x, y + along) for along in np.arange(0.0, length + 0.1, 1.0).tolist()]
        tracks = follow(tracks, points, period * k, TrackSettings())
    return tracks


@pytest.mark.parametrize("velocity", [(0.0, 1.4), (-0.8, 0.3), (2.0, -0.5)])
def test_a_track_has_the_velocity_of_the_thing(velocity):
    (track,) = tracked(velocity, length=3.0).moving(TrackSettings())
    assert track.velocity == pytest.approx(velocity, abs=0.02)


def test_what_stands_does_not_move():
    assert tracked((0.0, 0.0)).moving(TrackSettings()) == ()


def test_a_track_without_echoes_ends():
    tracks = tracked((0.0, 1.0))
    assert follow(tracks, [], 3.6, TrackSettings()).tracks == tracks.tracks
    assert follow(tracks, [], 9.0, TrackSettings()).tracks == ()


def test_points_are_clustered_by_steps():
    assert list(map(len, cluster_of([(0, 0), (5, 0), (1, 0), (2, 0)], 1.2))) == [3, 1]


# --- giving way -----------------------------------------------------------------------------------

AHEAD = Pose(0.0, 0.0, 0.0)


def chosen(*moving, before=math.inf):
    return gate(AHEAD, 0.2, 0.2, 0.35, moving, GateSettings(), before)


def test_with_nothing_in_the_way_the_speed_is_kept():
    assert chosen() == 0.2
    assert chosen(((3.0, 0.0), (0.0, 1.0))) == 0.2


def test_the_robot_waits_for_what_will_cross_close_ahead():
    assert chosen(((0.95, -3.0), (0.0, 1.0))) == 0.0


def test_it_backs_off_where_standing_is_not_enough():
    assert chosen(((0.5, -3.0), (0.0, 1.0))) < 0.0


def test_what_has_passed_holds_nobody_up():
    assert chosen(((0.6, 0.5), (0.0, 1.0))) == 0.2
    assert least_gap(AHEAD, 0.0, 0.35, [((0.6, 0.5), (0.0, 1.0))], GateSettings()) == math.inf


def test_who_gives_way_goes_on_only_with_room_to_spare():
    crossing = ((1.5, -3.0), (0.0, 1.0))
    assert chosen(crossing) == 0.2
    assert chosen(crossing, before=0.0) < 0.2


def test_ranges_count_where_the_robot_is_heading():
    heard = ring(s0=1.0, s12=0.5, s6=0.7)
    assert nearest_within(heard, 0.0, math.pi) == 0.5
    assert nearest_within(heard, 0.0, math.radians(50)) == 1.0
    assert nearest_within(heard, math.pi / 2, math.radians(50)) == 0.7
    assert behind(heard) == 0.5


# --- commitment -----------------------------------------------------------------------------------

SETTINGS = CommitmentSettings()


def planned(*circles, memory=None, robot=ORIGIN):
    return make_plan(circles, robot, Pose(8.0, 0.0), {}, memory or {}, 0.0, NatSettings())


def circle(ident, x, y, radius=0.3):
    return Circle(ident, ((x, y, 0),), x, y, radius)


def test_the_spin_of_what_stands_in_the_way_is_locked():
    locks = commit(planned(circle(0, 2, 0.1)), {}, 8.0, (), SETTINGS)
    assert locks == {0: Lock("ccw", 8.0, SETTINGS.detour)}
    assert inherit({0: ("cw", 0.0)}, locks) == {0: ("ccw", math.inf)}
    again = planned(circle(0, 2, -0.9), memory=inherit({}, locks))
    assert again.groups[0].spin == "ccw"


def test_what_moves_is_free_to_be_passed_on_the_other_side():
    plan = planned(circle(0, 2, 0.1))
    assert commit(plan, {0: Lock("ccw", 8.0, 5.0)}, 8.0, {0}, SETTINGS) == {}


def test_a_group_is_left_once_the_way_is_clear_and_nearer_than_where_it_was_met():
    aside, locks = planned(circle(0, 2, 3.0)), {0: Lock("ccw", 6.0, 5.0)}
    assert commit(aside, locks, 5.9, (), SETTINGS) == locks
    assert commit(aside, locks, 5.5, (), SETTINGS) == {}
    assert inherit({0: ("ccw", math.inf)}, {}) == {0: ("ccw", 0.0)}


def test_a_side_that_leads_too_far_is_given_up_for_the_other_and_that_may_lead_twice_as_far():
    plan = planned(circle(0, 2, 0.1))
    locks = commit(plan, {0: Lock("ccw", 2.0, 5.0)}, 7.5, (), SETTINGS)
    assert locks == {0: Lock("cw", 2.0, 10.0)}
    assert commit(plan, locks, 7.5, (), SETTINGS) == locks
    plan = planned(circle(0, 2, 0.1), memory=inherit({}, locks))
    assert turned(plan.groups[0], locks, 7.5, SETTINGS) == {0: Lock("ccw", 2.0, 10.0)}


def test_circles_that_join_a_group_take_its_lock_and_forgotten_ones_lose_theirs():
    locks = commit(planned(circle(0, 2, 0.1), circle(1, 2, 0.8)), {0: Lock("cw", 8.0, 5.0)}, 8.0, (), SETTINGS)
    assert set(locks) == {0, 1}
    assert commit(planned(), locks, 8.0, (), SETTINGS) == {}


def test_many_circles_are_grouped_as_few_are():
    spots = [(2.0 + 0.37 * k, (k * 7 % 5) * 0.9) for k in range(30)]
    many = [circle(k, x, y, 0.1) for k, (x, y) in enumerate(spots)]
    few = {(i, j) for i in range(30) for j in link([many[i], *many[:0]], {}, NatSettings())[0]}
    assert few == set()
    for k in range(0, 30, 10):
        subset = many[k : k + 10]
        pairs = {(a + k, b + k) for a, row in enumerate(link(subset, {}, NatSettings())) for b in row}
        joined = {(a, b) for a, row in enumerate(link(many, {}, NatSettings())) for b in row}
        assert pairs == {(a, b) for a, b in joined if k <= a < k + 10 and k <= b < k + 10}


def test_a_group_that_moves_is_told_with_its_velocity():
    plan = planned(circle(0, 2, 0.1), circle(1, 2, 3.0))
    details = as_details(plan, {0: (0.5, -1.0)})
    assert [group.get("velocity") for group in details["groups"]] == [[0.5, -1.0], None]


# --- a lidar in place of sonars ---------------------------------------------------------------------


def scan(ranges, mount=ORIGIN, stamp=0.0, fresh=True, field=math.tau):
    count = len(ranges)
    bearings = np.linspace(-field / 2, field / 2, count, endpoint=field < math.tau)
    return Scan(stamp, fresh, mount, bearings, np.array(ranges, dtype=float), 0.1, 6.0)


def test_sectors_hold_the_nearest_range_from_the_hull():
    ranges = np.full(360, 6.0)
    ranges[178:183] = [3.0, 2.5, 2.0, 2.5, 3.0]
    found = sectors_of(scan(ranges), 0.2)
    assert found.ranges[0] == pytest.approx(1.8) and found.max_range == pytest.approx(5.8)
    assert (found.ranges[1:] == found.max_range).all() and found.mount_radius == 0.2


def test_sectors_respect_the_mount():
    ranges = np.full(360, 6.0)
    ranges[180] = 1.0
    ahead = sectors_of(scan(ranges, Pose(0.3, 0.0, 0.0)), 0.2)
    assert ahead.ranges[0] == pytest.approx(1.1)
    turned_left = sectors_of(scan(ranges, Pose(0.0, 0.0, math.pi / 2)), 0.2)
    assert turned_left.ranges[6] == pytest.approx(0.8)


def test_where_no_beam_looks_and_where_beams_fail_nothing_is_known():
    half = sectors_of(scan(np.full(181, 2.0), field=math.pi), 0.2)
    assert np.isnan(half.ranges[12]) and half.ranges[0] == pytest.approx(1.8)
    assert np.isnan(sectors_of(scan(np.full(360, math.nan)), 0.2).ranges).all()


def test_a_scan_that_is_not_fresh_makes_no_fresh_ring():
    ring_of = LidarRing(0.2)
    first, second = (
        Reading(0.1 * k, k, Odometry(ORIGIN, 0.0, 0.0), lidar=scan(np.full(360, 2.0), fresh=not k)) for k in (0, 1)
    )
    a, b = ring_of(first), ring_of(second)
    assert a.fresh and not b.fresh and a.ranges is b.ranges
    assert ring_of(Reading(0.2, 2, Odometry(ORIGIN, 0.0, 0.0))) is None


# --- the switches -----------------------------------------------------------------------------------


def built(**values):
    workshop = Workshop()
    library("natigation").build({name.replace("_", "-"): value for name, value in values.items()}, workshop)
    return next(one for one in workshop.estimators if isinstance(one, Obstacles))


def test_the_preset_sets_the_switches_and_a_plan_may_override_each():
    assert not built().perception.settings.memory
    modern = built(preset="modern").perception.settings
    assert modern.memory and modern.tracking
    assert not built(preset="modern", memory="off").perception.settings.memory
    assert built(tracking="on").perception.settings.tracking


@pytest.mark.parametrize(
    ("name", "value"), [("preset", "newest"), ("memory", "maybe"), ("ranges", "radar"), ("goal_x", math.inf)]
)
def test_what_is_not_known_is_told(name, value):
    with pytest.raises(ValueError, match=name.replace("_", "-")):
        built(**{name: value})


def test_runaway_takes_the_lidar_where_it_is_told_to():
    workshop = Workshop()
    offer = library("runaway").build({"ranges": "lidar", "hull-radius": 0.2}, workshop)
    near = np.full(360, 6.0)
    near[180] = 0.3
    reading = Reading(0.0, 0, Odometry(ORIGIN, 0.0, 0.0), lidar=scan(near))
    for estimator in workshop.estimators:
        estimator.update(reading, {}, {})
    assert offer.percepts["anything-is-too-close"]()
    assert offer.percepts["nearest-range"]() == pytest.approx(0.1)
    with pytest.raises(ValueError, match="hull-radius"):
        library("runaway").build({"hull-radius": 0.0}, Workshop())
