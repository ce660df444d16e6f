"""Which name means what: look-up, slips, types, units, settings of libraries (L3-L7)."""

from __future__ import annotations

import pytest
from properties.texts import compiled, findings, said

from rplan.goals.goal import print_goal
from rplan.goals.signature import COMMAND, SYMBOL, FunctionSignature, LibrarySignature, ParameterSignature
from rplan.lang.diagnostic import Diagnostic
from rplan.lang.plan import Type

METRES = Type("number", "m")
DRIVING = LibrarySignature(
    "driving",
    (
        FunctionSignature("bumped", (), Type("bool"), origin="driving"),
        FunctionSignature("distance", (), METRES, origin="driving"),
        FunctionSignature("cruise", (), COMMAND, actuators=("drive",), reads=("goal",), origin="driving"),
        FunctionSignature("halt", (), COMMAND, actuators=("drive",), origin="driving"),
        FunctionSignature("gaze", (), COMMAND, actuators=("head",), origin="driving"),
        FunctionSignature("depot", (), Type("pose"), origin="driving"),
    ),
    (
        ParameterSignature("reach", METRES, 0.5),
        ParameterSignature("gain", Type("number"), 1.0),
        ParameterSignature("careful", Type("bool"), False),
        ParameterSignature("preset", SYMBOL, "modern"),
    ),
)
OTHER = LibrarySignature("other", (FunctionSignature("bumped", (), Type("bool"), origin="other"),), ())
LIBRARIES = {"driving": DRIVING, "other": OTHER}


def wrong(text: str, **options: bool) -> list[Diagnostic]:
    return [d for d in findings(text, LIBRARIES, **options) if d.severity != "note"]


def only(text: str) -> Diagnostic:
    (found,) = wrong(text)
    return found


USE = "(use driving) (defoutput goal pose) (defoutput action command) "


@pytest.mark.rule("L6")
def test_a_plan_whose_names_are_all_known_has_nothing_said_of_it() -> None:
    text = USE + "(goalem (if (bumped) (do action (halt)) (and (do goal depot) (do action cruise))))"
    assert compiled(text, LIBRARIES, strict=True).diagnostics == ()


@pytest.mark.rule("L6")
def test_an_unknown_name_is_noted_once_and_is_an_error_if_one_is_strict() -> None:
    text = "(goalem (if (or (lost) (lost)) (do lamp on) (do lamp (on))))"
    noted = [d.message for d in findings(text) if d.code == "undeclared"]
    assert [message.split("`")[1] for message in noted] == ["lost", "lamp", "on"]
    assert said(findings(text)) == []
    assert said(findings(text, strict=True)) == ["undeclared"] * 3


@pytest.mark.rule("L6")
@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("(if (bumpde) (do action halt) (do anything))", "bumped"),
        ("(if (bumpd) (do action halt) (do anything))", "bumped"),
        ("(if (bumpped) (do action halt) (do anything))", "bumped"),
        ("(if (vumped) (do action halt) (do anything))", "bumped"),
        ("(if (< (distence) 3m) (do action halt) (do anything))", "distance"),
        ("(do action (cruize))", "cruise"),
        ("(do actoin (cruise))", "action"),
        ("(if (competence-faild cruise) (do action halt) (do anything))", "competence-failed"),
        ("(if (competence-failed cruse) (do action halt) (do anything))", "cruise"),
    ],
)
def test_a_name_that_is_one_slip_away_from_a_known_one_is_an_error_that_names_it(written: str, meant: str) -> None:
    errors = [d for d in wrong(USE + f"(goalem (and (do goal depot) {written}))") if d.severity == "error"]
    assert [(d.code, d.hint) for d in errors] == [("misspelt", f"did you mean `{meant}`?")]


@pytest.mark.rule("L6")
@pytest.mark.parametrize("name", ["bump", "distances-2", "distance2", "dispense"])
def test_a_name_that_is_farther_away_or_differs_by_a_digit_is_only_unknown(name: str) -> None:
    assert said(findings(USE + f"(goalem (and (do action halt) (when ({name}) (do goal depot))))", LIBRARIES)) == []


@pytest.mark.rule("L6")
def test_a_slip_of_a_named_condition_is_found_among_conditions_only() -> None:
    text = "(defcond (in-danger) (bumped)) (goalem (when (and (in-danger) {}) (do lamp (in-dangre))))"
    assert said(findings(text.format("true"))) == []
    assert said(findings(text.format("(in-dangre)"))) == ["misspelt"]


@pytest.mark.rule("L6")
def test_goals_outputs_and_functions_may_share_a_name() -> None:
    text = """(defoutput cruise command) (use driving) (defgoalr (ach cruise) (do cruise (cruise)))
              (defgoalr (maint cruise) (do anything)) (goalem (and (ach cruise) (maint cruise)))"""
    assert [found.code for found in wrong(text)] == ["reads-unset-channel"]


def test_a_named_condition_may_not_have_the_name_of_a_function_since_both_stand_in_conditions() -> None:
    found = wrong("(use driving) (defcond (bumped) true) (goalem (when (bumped) (do anything)))")
    assert [d.code for d in found if d.severity == "error"] == ["duplicate"]


def test_two_libraries_that_offer_one_name_are_refused() -> None:
    found = wrong("(use driving) (use other) (goalem (when (bumped) (do lamp on)))")
    assert [d.code for d in found] == ["duplicate"]
    assert "other" in found[0].message
    assert "driving" in found[0].message


@pytest.mark.rule("L6")
def test_a_declaration_may_not_repeat_what_a_library_offers() -> None:
    assert only('(use driving) (declare (bumped) bool "") (goalem (when (bumped) (do lamp on)))').code == "duplicate"


@pytest.mark.rule("L6")
def test_what_is_declared_and_not_used_is_a_warning() -> None:
    found = wrong("""(use driving) (declare (far) bool "") (defoutput lamp symbol) (defcond (near) (not (far-off)))
                     (defgoalr (ach rest) (do horn soft)) (goalem (do anything))""")
    assert [(d.code, d.severity) for d in found] == [("unused", "warning")] * 5
    assert [d.message.split("`")[1] for d in found] == ["far", "lamp", "near", "(ach rest)", "driving"]


@pytest.mark.rule("L6")
def test_what_only_an_idle_value_or_a_condition_in_use_needs_is_used() -> None:
    text = """(use driving) (defoutput action command :idle (halt)) (defcond (near) (< (distance) 2m))
              (defcond (free) (not (near))) (goalem (when (free) (do action (gaze))))"""
    assert wrong(text) == []


@pytest.mark.rule("L7")
def test_a_bare_symbol_is_a_call_except_where_an_argument_is_declared_a_symbol() -> None:
    text = """(declare (sees (what symbol)) bool "") (declare (near (whom pose)) bool "") (declare (home) pose "")
              (goalem (when (and lost (sees home) (near home)) (do goal home)))"""
    assert print_goal(compiled(text).goals.top) == (
        "(if (and (lost) (sees home) (near (home))) (do goal (home)) (do anything))"
    )


@pytest.mark.rule("L5")
@pytest.mark.parametrize(
    ("goal", "code"),
    [
        ("(do action depot)", "type-mismatch"),
        ("(do goal 3m)", "type-mismatch"),
        ("(do goal true)", "type-mismatch"),
        ("(do goal (gaze))", "type-mismatch"),
        ("(when (cruise) (do goal depot))", "type-mismatch"),
        ("(when (distance) (do goal depot))", "type-mismatch"),
        ("(when (< (bumped) 3) (do goal depot))", "type-mismatch"),
        ("(when (bumped 3) (do goal depot))", "wrong-arity"),
        ("(when (competence-failed) (do goal depot))", "wrong-arity"),
        ("(do goal (depot 3m))", "wrong-arity"),
    ],
)
def test_a_value_of_the_wrong_type_or_arity_is_an_error(goal: str, code: str) -> None:
    errors = [d.code for d in wrong(USE + f"(goalem (and (do action halt) {goal}))") if d.severity == "error"]
    assert errors == [code]


@pytest.mark.rule("L5")
@pytest.mark.parametrize("idle", ["3m", "(depot)", "true"])
def test_idle_and_first_values_have_the_type_of_their_output(idle: str) -> None:
    rest = "(use driving) (goalem (do action halt))"
    for option in (f":idle {idle}", f":hold :initial {idle}"):
        assert only(f"(defoutput action command {option}) {rest}").code == "type-mismatch"


@pytest.mark.rule("L3")
@pytest.mark.parametrize(
    ("condition", "codes"),
    [
        ("(< (distance) 2m)", []),
        ("(< (distance) 30ft)", []),
        ("(< 200cm (distance))", []),
        ("(< (distance) 2s)", ["unit-mismatch"]),
        ("(< 2s 3m)", ["unit-mismatch"]),
        ("(< (distance) 2)", ["bare-number"]),
        ("(> 2 (distance))", ["bare-number"]),
        ("(< (warmth) 2)", []),
    ],
)
def test_numbers_are_compared_with_numbers_of_their_dimension(condition: str, codes: list[str]) -> None:
    text = USE + f"(goalem (and (do goal depot) (when {condition} (do action halt))))"
    assert [d.code for d in wrong(text) if d.code != "dead"] == codes


@pytest.mark.rule("L3")
def test_a_bare_number_is_read_in_the_unit_of_the_other_side() -> None:
    text = USE + "(goalem (and (do goal depot) (when (and (< (distance) 2) (< 1 (distance))) (do action halt))))"
    assert [atom.text for atom in compiled(text, LIBRARIES).ways.atoms] == ["(< (distance) 2m)", "(< 1m (distance))"]


@pytest.mark.rule("L3")
def test_a_bare_percept_and_a_number_with_a_unit_are_compared_with_a_warning() -> None:
    found = wrong('(declare (count) number "") (goalem (when (< (count) 2m) (do lamp on)))')
    assert [d.code for d in found] == ["bare-number"]


@pytest.mark.rule("L5")
@pytest.mark.parametrize(
    "condition",
    ["(and (near) (< (near) 2m))", "(and (< (near) 2m) (near))", "(and (< (near) 2m) (> 3s (near)))"],
)
def test_an_undeclared_name_has_one_type_in_all_its_places(condition: str) -> None:
    assert said(findings(f"(goalem (when {condition} (do lamp on)))")) == ["type-mismatch"]


@pytest.mark.rule("L3")
def test_an_undeclared_number_goes_with_bare_numbers_and_with_one_dimension() -> None:
    text = "(goalem (when (and (< (near) 2m) (< (near) 3) (< 1cm (near)) (< (near) (far)) (< (far) 9)) (do lamp on)))"
    assert said(findings(text)) == []


@pytest.mark.rule("L21")
def test_equal_lengths_in_different_units_are_one_value() -> None:
    plan = compiled("(defoutput gap (number m)) (goalem (and (do gap 25ft) (do gap 7.62m) (do gap 762cm)))")
    assert [*plan.ways.sets["gap"]] == ["7.62m"]


@pytest.mark.rule("L3")
def test_a_bare_number_takes_the_unit_of_its_output_with_a_warning() -> None:
    plan = compiled("(defoutput gap (number m)) (goalem (and (do gap 2) (do gap 2m)))")
    assert said(plan.diagnostics) == ["bare-number"]
    assert [*plan.ways.sets["gap"]] == ["2m"]


# --- libraries --------------------------------------------------------------------------------------


def settings(text: str) -> dict[str, float | bool | str]:
    (bound,) = compiled(f"{text} (goalem (when (bumped) (do lamp on)))", LIBRARIES).goals.libraries
    return dict(bound.settings)


def test_a_library_has_its_defaults_where_the_plan_is_silent() -> None:
    assert settings("(use driving)") == {"reach": 0.5, "gain": 1.0, "careful": False, "preset": "modern"}


def test_a_plan_sets_parameters_in_si() -> None:
    assert settings("(use driving :reach 2ft :gain 3 :careful true :preset paper)") == {
        "reach": 0.6096, "gain": 3.0, "careful": True, "preset": "paper",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("setting", "code", "hint"),
    [
        (":reech 2m", "unknown-parameter", "did you mean `:reach`?"),
        (":colour red", "unknown-parameter", "it has: reach, gain, careful, preset"),
        (":reach 2s", "unit-mismatch", ""),
        (":reach true", "type-mismatch", ""),
        (":reach near", "type-mismatch", ""),
        (":careful 2", "type-mismatch", ""),
        (":gain (bumped)", "type-mismatch", ""),
    ],
)
def test_a_setting_that_does_not_fit_is_an_error(setting: str, code: str, hint: str) -> None:
    found = only(f"(use driving {setting}) (goalem (when (bumped) (do lamp on)))")
    assert (found.code, found.hint) == (code, hint)


def test_an_unknown_library_is_an_error_that_says_which_there_are() -> None:
    slip, other = wrong("(use drivign) (use flying) (goalem (do lamp on))")
    assert (slip.code, slip.hint) == ("unknown-library", "did you mean `driving`?")
    assert (other.code, other.hint) == ("unknown-library", "there are: driving, other")


def test_a_competence_that_is_watched_for_failure_must_be_known_where_any_is() -> None:
    text = "(goalem (if (competence-failed flying) (do lamp on) (do anything)))"
    assert [d.code for d in findings(USE + text, LIBRARIES) if "flying" in d.message] == ["undeclared"]
    assert [d.code for d in findings(text, LIBRARIES) if "flying" in d.message] == []


# --- channels ---------------------------------------------------------------------------------------


@pytest.mark.rule("L25")
def test_two_channels_for_one_actuator_are_an_error() -> None:
    text = """(use driving) (defoutput a command) (defoutput b command)
              (goalem (if (bumped) (do a (halt)) (do b {})))"""
    assert said(findings(text.format("(cruise)"), LIBRARIES), "error") == ["two-channels"]
    assert said(findings(text.format("(gaze)"), LIBRARIES)) == []


@pytest.mark.rule("L25")
def test_an_idle_value_counts_as_driving_its_actuator() -> None:
    text = """(use driving) (defoutput a command :idle (halt)) (defoutput b command)
              (goalem (if (bumped) (do a (gaze)) (do b (cruise))))"""
    assert "two-channels" in said(findings(text, LIBRARIES))


@pytest.mark.rule("L25")
def test_a_competence_that_reads_a_channel_filled_after_it_is_warned_of() -> None:
    goal = "(goalem (and (do action cruise) (do goal depot)))"
    assert wrong("(use driving) (defoutput goal pose) (defoutput action command)" + goal) == []
    found = only("(use driving) (defoutput action command) (defoutput goal pose)" + goal)
    assert (found.code, found.hint) == ("reads-later-channel", "declare `goal` before `action`")


@pytest.mark.rule("L25")
def test_declared_outputs_come_first_and_others_as_they_appear() -> None:
    plan = compiled("(defoutput last bool) (goalem (and (do b true) (do a true) (do last true)))")
    assert [output.name for output in plan.goals.outputs] == ["last", "b", "a"]


@pytest.mark.rule("L6")
def test_a_library_that_works_unasked_may_be_used_for_what_it_does_of_itself() -> None:
    text = "(use other) (goalem (do lamp on))"
    assert "unused" in [d.code for d in wrong(text)]
    mapper = LibrarySignature("other", OTHER.functions, (), works_unasked=True)
    assert "unused" not in [d.code for d in findings(text, {"other": mapper})]
