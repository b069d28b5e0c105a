"""What notebooks show."""

import base64
import html.parser
import json
import pathlib
import tempfile
import threading
import unittest
from collections.abc import Iterator
from typing import Any
from unittest import mock

import grpc
import numpy as np

import curvecast
from curvecast import Points, notebook
from curvecast.v1 import curvecast_pb2 as v1
from fake_server import FakeServerTest, block_of
from fixture import ServerTest, sphere_obj

HOSTILE = "\"'><script>alert(1)</script><img src=x onerror=alert(2)>&lt;</curvecast-view>"
TOKEN = "open sesame 4711"
VIEWER = "http://127.0.0.1:8080/"


class Page(html.parser.HTMLParser):
    """What a browser makes of a text: tags with their attributes, and the text between them."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data

    def of(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]

    def shape(self) -> list[tuple[str, list[str]]]:
        """Without the values of attributes."""
        return [(tag, list(attributes)) for tag, attributes in self.tags]


class NotebookTest(FakeServerTest):
    def session(self, name: str, session_id: str = "0123", **options: Any) -> curvecast.Session:
        """Of a client with these options, as if the server had described it so."""
        client = curvecast.connect(self.address, attempts=1, **options)
        self.addCleanup(client.close)
        mesh = v1.MeshInfo(name=name, faces=12_345, vertices=6789, components=1, area=2.5, attributes=[f"scalar {name}"])
        report = v1.PreprocessReport(mesh=mesh)
        info = v1.Session(session_id=session_id, options=v1.SessionOptions(max_points=1), report=report)
        return curvecast.Session(client._connection, info)

    def assert_picture(self, page: Page) -> None:
        (image,) = page.of("img")
        head, _, data = str(image["src"]).partition(",")
        self.assertEqual(head, "data:image/png;base64")
        self.assertTrue(base64.b64decode(data, validate=True).startswith(b"\x89PNG"))

    def test_points(self) -> None:
        points = Points(np.array([100.0, 200, 300]), np.array([[0, 0, 0], [1, 2, 4]], "<f4"), scalars={HOSTILE: np.zeros(2, "<f4")})
        page = Page(points._repr_html_())
        self.assert_picture(page)
        for text in ("points2", f"positions, scalar {HOSTILE}", "1 by 2 by 4", "100, 200, 300"):
            self.assertIn(text, page.text)
        harmless = Points(points.origin, points.positions, scalars={"heat": np.zeros(2, "<f4")})
        self.assertEqual(page.shape(), Page(harmless._repr_html_()).shape())
        limited = Points(points.origin, points.positions, statistics=v1.FrameStatistics(limit=v1.POINT_LIMIT_DENSITY))
        self.assertIn("fewer than asked fordensity", Page(limited._repr_html_()).text)

    def test_points_that_cannot_be_drawn_are_a_table(self) -> None:
        for positions in (np.zeros((0, 3), "<f4"), np.full((2, 3), np.nan, "<f4")):
            page = Page(Points(np.zeros(3), positions)._repr_html_())
            self.assertEqual((page.of("img"), len(page.of("table"))), ([], 1))

    def test_a_session_without_a_viewer_is_a_picture_and_a_table(self) -> None:
        self.service.points = [block_of(1)]
        page = Page(self.session("armadillo.off")._repr_html_())
        self.assert_picture(page)
        for text in ("armadillo.off", "0123", "12,345", "6,789", "2.5"):
            self.assertIn(text, page.text)
        self.assertEqual((page.of("a"), page.of("curvecast-view"), page.of("iframe")), ([], [], []))

    def test_a_viewer_makes_it_live(self) -> None:
        self.service.points = [block_of(1)]
        for viewer in ("http://127.0.0.1:8080", VIEWER, VIEWER + "?", VIEWER + "#"):
            page = Page(self.session("armadillo.off", viewer=viewer)._repr_html_())
            self.assertEqual(page.tags[0], ("curvecast-view", {"src": "http://127.0.0.1:8080/#session=0123"}))
            (link,) = page.of("a")
            self.assertEqual((link["href"], link["rel"]), ("http://127.0.0.1:8080/#session=0123", "noopener noreferrer"))
            self.assert_picture(page)  # until the element is there

    def test_no_token_is_shown(self) -> None:
        self.service.points = [block_of(1)]
        shown = self.session("armadillo.off", token=TOKEN, viewer=VIEWER)._repr_html_()
        self.assertEqual(self.service.tokens, [f"Bearer {TOKEN}"])
        page = Page(shown)
        self.assert_picture(page)  # that was sent to its holder
        self.assertEqual(page.of("curvecast-view"), [])
        self.assertEqual([link["href"] for link in page.of("a")], [VIEWER + "#session=0123"])
        for spelling in (TOKEN, TOKEN.replace(" ", "+"), TOKEN.replace(" ", "%20"), base64.b64encode(TOKEN.encode()).decode()):
            self.assertNotIn(spelling, shown)

    def test_addresses_of_viewers(self) -> None:
        for viewer in (
            "javascript:alert(1)//x/",
            "127.0.0.1:8080",
            "ftp://example.org/",
            "http://",
            "http:///path",
            f"http://someone:{TOKEN}@example.org/",
            f"http://example.org/#token={TOKEN}",
            f"http://example.org/?token={TOKEN}",
        ):
            with self.subTest(viewer), self.assertRaisesRegex(ValueError, "viewer is") as caught:
                curvecast.connect(self.address, viewer=viewer)
            self.assertNotIn(TOKEN, str(caught.exception))
        self.assertEqual(notebook.viewer_address("https://example.org/a/b"), "https://example.org/a/b/")

    def test_what_comes_from_servers_and_files_is_escaped(self) -> None:
        self.service.points = [block_of(1)]
        for options in ({}, {"viewer": VIEWER}, {"viewer": VIEWER, "token": TOKEN}):
            harmless = Page(self.session("armadillo.off", **options)._repr_html_())
            page = Page(self.session(HOSTILE, HOSTILE + "&token=x#", **options)._repr_html_())
            self.assertEqual(page.shape(), harmless.shape())
            self.assertEqual(page.text.count(HOSTILE), 3)  # caption, id, attribute
            for link in page.of("a"):  # the id is one parameter still
                self.assertRegex(str(link["href"]), r"^http://127\.0\.0\.1:8080/#session=[\w%.~-]+$")

    def test_a_server_that_gives_no_points_leaves_a_table(self) -> None:
        def silence() -> Iterator[v1.PointBlock]:
            ended.wait(30)
            yield block_of(1)

        ended = threading.Event()
        self.addCleanup(ended.set)
        closed = self.session("mesh.off")
        closed._connection.close()
        cases: list[tuple[curvecast.Session, Any, list[grpc.StatusCode]]] = [
            (self.session("mesh.off"), [], []),
            (self.session("mesh.off"), [block_of(1)], [grpc.StatusCode.NOT_FOUND]),
            (self.session("mesh.off"), [block_of(1)], [grpc.StatusCode.UNAVAILABLE]),
            (self.session("mesh.off"), [block_of(2)], []),  # more than asked for
            (self.session("mesh.off"), silence(), []),
            (closed, [block_of(1)], []),
        ]
        for session, self.service.points, self.service.failures in cases:
            with mock.patch("curvecast.session.PREVIEW_TIMEOUT", 0.5):
                page = Page(session._repr_html_())
            self.assertEqual((page.of("img"), len(page.of("table"))), ([], 1))
            self.assertIn("12,345", page.text)

    def test_what_is_not_known_is_left_out(self) -> None:
        self.service.failures = [grpc.StatusCode.NOT_FOUND] * 2
        session = curvecast.Session(self.client._connection, v1.Session(session_id="0123"))
        self.assertEqual(Page(session._repr_html_()).text, "Sessionsession0123")

    def test_the_element_comes_as_one_script(self) -> None:
        source = "console.log('</script><b>\u2028\\u003c', `${1}`);\n"
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "element.js"
            path.write_text(source, encoding="utf-8")
            page = Page(notebook.live(path)._repr_html_())
        self.assertEqual(page.shape(), [("script", [])])
        begin, end = "import(URL.createObjectURL(new Blob([", "], { type: 'text/javascript' })))"
        self.assertTrue(page.text.startswith(begin) and page.text.endswith(end))
        self.assertEqual(json.loads(page.text[len(begin) : -len(end)]), source)


class ServedSessionTest(ServerTest):
    def test_the_picture_is_that_of_the_sessions_points(self) -> None:
        session = self.client.open(self.client.upload_bytes("a <b> ball.obj", sphere_obj().encode()), 1000)
        shown, points = session._repr_html_(), session.sample(1000)
        self.assertIn(notebook.picture_html(points), shown)
        self.assertIn("a &lt;b&gt; ball.obj", shown)
        self.assertLess(len(shown), 110_000)


if __name__ == "__main__":
    unittest.main()
