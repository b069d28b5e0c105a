# SPDX-License-Identifier: Apache-2.0
"""Sessions in a notebook. Paste both functions into a cell, with dist/element.js of the npm package beside the notebook.

The server has to take the notebook's page: curvecast serve --web-origin http://localhost:8888 (what the browser has in its address).
"""

import html
import json
from pathlib import Path
from typing import Any

from IPython.display import HTML


def begin(element: str = "element.js") -> HTML:
    """Brings the element into the page: to be the result of one cell, before others show sessions."""
    script = json.dumps(Path(element).read_text()).replace("</", "<\\/")
    # The notebook's page imports the module from its text, wherever the notebook's files are.
    return HTML(f"<script>import(URL.createObjectURL(new Blob([{script}], {{ type: 'text/javascript' }})))</script>")


def show(session: Any, server: str, token: str = "", points: int = 50_000, height: str = "30rem") -> HTML:
    """Shows a curvecast.Session: to be the result of a cell. server: its HTTP address, as https://points.example.org/. A token is in
    what the notebook keeps: clear the outputs before you pass it on."""
    attributes = {"src": server, "session": session.id, "token": token, "points": points, "style": f"height: {height}"}
    written = " ".join(f'{name}="{html.escape(str(value))}"' for name, value in attributes.items() if value != "")
    return HTML(f"<curvecast-view {written}></curvecast-view>")
