"""How the rows of stasis and of the curb are judged."""

from __future__ import annotations

from rplan.apps.reproduce.rows import w4, w5


def verdicts(findings):
    return [finding.judgement for finding in findings]


def out(*took):
    return [{"case": "x", "seed": k, "held": True, "took": t, "in_time": t is not None} for k, t in enumerate(took)]


def test_stasis_is_met_where_all_get_out_soon():
    assert verdicts(w4.judge("paper", out(*[5.0] * 18, 16.0, 16.0))) == ["met"] * 3


def test_stasis_is_missed_where_one_does_not_get_out_and_the_rest_late():
    assert verdicts(w4.judge("modern", out(None, 30.0, 30.0, 30.0))) == ["met", "missed", "missed"]
    assert verdicts(w4.judge("paper", out(None))) == ["met", "missed", "missed"]
    assert verdicts(w4.judge("paper", out(3.0))) == ["met", "met", "met"]


def test_each_position_has_escapes_of_its_own():
    cases = w4.cases(3)
    assert len({case.changes for case in cases}) == len(cases) == 12


def crossing(case, crossed, deployed=1, home=True):
    one = {"case": case, "seed": 0, "crossed": crossed, "after": 8.0 if crossed else None, "deployed": deployed}
    return one | {"once": deployed == 1, "home": 9.0, "home_in_time": home, "stuck": not crossed}


def test_a_curb_is_met_where_it_is_crossed_with_flippers_alone():
    some = [crossing(w5.WITH, True), crossing(w5.WITHOUT, False, 0)]
    assert verdicts(w5.judge("paper", some)) == ["met"] * 3


def test_a_curb_is_missed_the_other_way_round():
    some = [crossing(w5.WITH, False, 2, False), crossing(w5.WITHOUT, True, 0)]
    assert verdicts(w5.judge("paper", some)) == ["missed"] * 3
    assert w5.judge("paper", some[:1]) == ()


def test_both_rows_drive_what_comes_with_the_plans():
    assert [case.changes for case in w5.cases(2)] == [(), w5.OFF]
    assert {case.scenario for case in w4.cases(1)} == {w4.WORLD}
