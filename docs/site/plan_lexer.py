"""Colours for the plan language on pages: a lexer for Pygments.

Takes: the text of a plan, or a part of one. Gives: tokens. Leaves alone: whether it is right; the
language page says that.
"""

from __future__ import annotations

from typing import ClassVar

from pygments.lexer import RegexLexer, bygroups, words
from pygments.lexers import LEXERS
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Whitespace

__all__ = ["PlanLexer"]

FORMS = [
    "plan",
    "include",
    "use",
    "declare",
    "defoutput",
    "defcond",
    "defgoalr",
    "defop",
    "defproperty",
    "assume",
    "deftest",
    "goalem",
    "goallem",
    "tick",
]
GOALS = ["do", "if", "when", "cond", "else", "and", "or", "prio-and", "ach", "maint", "anything", "not"]
PAST = ["delay", "once", "historically", "since", "latch", "rose", "fell", "held-for", "within", "at-least"]
END = r"(?=[\s()\";]|$)"


class PlanLexer(RegexLexer):
    """The text of plans."""

    name = "rplan"
    aliases: ClassVar[list[str]] = ["rplan"]
    filenames: ClassVar[list[str]] = ["*.rplan"]
    tokens: ClassVar[dict[str, list[object]]] = {
        "root": [
            (r"\s+", Whitespace),
            (r";.*?$", Comment.Single),
            (r"#\|", Comment.Multiline, "remark"),
            (r'"[^"]*"', String),
            (r"(\()(ach|maint)(\s+)([^\s()\";]+)", bygroups(Punctuation, Keyword, Whitespace, Name.Function)),
            (words(FORMS, prefix=r"(?<=\()", suffix=END), Keyword.Declaration),
            (words(GOALS, prefix=r"(?<=\()", suffix=END), Keyword),
            (words(PAST, prefix=r"(?<=\()", suffix=END), Name.Builtin),
            (r"[+-]?\d[^\s()\";]*", Number),
            (r":[^\s()\";]+", Name.Attribute),
            (r"\?[^\s()\";]+", Name.Variable),
            (words(["true", "false", "open"], suffix=END), Keyword.Constant),
            (r"(?<=\()[-+*/<>=]+" + END, Operator),
            (r"[()]", Punctuation),
            (r"[^\s()\";]+", Name),
        ],
        "remark": [
            (r"#\|", Comment.Multiline, "#push"),
            (r"\|#", Comment.Multiline, "#pop"),
            (r"[^#|]+|[#|]", Comment.Multiline),
        ],
    }


def register() -> None:
    """Make it known to Pygments by its name."""
    LEXERS["PlanLexer"] = (__name__, PlanLexer.name, tuple(PlanLexer.aliases), tuple(PlanLexer.filenames), ())
