"""Copies the licences of what is compiled into the command, headers of Debian's packages and the viewer's packages of npm, to where
Debian has texts about a package; `components` lists them: name, version, purl. The libraries that the command is linked with are
packages of their own, which have their licences themselves."""

from __future__ import annotations

import argparse
import gzip
import json
import pathlib
import re
import subprocess
import urllib.parse
from collections.abc import Iterator

COMMON = pathlib.Path("/usr/share/common-licenses")


def output(*command: str | pathlib.Path) -> str:
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def inputs(build: pathlib.Path) -> list[str]:
    """Everything that the command is built from."""
    return output("ninja", "-C", build, "-t", "inputs", "curvecast").splitlines()


def headers(build: pathlib.Path, names: list[str]) -> list[str]:
    """Those of the system."""
    objects = [name for name in names if name.endswith(".o")]
    told = output("ninja", "-C", build, "-t", "deps", *objects)
    return sorted(set(re.findall(r"^    (/usr/\S+)$", told, re.MULTILINE)))


def debian(files: list[str]) -> Iterator[tuple[str, str, str, str]]:
    """Name, version, purl and licence of each source package that has some of these files."""
    # Not all of them are in a package: /usr/local.
    done = subprocess.run(
        ["dpkg-query", "--search", *files], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False
    )
    packages = sorted({line.partition(":")[0] for line in done.stdout.splitlines() if not line.startswith("diversion ")})
    seen = set()
    for package in packages:
        name, version = output("dpkg-query", "--show", "--showformat=${source:Package} ${source:Version}", package).split()
        if name not in seen:
            seen.add(name)
            purl = f"pkg:deb/debian/{urllib.parse.quote(name)}@{urllib.parse.quote(version, ':')}?arch=source&distro=debian-12"
            yield name, version, purl, pathlib.Path(f"/usr/share/doc/{package}/copyright").read_text()


def notices(package: pathlib.Path) -> list[str]:
    """What a package that has no file of its licence says in its sources."""
    found = set()
    for file in package.rglob("*.js"):
        # Comments at the beginning, line by line, without what makes them comments.
        head = re.match(r"(?:\s*//.*\n)+|\s*/\*(?:.|\n)*?\*/", file.read_text())
        if head and "copyright" in head[0].lower():
            found.add("\n".join(re.sub(r"^\s*(?://|/\*+|\*/|\*)? ?", "", line) for line in head[0].strip().splitlines()) + "\n")
    return sorted(found)


def npm(web: pathlib.Path) -> Iterator[tuple[str, str, str, str]]:
    """The same, of each package of npm that the viewer is made of."""
    for path, package in json.loads((web / "package-lock.json").read_text())["packages"].items():
        if not path or package.get("dev"):
            continue
        name = path.rpartition("node_modules/")[2]
        texts = [file.read_text() for file in sorted((web / path).iterdir()) if re.match(r"licen[cs]e", file.name, re.IGNORECASE)]
        if not texts:
            texts = [f"{name}: {package['license']}\n\n", *notices(web / path)]
            texts += [
                (COMMON / part).read_text() for part in re.findall(r"[\w.-]+", package["license"]) if (COMMON / part).is_file()
            ]
        purl = f"pkg:npm/{urllib.parse.quote(name)}@{package['version']}"
        yield "npm-" + name.lstrip("@").replace("/", "-"), package["version"], purl, "\n".join(texts)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="the folder of the build")
    parser.add_argument("--source", type=pathlib.Path, required=True, help="the project's folder")
    parser.add_argument("--root", type=pathlib.Path, required=True, help="the folder that becomes /")
    arguments = parser.parse_args()

    names = inputs(arguments.build)
    parts = list(debian(headers(arguments.build, names)))
    if any(name.endswith("client/web/viewer_files.cpp") for name in names):
        parts += npm(arguments.source / "client/web")
    folder = arguments.root / "usr/share/doc/curvecast/notices"
    folder.mkdir(parents=True)
    for name, _, _, text in parts:
        (folder / f"{name}.gz").write_bytes(gzip.compress(text.encode(), mtime=0))
    (folder / "components").write_text("".join(f"{name} {version} {purl}\n" for name, version, purl, _ in parts))


if __name__ == "__main__":
    main()
