"""What a command's --help says, taken apart."""

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

_WRAPPED = " " * 30  # how CLI11 begins what belongs to the names above


# What may follow a name: the kind of its value, the range, the default, and what it goes with.
_KIND = re.compile(
    r"(?P<value>[A-Za-z][\w|/-]*)?(?::[A-Z]+)?(?: in)?(?: ?\[(?P<range>[^]]*)\])?(?:=(?P<default>\S+))?"
    r"(?P<more>(?: \.\.\.| REQUIRED)*)(?: ?Needs: (?P<needs>[^:]*?))?(?: ?Excludes: (?P<excludes>[^:]*))?"
)


@dataclass
class Entry:
    """An option, a positional or a subcommand."""

    names: list[str]
    value: str  # what stands for it; empty: it takes none
    text: str

    def flags(self) -> list[str]:
        return [name for name in self.names if name.startswith("-")]


def _entry(names: str, text: str) -> Entry:
    name, _, kind = names.partition(" ")
    match = _KIND.fullmatch(kind)
    if match is None:
        raise ValueError(f"--help says of {name} what cannot be read: {kind}")
    notes = [text]
    numbers = re.fullmatch(r"(\S+) - (\S+)", match["range"] or "")
    if numbers:
        notes.append(f"From {numbers[1]} to {numbers[2]}.")
    if match["default"]:
        notes.append(f"Default: {match['default']}.")
    if match["needs"]:
        notes.append(f"Only with {', '.join(match['needs'].split())}.")
    if match["excludes"]:
        notes.append(f"Not with {', '.join(match['excludes'].split())}.")
    if len(notes) > 1 and text and text[-1] not in ".:":
        notes[0] = text + "."
    value = (match["value"] or "") + (" ..." if "..." in match["more"] else "")
    return Entry(name.split(","), value, " ".join(note for note in notes if note))


@dataclass
class Help:
    description: list[str] = field(default_factory=list)  # paragraphs
    usage: str = ""
    groups: dict[str, list[Entry]] = field(default_factory=dict)
    examples: list[str] = field(default_factory=list)
    footer: list[str] = field(default_factory=list)

    def flags(self) -> list[str]:
        """All of them, in order."""
        return [flag for entries in self.groups.values() for entry in entries for flag in entry.flags()]


def parse(text: str) -> Help:
    """Takes the text apart. ValueError where it is not what CLI11 writes."""
    about, found, rest = text.partition("Usage: ")
    if not found:
        raise ValueError("--help has no line of usage")
    usage, _, rest = rest.partition("\n")
    help_ = Help(description=[part.strip() for part in about.split("\n\n") if part.strip()], usage=usage.strip())
    group: list[tuple[str, str]] | None = None  # names, text
    groups: dict[str, list[tuple[str, str]]] = {}
    in_examples = False
    lines = rest.splitlines()
    for line, next_line in zip(lines, [*lines[1:], ""], strict=True):
        heading = re.fullmatch(r"(\w+):", line)
        if heading:
            in_examples = heading[1] == "Examples"
            group = None if in_examples else groups.setdefault(heading[1], [])
        elif in_examples and line.startswith("  "):
            help_.examples.append(line.strip())
        elif group and line.startswith(_WRAPPED):
            names, text = group[-1]
            group[-1] = (names, f"{text} {line.strip()}".strip())
        elif group is not None and line.startswith("  "):
            group.append(_split(line[2:], next_line.startswith(_WRAPPED)))
        elif line.strip():
            in_examples, group = False, None
            help_.footer.append(line.strip())
    help_.groups = {title: [_entry(*pair) for pair in pairs] for title, pairs in groups.items()}
    return help_


def _split(line: str, has_more: bool) -> tuple[str, str]:
    # Texts begin in column 30, after a blank. Options with longer names have theirs in the next line, nobody else goes on there.
    column = len(_WRAPPED) - 2
    is_long = line.startswith("-") and has_more
    if not is_long and len(line) > column and line[column - 1] == " ":
        return line[:column].strip(), line[column:].strip()
    return line.strip(), ""


def read(command: Path, arguments: list[str]) -> Help | None:
    """None where there is no help, as of a subcommand whose program is missing."""
    result = subprocess.run([command, *arguments, "--help"], capture_output=True, text=True, check=False)
    return parse(result.stdout) if result.returncode == 0 else None


def subcommands(command: Path) -> tuple[Help, dict[str, Help]]:
    """The command's own help, and that of its subcommands that can be run."""
    top = read(command, [])
    if top is None:
        raise ValueError(f"{command} has no --help")
    names = [entry.names[0] for entry in top.groups.get("Subcommands", [])]
    helps = {name: read(command, [name]) for name in names}
    return top, {name: help_ for name, help_ in helps.items() if help_ is not None}
