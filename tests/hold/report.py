"""What a scenario has found: figures, and requirements that hold or do not."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any


@dataclasses.dataclass
class Requirement:
    name: str
    value: float
    limit: str  # in words
    holds: bool
    judged: bool  # else it is told, and does not count
    why_not: str = ""  # it is not judged


@dataclasses.dataclass
class Report:
    """`timed`: a requirement on the machine's speed, not judged in a quick run, which is for machines that others use as well."""

    is_quick: bool
    figures: dict[str, Any] = dataclasses.field(default_factory=dict)
    requirements: list[Requirement] = dataclasses.field(default_factory=list)
    notes: list[str] = dataclasses.field(default_factory=list)
    skipped: str = ""  # why nothing was tried

    def figure(self, name: str, value: Any) -> None:
        self.figures[name] = round(value, 4) if isinstance(value, float) else value

    def require(
        self, name: str, value: float, *, at_most: float | None = None, at_least: float | None = None, timed: bool = False
    ) -> None:
        limits = [(at_most, "at most", value <= (at_most or 0)), (at_least, "at least", value >= (at_least or 0))]
        given = [(limit, words, holds) for limit, words, holds in limits if limit is not None]
        text = ", ".join(f"{words} {told(limit)}" for limit, words, _ in given)
        why_not = "speed is not judged in a quick run" if timed and self.is_quick else ""
        holds = all(holds for _, _, holds in given)
        self.requirements.append(Requirement(name, round(value, 4), text, holds, not why_not, why_not))

    @property
    def passed(self) -> bool:
        return all(requirement.holds or not requirement.judged for requirement in self.requirements)

    def line(self) -> str:
        """All figures, and what does not hold."""
        if self.skipped:
            return f"skipped: {self.skipped}"
        words = [f"{told(r.value)} {r.name}" for r in self.requirements if r.holds]
        words += [f"{told(value)} {name}" for name, value in self.figures.items() if not isinstance(value, (dict, list))]
        return ", ".join(words)

    def faults(self) -> list[str]:
        """A line for each requirement that does not hold."""
        return [
            f"{told(r.value)} {r.name}, {r.limit} allowed" + ("" if r.judged else f" (not judged: {r.why_not})")
            for r in self.requirements
            if not r.holds
        ]

    def to_json(self) -> dict[str, Any]:
        return {
            "result": "skipped" if self.skipped else "passed" if self.passed else "failed",
            "skipped": self.skipped,
            "figures": self.figures,
            "requirements": [dataclasses.asdict(requirement) for requirement in self.requirements],
            "notes": self.notes,
        }


def told(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:,.0f}" if value == int(value) else f"{value:,.3g}" if abs(value) < 1000 else f"{value:,.0f}"
    return f"{value:,}" if isinstance(value, int) else str(value)


def quantile(values: Iterable[float], part: float) -> float:
    """The least value that `part` of them do not exceed; 0 of none."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(part * len(ordered)))] if ordered else 0.0
