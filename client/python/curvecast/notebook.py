# SPDX-License-Identifier: Apache-2.0
"""What notebooks show of points, surfaces and sessions: `_repr_html_()` of each returns what is made here.

Every text that comes from a file or a server is escaped. No token is ever in it: notebooks are saved with what they show, and
passed on.
"""

from __future__ import annotations

import base64
import html
import json
import os
import pathlib
import urllib.parse
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from curvecast import picture
from curvecast.errors import Error
from curvecast.v1 import curvecast_pb2 as v1

if TYPE_CHECKING:
    from curvecast.points import Points

SAMPLE_POINTS = 16_384  # of a surface, for its picture
Rows = Sequence[tuple[str, str]]


class LiveViews:
    """What brings the element `<curvecast-view>` into a notebook's page: as the result of one cell it makes the sessions of all
    others live. See live()."""

    def __init__(self, script: str) -> None:
        self._script = script

    def _repr_html_(self) -> str:
        text = json.dumps(self._script).replace("</", "<\\/")
        # The page imports the module from its text, wherever the notebook's files are.
        return f"<script>import(URL.createObjectURL(new Blob([{text}], {{ type: 'text/javascript' }})))</script>"


def live(element: str | os.PathLike[str] = "element.js") -> LiveViews:
    """Makes the sessions of a notebook live, as the result of one cell: those of clients that have the address of the server's
    viewer and no token. `element`: dist/element.js of the npm package. OSError: it cannot be read."""
    return LiveViews(pathlib.Path(element).read_text(encoding="utf-8"))


def viewer_address(address: str) -> str:
    """Checks the address of a server's viewer, and ends it with a slash; empty stays empty. ValueError: not one of http or https
    with a host and perhaps a port and a path; above all none with a name, a password or a token, which notebooks would keep."""
    if not address:
        return ""
    parts = urllib.parse.urlsplit(address)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ValueError("viewer is not of the form http://HOST:PORT/ or https://HOST/")
    if "@" in parts.netloc or parts.query or parts.fragment:
        raise ValueError("viewer is the address alone, without a name, and without what is after ? or #")
    return address.rstrip("?#/") + "/"


def points_html(points: Points) -> str:
    """Shows points: a picture, how many there are, what columns they have and where they lie."""
    rows = [("points", f"{len(points):,}"), ("columns", ", ".join(points.columns()))]
    if len(points):
        least, most = (points.origin + edge for edge in (points.positions.min(axis=0), points.positions.max(axis=0)))
        rows += box_rows(least, most)
    if points.limit is not None:
        rows.append(("fewer than asked for", points.limit))
    return beside(picture_html(points), table("Points", rows))


def surface_html(info: v1.MeshInfo, sample: Callable[[int], Points]) -> str:
    """Shows a surface: a picture of points of it, and what it holds."""
    return beside(sampled_html(sample, SAMPLE_POINTS), table(info.name, mesh_rows(info)))


def session_html(info: v1.Session, sample: Callable[[int], Points], viewer: str, has_token: bool) -> str:
    """Shows a session: a picture of its points, what is known of it and, where `viewer` is not empty, a link to the live viewer. In
    a page that has the element (see live()) the live view takes the place of all that, unless the client has a token: the element
    would need it. `viewer`: as of viewer_address()."""
    rows = [("session", info.session_id), *mesh_rows(info.report.mesh)]
    if info.options.max_points:
        rows.append(("points of the curve", f"{info.options.max_points:,}"))
    most = min(SAMPLE_POINTS, info.options.max_points or SAMPLE_POINTS)
    shown = beside(sampled_html(sample, most), table(info.report.mesh.name or "Session", rows))
    if not viewer:
        return shown
    address = html.escape(f"{viewer}#session={urllib.parse.quote(info.session_id, safe='')}")
    shown += f'<p><a href="{address}" target="_blank" rel="noopener noreferrer">Live view</a></p>'
    return shown if has_token else f'<curvecast-view src="{address}">{shown}</curvecast-view>'


def mesh_rows(mesh: v1.MeshInfo) -> Rows:
    """Lists what is known of a mesh."""
    if not mesh.faces:
        return []
    topology = f"{mesh.components:,}, genus {mesh.genus:,}, {mesh.boundary_loops:,} holes"
    least, most = ([corner.x, corner.y, corner.z] for corner in (mesh.box_min, mesh.box_max))
    rows = [
        ("triangles", f"{mesh.faces:,}"),
        ("vertices", f"{mesh.vertices:,}"),
        ("components", topology),
        ("area", f"{mesh.area:.6g}"),
        *box_rows(np.array(least), np.array(most)),
    ]
    return rows + ([("attributes", ", ".join(mesh.attributes))] if mesh.attributes else [])


def box_rows(least: picture.Floats, most: picture.Floats) -> Rows:
    """Says where a box lies."""
    return [("box", " by ".join(f"{side:.6g}" for side in most - least)), ("from", ", ".join(f"{value:.6g}" for value in least))]


def sampled_html(sample: Callable[[int], Points], points: int) -> str:
    """Draws so many points. Empty where they cannot be had: what is shown by the way is not worth an error."""
    try:
        return picture_html(sample(points))
    except (Error, ValueError):  # ValueError: of a client that was closed
        return ""


def picture_html(points: Points) -> str:
    """Draws points. Empty where there are none."""
    data = picture.draw(points)
    if data is None:
        return ""
    source = f"data:image/png;base64,{base64.b64encode(data).decode()}"
    return f'<img src="{source}" width="{picture.WIDTH}" height="{picture.HEIGHT}" alt="Picture of the points">'


def table(title: str, rows: Rows) -> str:
    """Makes a table with two columns of text."""
    body = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>" for name, value in rows)
    return f"<table><caption>{html.escape(title)}</caption>{body}</table>"


def beside(image: str, text: str) -> str:
    """Puts a picture and a text side by side, where both are there."""
    return f'<div style="display: flex; flex-wrap: wrap; gap: 1em; align-items: center">{image}{text}</div>' if image else text
