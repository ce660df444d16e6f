"""Documents as readable YAML.

Takes: a document, and remarks for its head. Gives: the text; read back it is the same document.
Leaves alone: whether the document is a sound scenario (`sim.scenarios.format`).
"""

from __future__ import annotations

from typing import Any

import yaml

from sim.scenarios.importers.imported import Document

WIDTH = 120
SHORT = 100


class _Writer(yaml.SafeDumper):
    """Short mappings, and lists of numbers, stand on one line."""

    def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002
        return True


def _is_flat(value: Any) -> bool:
    """Whether the value is plain, or a list of numbers, however deep."""
    if isinstance(value, list):
        return all(isinstance(part, int | float) or (isinstance(part, list) and _is_flat(part)) for part in value)
    return not isinstance(value, dict)


def _mapping(writer: yaml.SafeDumper, value: dict[str, Any]) -> yaml.MappingNode:
    short = all(map(_is_flat, value.values())) and len(str(value)) <= SHORT and "name" not in value
    return writer.represent_mapping("tag:yaml.org,2002:map", value.items(), flow_style=short)


def _list(writer: yaml.SafeDumper, value: list[Any]) -> yaml.SequenceNode:
    return writer.represent_sequence("tag:yaml.org,2002:seq", value, flow_style=_is_flat(value))


_Writer.add_representer(dict, _mapping)
_Writer.add_representer(list, _list)


def yaml_text(document: Document, remarks: tuple[str, ...] = ()) -> str:
    """The document as YAML, after the remarks as comments."""
    head = "".join(f"# {' '.join(remark.split())}\n" for remark in remarks)
    return head + str(yaml.dump(document, Dumper=_Writer, sort_keys=False, allow_unicode=True, width=WIDTH))
