# SPDX-License-Identifier: Apache-2.0
"""Meshes that a server holds, and the files that they refer to."""

from __future__ import annotations

import dataclasses
import hashlib
import os
import pathlib
from collections.abc import Mapping
from typing import BinaryIO

REFERENCE_ROUNDS = 8  # a mesh names material libraries, these name textures: two, as a rule
REFERRING_ENDINGS = {".obj", ".gltf", ".glb", ".ply"}
# A server may name any file of the folder, but needs no others than these.
COMPANION_ENDINGS = {".mtl", ".bin", ".png", ".jpg", ".jpeg", ".bmp", ".tga", ".gif", ".webp", ".ktx2"}


@dataclasses.dataclass(frozen=True)
class Mesh:
    """A mesh file that the server holds, with the files that it refers to."""

    id: str  #: 32 hexadecimal digits, the hash of its bytes
    companions: Mapping[str, str] = dataclasses.field(default_factory=dict)  #: name in the mesh -> id of that file
    refused: tuple[str, ...] = ()  #: why other files that it names were not sent, though some may be there


def as_mesh(mesh: Mesh | str) -> Mesh:
    return Mesh(mesh) if isinstance(mesh, str) else mesh


def mesh_id_of(file: BinaryIO) -> str:
    """Computes the mesh_id of a file: the first half of SHA-256 of its bytes, in 32 hexadecimal digits."""
    digest = hashlib.sha256()
    file.seek(0)
    while block := file.read(1 << 20):
        digest.update(block)
    return digest.hexdigest()[:32]


def may_have_companions(path: pathlib.Path) -> bool:
    """Tells whether meshes of the format of `path` can refer to other files."""
    return path.suffix.lower() in REFERRING_ENDINGS


def find_companion(mesh_path: pathlib.Path, name: str) -> pathlib.Path | None:
    """Finds the file `name` that a mesh refers to, in the mesh's folder or below, with the ending of a material library, buffer or
    picture; None where there is none. Symbolic links are followed as long as they stay there. ValueError: a name that is absolute,
    goes up, has a hidden part or another ending, or leads out of the folder."""
    reason = _reason_to_refuse(name)
    folder = os.path.realpath(mesh_path.parent)
    if not reason:
        file = pathlib.Path(os.path.realpath(os.path.join(folder, name)))
        if not file.is_relative_to(folder):
            reason = "leads out of the mesh's folder"
        else:
            return file if file.is_file() and file.stat().st_size > 0 else None
    raise ValueError(f"{mesh_path} refers to {name!r}, which {reason}")


def _reason_to_refuse(name: str) -> str:
    """Says what is wrong with a name; empty: nothing."""
    parts = name.split("/")
    if not name or "\0" in name:
        return "is no name of a file"
    if name.startswith("/"):
        return "is not relative to the mesh's folder"
    if any(part == "" or part.startswith(".") for part in parts):
        return "goes up or through a hidden folder"
    if pathlib.PurePosixPath(name).suffix.lower() not in COMPANION_ENDINGS:
        return "is no material library, buffer or picture"
    return ""
