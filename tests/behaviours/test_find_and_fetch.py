"""Finding and fetching with a stand-in of the plan: the donor's place, doubt about it, and the whole task."""

import math

import pytest

from behaviours.estimators.donor import DonorMemory, DonorSettings
from behaviours.estimators.home import Home
from behaviours.estimators.ir_search import Direction, IrSearch, IrSettings
from behaviours.estimators.navigation import ArrivalSettings, NavigationGoal
from behaviours.estimators.stereo_search import Found, StereoSearch, StereoSettings
from behaviours.interface import IrReading, Odometry, Pose, Reading, wrap

FIELD = [(2.5, 1.0, 0.3), (4.2, -1.3, 0.3), (4.6, 1.2, 0.2), (2.3, -1.4, 0.25)]


def lot(standin, seed=0, bearing=0.3, feet=25.0, **kinds):
    """A donor at `bearing` from the robot's heading; fixations are quick, so that a run is short."""
    away = feet * standin.FOOT
    donor = standin.Disc(away * math.cos(bearing), away * math.sin(bearing), 0.25, 0.8)
    return standin.World(seed=seed, donor=donor, ir_period=0.2, stereo_period=0.3, dropout=0.02, **kinds)


def run(robot, world, until, limit):
    """Tick until the condition holds; False when the time [s] is over."""
    while world.stamp < limit:
        robot.tick(world)
        if until():
            return True
    return False


def located(standin, world, **settings):
    robot = standin.Fetcher(**settings)
    assert run(robot, world, robot.percepts["donor-has-been-located"], 120)
    return robot


def test_the_searches_follow_each_other_and_give_the_docking_pose(standin):
    world = lot(standin, sonar_sd=0.0)
    robot = located(standin, world)
    names = [name for _, name in robot.actions]
    assert names[:4] == ["start-ir-search", "continue-ir-search", "start-stereo-ranging", "continue-stereo-search"]
    dock = robot.values["set-goal-as-the-donors-location"]({})
    front = math.hypot(world.donor.x, world.donor.y) - world.donor.radius
    assert math.hypot(dock.x, dock.y) == pytest.approx(front - 0.65, abs=0.3)
    assert dock.theta == pytest.approx(0.3, abs=math.radians(2))


@pytest.mark.parametrize("seed", range(3))
def test_the_object_is_fetched_among_obstacles(standin, seed):
    world = lot(standin, seed)
    robot = located(standin, world)
    c, s = math.cos(0.3), math.sin(0.3)
    world.discs += [standin.Disc(c * x - s * y, s * x + c * y, r) for x, y, r in FIELD]
    nearest = []

    def loaded():
        nearest.append(math.hypot(world.donor.x - world.pose.x, world.donor.y - world.pose.y) - 0.35 - 0.25)
        return world.on_board

    assert run(robot, world, loaded, 400)
    assert 0.2 < min(nearest) <= nearest[-1] <= 0.92
    left = world.stamp + 5
    assert run(robot, world, lambda: world.stamp > left and world.stood > 3, 800)
    assert math.hypot(world.pose.x, world.pose.y) < 1.0
    assert world.touched == 0 and robot.failures == []


def test_it_stays_at_home_with_the_object(standin):
    world = lot(standin)
    robot = located(standin, world)
    world.on_board = True
    assert run(robot, world, lambda: world.stood > 20, 200)
    assert robot.actions[-1][1] == "stop" and math.hypot(world.pose.x, world.pose.y) < 0.5


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_donor_that_moves_a_metre_is_searched_again_within_five_seconds(standin, side):
    world = lot(standin)
    world.ir_period = 1.0
    robot = standin.Fetcher()
    assert run(robot, world, robot.percepts["donor-has-been-located"], 200)
    assert run(robot, world, lambda: math.hypot(world.pose.x, world.pose.y) > 2.5, 300)
    moved = world.stamp
    world.donor.x -= side * math.sin(0.3)
    world.donor.y += side * math.cos(0.3)
    assert run(robot, world, lambda: robot.actions[-1][1] == "start-ir-search", moved + 5)
    assert robot.estimator(DonorMemory).why_forgotten == "the donor has moved"
    assert run(robot, world, lambda: robot.actions[-1][1] == "start-stereo-ranging", moved + 150)
    assert run(robot, world, lambda: world.on_board, moved + 400)


def test_a_donor_that_stays_is_not_doubted_even_in_the_wind(standin):
    world = lot(standin, wind=math.radians(1.0))
    robot = located(standin, world)
    assert run(robot, world, lambda: world.on_board, 300)
    assert robot.estimator(DonorMemory).why_forgotten == ""


def test_who_waits_in_vain_searches_again(standin):
    world = lot(standin)
    robot = located(standin, world, find_and_fetch={"patience": 5.0})
    donor = robot.estimator(DonorMemory)
    donor.front = Pose(1.5, 0.0, 0.0)
    assert run(robot, world, lambda: bool(donor.why_forgotten), 200)
    assert donor.why_forgotten == "the donor does not answer"
    assert robot.actions[-1][1] == "start-ir-search"


def test_with_the_object_on_board_nothing_is_doubted(standin):
    world = lot(standin)
    robot = located(standin, world)
    world.on_board = True
    world.donor.y += 2.0
    assert run(robot, world, lambda: world.stood > 5, 200)
    assert robot.percepts["donor-has-been-located"]()


def test_danger_during_a_search_interrupts_it_and_it_restarts(standin):
    world = lot(standin)
    robot = standin.Fetcher()
    assert run(robot, world, lambda: robot.estimator(IrSearch).progress()["fixation"] > 20, 60)
    world.discs.append(standin.Disc(-0.35 - 0.3 - 0.1, 0.0, 0.3))
    assert run(robot, world, lambda: robot.actions[-1][1] == "start-ir-search", 60)
    assert [name for _, name in robot.actions][-2:] == ["move-away-from-danger", "start-ir-search"]
    robot.tick(world)
    assert robot.estimator(IrSearch).progress()["fixation"] <= 1
    assert world.touched == 0


def test_driven_off_before_the_range_is_known_it_asks_for_the_direction_again(standin):
    world = lot(standin)
    robot = standin.Fetcher()
    assert run(robot, world, lambda: robot.estimator(StereoSearch).is_started(), 60)
    world.pose = standin.Pose(0.4, -0.3, 0.0)
    assert run(robot, world, lambda: robot.actions[-1][1] == "start-ir-search", 60)


def test_a_direction_in_which_nothing_stands_is_given_up_after_two_searches(standin):
    world = lot(standin)
    robot = standin.Fetcher()
    assert run(robot, world, robot.percepts["we-know-the-donor-direction"], 60)
    world.donor.radius = 0.0
    assert run(robot, world, lambda: robot.estimator(DonorMemory).why_forgotten != "", 120)
    assert robot.estimator(DonorMemory).why_forgotten == "nothing stands in that direction"
    assert robot.failures == ["prism", "prism"]


def test_a_goal_is_remembered_through_danger(standin):
    world = lot(standin)
    robot = located(standin, world)
    assert run(robot, world, lambda: math.hypot(world.pose.x, world.pose.y) > 2.0, 200)
    goal, ahead = robot.channels["goal"], world.pose
    spot = 0.35 + 0.3 + 0.12
    world.discs.append(
        standin.Disc(ahead.x + spot * math.cos(ahead.theta), ahead.y + spot * math.sin(ahead.theta), 0.3)
    )
    assert run(robot, world, lambda: robot.actions[-1][1] == "move-away-from-danger", 300)
    assert robot.channels["goal"] == goal
    assert run(robot, world, lambda: robot.actions[-1][1] == "move-according-to-NaT-plan", 300)
    assert robot.channels["goal"] == goal and world.touched == 0
    assert run(robot, world, lambda: world.on_board, 400), "and the way goes round it"


def test_home_is_the_first_pose_in_the_odometry_frame(standin):
    world = lot(standin, pose=Pose(3.0, -2.0, 1.0))
    robot = standin.Fetcher()
    assert robot.values["the-robots-home-position"]({}) is None
    robot.tick(world)
    home = robot.values["the-robots-home-position"]({})
    assert (home.x, home.y) == (0.0, 0.0) and wrap(home.theta) == pytest.approx(0.0)


def test_the_same_run_twice_is_the_same(standin):
    ends = []
    for _ in range(2):
        world = lot(standin, 5)
        robot = located(standin, world)
        run(robot, world, lambda: False, world.stamp + 20)
        ends.append((world.pose, robot.actions))
    assert ends[0] == ends[1]


@pytest.mark.parametrize("bearing", [1.7, -1.7, 3.0])
def test_a_donor_behind_the_robot_is_found_after_turning(standin, bearing):
    world = lot(standin, bearing=bearing, feet=20.0)
    robot = standin.Fetcher()
    assert run(robot, world, robot.percepts["we-know-the-donor-direction"], 300)
    assert wrap(robot.estimator(IrSearch).direction.bearing - bearing) == pytest.approx(0.0, abs=math.radians(2))
    assert robot.failures in (["ir"] * 2, ["ir"] * 4)
    assert math.hypot(world.pose.x, world.pose.y) < 0.01, "it turns on the spot"


def test_a_beacon_that_rocks_too_much_is_looked_for_in_the_same_direction(standin):
    world = lot(standin, bearing=0.0, feet=20.0, wind=math.radians(8.0))
    robot = standin.Fetcher()
    assert run(robot, world, lambda: len(robot.failures) == 3, 300)
    assert robot.estimator(IrSearch).reason == "readings disagree"
    assert world.pose.theta == 0.0


# --- several donors -----------------------------------------------------------------------------------


class Errand:
    """The memory of donors alone: what is found and what is on board is given by the test."""

    def __init__(self, **settings):
        self.ir = IrSearch(IrSettings(roam=True))
        self.stereo = StereoSearch(StereoSettings(), lambda: None)
        goal = NavigationGoal(ArrivalSettings())
        self.donor = DonorMemory(DonorSettings(several=True, **settings), self.ir, self.stereo, goal)
        self.stamp = 0.0

    def find(self, beacon, bearing, ground):
        self.ir.direction = Direction(Pose(0.0, 0.0), bearing, beacon)
        self.stereo.found = Found(Pose(0.0, 0.0), bearing, ground)
        self.tick()

    def tick(self, on_board=False, ir=None):
        self.stamp += 0.1
        odometry = Odometry(Pose(0.0, 0.0), 0.0, 0.0)
        self.donor.update(Reading(self.stamp, 0, odometry, ir=ir, object_on_board=on_board), {}, {})

    def fetch(self):
        self.tick(on_board=True)
        self.tick(on_board=False)


def test_a_donor_that_has_handed_over_everything_is_wanted_no_more():
    errand = Errand(donors=2)
    errand.find("ann", 0.0, 5.0)
    assert errand.donor.is_located() and errand.ir.wants("ann")
    errand.tick(on_board=True)
    assert errand.donor.is_located(), "until the object is off the platform"
    errand.tick(on_board=False)
    assert not errand.donor.is_located() and not errand.ir.knows_direction()
    assert not errand.ir.wants("ann") and errand.ir.wants("bob")


def test_a_donor_is_left_until_all_have_been_served():
    errand = Errand(donors=2)
    for beacon, left in (("ann", True), ("bob", False)):
        errand.find(beacon, 0.3, 4.0)
        errand.fetch()
        assert errand.donor.is_left() == left


def test_a_donor_with_two_objects_is_kept_for_the_second_trip():
    errand = Errand(trips=2)
    errand.find("ann", 0.0, 5.0)
    errand.fetch()
    assert errand.donor.is_located() and errand.donor.is_left()
    errand.fetch()
    assert not errand.donor.is_located() and not errand.donor.is_left()


def test_of_the_donors_that_are_known_the_nearest_comes_next():
    errand = Errand(donors=3)
    errand.find("ann", 0.0, 2.0)
    errand.donor.fronts |= {"bob": Pose(6.0, 0.0), "cid": Pose(0.0, -4.0)}
    errand.fetch()
    assert errand.donor.name == "cid"
    assert errand.donor.docking_pose() is not None


def test_the_beacon_of_another_donor_does_not_say_that_this_one_has_moved():
    errand = Errand(donors=2)
    errand.find("ann", 0.0, 5.0)
    for _ in range(5):
        errand.tick(ir=IrReading(errand.stamp, True, 0.0, True, 0.4, 5.0, "bob"))
    assert errand.donor.is_located()
    for _ in range(5):
        errand.tick(ir=IrReading(errand.stamp, True, 0.0, True, 0.4, 5.0, "ann"))
    assert errand.donor.why_forgotten == "the donor has moved"


def test_who_waits_at_home_in_vain_looks_for_it_about():
    home = Home(patience=20.0)
    places, pose = [], Pose(0.0, 0.0)
    for second in range(65):
        home.update(Reading(float(second), 0, Odometry(pose, 0.0, 0.0), object_on_board=second > 0), {}, {})
        pose = home.place
        places.append((round(pose.x, 2), round(pose.y, 2)))
    assert len(dict.fromkeys(places)) == 4 and places[0] == (0.0, 0.0)
    assert all(math.hypot(*place) == pytest.approx(0.8, abs=0.01) for place in places[30:])
    home.update(Reading(99.0, 0, Odometry(pose, 0.0, 0.0)), {}, {})
    assert home.place == Pose(0.0, 0.0), "once the object is off"


def test_without_several_home_stays_where_it_is():
    home = Home()
    for second in range(200):
        home.update(Reading(float(second), 0, Odometry(Pose(0.0, 0.0), 0.0, 0.0), object_on_board=True), {}, {})
    assert home.place == Pose(0.0, 0.0)
