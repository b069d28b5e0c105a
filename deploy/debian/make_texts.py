#!/usr/bin/env python3
"""Writes the man pages, the completion and the changelog of the package, made of what the command and CHANGELOG.md say."""

import argparse
import gzip
import re
import textwrap
import time
from email.utils import formatdate
from pathlib import Path

from help import Entry, Help, subcommands

_ESCAPES = {"\\": "\\e", "-": "\\-", "'": "\\(aq", "`": "\\(ga", "^": "\\(ha", "~": "\\(ti", '"': "\\(dq"}
_FILES = [
    Entry(["/etc/curvecast/curvecast.conf"], "", "Settings of the server that systemd starts as curvecast.service."),
    Entry(["/etc/default/curvecast"], "", "Variables of that server's environment, if it is there."),
    Entry(["/var/lib/curvecast/cache"], "", "Meshes and sessions of that server."),
    Entry(["~/.cache/curvecast"], "", "What commands have prepared, for later ones."),
    Entry(["/usr/include/curvecast/v1"], "", "The API, for programs in any language with gRPC."),
]


def _roff(text: str) -> str:
    """Escaped; no line of it is a request."""
    text = "".join(_ESCAPES.get(character, character) for character in text)
    return "\\&" + text if text.startswith(".") else text


def _entries(entries: list[Entry], title: str = "") -> list[str]:
    lines = [f'.SS "{_roff(title)}"'] if title else []
    for entry in entries:
        names = ", ".join(f"\\fB{_roff(name)}\\fR" for name in entry.names)
        lines += [".TP", f"{names} \\fI{_roff(entry.value)}\\fR" if entry.value else names, _roff(entry.text) or "\\&"]
    return lines


def _paragraphs(texts: list[str]) -> list[str]:
    lines = [line for text in texts for line in (".PP", *(_roff(part.strip()) for part in text.splitlines()))]
    return lines[1:]


def _summary(description: str) -> str:
    """The first sentence, or as much of it as stands for itself."""
    sentence = re.split(r"[.:;](?:\s|$)| \(", description, maxsplit=1)[0].strip()
    head, found, _ = sentence.partition(", and ")
    return head if found and "," not in head else sentence  # else it is the end of a list


def _references(names: list[str]) -> list[str]:
    return [", ".join(f"\\fB{_roff(name)}\\fR(1)" for name in names)]


def _page(name: str, summary: str, sections: dict[str, list[str]], version: str, date: str) -> str:
    lines = [f'.TH {_roff(name.upper())} 1 "{date}" "Curvecast {version}" "Curvecast"']
    lines += [".ad l", ".SH NAME", f"{_roff(name)} \\- {_roff(summary)}"]
    for title, content in sections.items():
        if content:
            lines += [f'.SH "{title}"', *content]
    return "\n".join(lines) + "\n"


def _command_page(name: str, help_: Help, version: str, date: str) -> str:
    groups = dict(help_.groups)
    arguments = _entries(groups.pop("Positionals", []))
    options = _entries(groups.pop("Options", []))
    for title, entries in groups.items():
        options += _entries(entries, title)
    statuses = [line.removeprefix("Exit status: ") for line in help_.footer if line.startswith("Exit status: ")]
    usage = help_.usage.removeprefix(f"curvecast {name}")
    sections = {
        "SYNOPSIS": [f"\\fBcurvecast {_roff(name)}\\fR{_roff(usage)}"],
        "DESCRIPTION": _paragraphs(help_.description),
        "ARGUMENTS": arguments,
        "OPTIONS": options,
        "EXAMPLES": [".nf", *(_roff(line) for line in help_.examples), ".fi"] if help_.examples else [],
        "EXIT STATUS": [_roff(line) for line in statuses],
        "SEE ALSO": _references(["curvecast"]),
    }
    return _page(f"curvecast-{name}", _summary(help_.description[0]), sections, version, date)


def _main_page(top: Help, helps: dict[str, Help], version: str, date: str) -> str:
    commands = [Entry([name], "", _summary(help_.description[0]) + ".") for name, help_ in helps.items()]
    token = Entry(["CURVECAST_TOKEN"], "", "What servers know this client by, where there is no --token-file.")
    sections = {
        "SYNOPSIS": [f"\\fBcurvecast\\fR {_roff('COMMAND [OPTIONS]')}"],
        "DESCRIPTION": _paragraphs(top.description),
        "COMMANDS": _entries(commands),
        "OPTIONS": _entries(top.groups.get("Options", [])),
        "ENVIRONMENT": _entries([token]),
        "FILES": _entries(_FILES),
        "SEE ALSO": _references([f"curvecast-{name}" for name in helps]),
    }
    return _page("curvecast", _summary(top.description[0]), sections, version, date)


def _completion(top: Help, helps: dict[str, Help]) -> str:
    cases = "".join(f"    {name}) words='{' '.join(help_.flags())}' ;;\n" for name, help_ in helps.items())
    return f"""# Completion of curvecast for bash, made of what its --help says. Where it knows nothing, names of files.
_curvecast() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} words=
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    words='{" ".join([*helps, *top.flags()])}'
  elif [[ $current == -* ]]; then
    case ${{COMP_WORDS[1]}} in
{textwrap.indent(cases, "  ")}    esac
  fi
  [[ -z $words ]] || mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}
complete -o bashdefault -o default -F _curvecast curvecast
"""


def _changelog(text: str, version: str, maintainer: str, seconds: int) -> str:
    """The section of this version in Debian's form."""
    section = re.search(rf"^## \[{re.escape(version)}\].*?\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    if section is None:
        raise ValueError(f"CHANGELOG.md has no section of {version}")
    items = re.findall(r"^- (.*(?:\n  .*)*)", section[1], re.MULTILINE)
    plain = [re.sub(r"\*\*|`|\[([^]]*)\]\([^)]*\)", lambda match: match[1] or "", item) for item in items]
    lines = [textwrap.fill(" ".join(item.split()), 78, initial_indent="  * ", subsequent_indent="    ") for item in plain]
    return f"curvecast ({version}) stable; urgency=medium\n\n" + "\n".join(lines) + f"\n\n -- {maintainer}  {formatdate(seconds)}\n"


def _write_packed(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--command", type=Path, required=True, help="curvecast, as it is installed")
    parser.add_argument("--root", type=Path, required=True, help="the folder that becomes /")
    parser.add_argument("--changelog", type=Path, required=True, help="CHANGELOG.md")
    parser.add_argument("--version", required=True)
    parser.add_argument("--maintainer", required=True, help="NAME <ADDRESS>")
    parser.add_argument("--seconds", type=int, required=True, help="since 1970, of what is packed")
    options = parser.parse_args()
    date = time.strftime("%Y-%m-%d", time.gmtime(options.seconds))
    top, helps = subcommands(options.command.absolute())
    pages = {f"curvecast-{name}": _command_page(name, help_, options.version, date) for name, help_ in helps.items()}
    pages["curvecast"] = _main_page(top, helps, options.version, date)
    for name, page in pages.items():
        _write_packed(options.root / "usr/share/man/man1" / f"{name}.1.gz", page)
    completion = options.root / "usr/share/bash-completion/completions/curvecast"
    completion.parent.mkdir(parents=True, exist_ok=True)
    completion.write_text(_completion(top, helps))
    changelog = _changelog(options.changelog.read_text(), options.version, options.maintainer, options.seconds)
    _write_packed(options.root / "usr/share/doc/curvecast/changelog.gz", changelog)


if __name__ == "__main__":
    main()
