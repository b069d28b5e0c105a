"""What an expression of Prometheus' language reads: enough of a parser for rules and dashboards that promtool has checked."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator

_WORDS = {"and", "or", "unless", "bool", "offset", "by", "without", "on", "ignoring", "group_left", "group_right"}
_STRING = r'"(?:\\.|[^"\\])*"'
_MATCHER = re.compile(rf"(\w+)\s*(=~|!~|!=|=)\s*({_STRING})")
_GROUPING = re.compile(r"\b(?:by|without|on|ignoring|group_left|group_right)\s*\(([^)]*)\)")
# A number, and a duration, may end in letters.
_SELECTOR = re.compile(rf"(?<![\w:.])([a-zA-Z_:][\w:]*)(?:\s*(\{{(?:[^\"}}]|{_STRING})*\}}))?(?!\s*\(|[\w:])")


@dataclasses.dataclass(frozen=True)
class Matcher:
    label: str
    operator: str
    value: str


@dataclasses.dataclass(frozen=True)
class Selector:
    metric: str
    matchers: tuple[Matcher, ...]


def selectors(expression: str) -> Iterator[Selector]:
    """Every metric that it reads, with what it asks of its labels."""
    for match in _SELECTOR.finditer(_GROUPING.sub(" ", re.sub(r"\[[^\]]*\]", " ", expression))):
        if match[1] not in _WORDS:
            yield Selector(match[1], tuple(Matcher(m[1], m[2], m[3][1:-1]) for m in _MATCHER.finditer(match[2] or "")))


def grouped_labels(expression: str) -> set[str]:
    """The labels by which it groups or joins."""
    return {label for group in _GROUPING.finditer(expression) for label in re.findall(r"\w+", group[1])}
