"""Library `flippers`: out while the tracks labour.

Takes: the parameters of a plan. Gives: percepts and competences. Leaves alone: the drive.
"""

from __future__ import annotations

from behaviours.competences.flippers import SetFlippers
from behaviours.cores.flippers import LabourSettings
from behaviours.declaring import boolean, command, parameters, settings_of
from behaviours.estimators.flippers import FlipperWatch
from behaviours.interface import Library, Offer, Values, Workshop

_LABOUR = parameters(
    LabourSettings(),
    ("deploy_above", "A", "Flippers are wanted out where either motor draws more (printed in the paper)."),
    ("retract_below", "A", "They are wanted home where both motors draw less (printed in the paper)."),
    ("least", "s", "They stay out for so long after the motors laboured last (printed in the paper)."),
    ("smoothing", "s", "Time constant of the low-pass that keeps inrush out (chosen here)."),
)


def _build(values: Values, workshop: Workshop) -> Offer:
    settings = settings_of(LabourSettings(), _LABOUR, values)
    watch = workshop.share(FlipperWatch, lambda: FlipperWatch(settings))
    return Offer(
        percepts={"the-tracks-labour": lambda: watch.labour.out, "the-flippers-are-out": lambda: watch.are_out},
        competences={"deploy-flippers": SetFlippers(True), "retract-flippers": SetFlippers(False)},
    )


LIBRARY = Library(
    "flippers",
    "Flippers by the currents of the drive motors, after Yamauchi 2005.",
    (
        boolean("the-tracks-labour", "A motor draws too much, or did so lately: the flippers are wanted out."),
        boolean("the-flippers-are-out", "They bear on the ground."),
        command("deploy-flippers", "Out, forward and down.", "flippers"),
        command("retract-flippers", "Home.", "flippers"),
    ),
    _LABOUR,
    _build,
)
