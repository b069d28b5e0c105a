"""Uploads, sessions that are made of them, and looks at both, beside the viewers. What was lost on its way is repeated."""

from __future__ import annotations

import contextlib
import json
import pathlib
import random
import threading
from collections.abc import Callable, Iterator

from cluster.line import is_passing
from cluster.scene import PATIENCE, Scene
from hold.calls import Answer, Caller, mesh_id_of
from hold.servers import eventually
from hold.shapes import bumpy_ball, plain_view

RINGS, POINTS = 16, 1000  # of what is uploaded, and of the sessions that are made of it
EVERY, PAUSE = 5, 0.1  # uploads a session; seconds between calls


class Traffic:
    """What it has seen is read when it is over."""

    def __init__(self, scene: Scene) -> None:
        self.uploads: list[str] = []  # acknowledged: ids of meshes
        self.sessions: list[str] = []  # cached
        self.lost = 0  # of these, that were not found
        self.repeated = 0  # calls that were lost on their way
        self.failed: list[str] = []
        self._scene = scene
        self._over = threading.Event()
        self._random = random.Random(scene.setting.random.random())

    @contextlib.contextmanager
    def running(self) -> Iterator[None]:
        threads = [threading.Thread(target=self._repeat, args=(what,), daemon=True) for what in (self._send, self._look)]
        for thread in threads:
            thread.start()
        try:
            yield
        finally:
            self._over.set()
            for thread in threads:
                thread.join()

    def look_at_all(self) -> None:
        """Asks for all that was acknowledged."""
        with self._caller("last") as caller:
            for mesh in self.uploads:
                self._find(lambda mesh=mesh: caller.get_mesh(mesh))  # type: ignore[misc]
            for session in self.sessions:
                self._find(lambda session=session: caller.sample(session, plain_view(400)))  # type: ignore[misc]
            for wanted in self._scene.sessions:
                self._find(lambda wanted=wanted: caller.sample(wanted.session, wanted.view))  # type: ignore[misc]

    def _caller(self, name: str) -> Caller:
        return Caller(self._scene.edge, self._scene.setting.history, name, patience=PATIENCE)

    def _repeat(self, work: Callable[[Caller], None]) -> None:
        with self._caller(work.__name__.strip("_")) as caller:
            while not self._over.wait(PAUSE):
                work(caller)

    def _send(self, caller: Caller) -> None:
        number = len(self.uploads)
        data = bumpy_ball(RINGS) + b"# %d\n" % number
        mesh = mesh_id_of(data)
        if not self._persist(lambda: caller.upload("ball.off", data)).is_ok:
            return
        self.uploads.append(mesh)
        if number % EVERY:
            return
        answer = self._persist(lambda: caller.create(mesh, POINTS))
        if answer.is_ok:  # until it is cached, another replica does not know it
            self.sessions += [answer.value.session_id] * caller.wait_until_cached([answer.value.session_id])

    def _look(self, caller: Caller) -> None:
        wanted = self._random.choice(self._scene.sessions)
        self._find(lambda: caller.sample(wanted.session, wanted.view))
        self._find(lambda: caller.create(wanted.mesh, wanted.points))
        if self.uploads:
            mesh = self._random.choice(self.uploads)
            self._find(lambda: caller.get_mesh(mesh))

    def _find(self, call: Callable[[], Answer]) -> None:
        self.lost += self._persist(call).code == "NOT_FOUND"

    def _persist(self, call: Callable[[], Answer]) -> Answer:
        answer = call()
        for _ in eventually(PATIENCE):
            if answer.is_ok or not is_passing(answer.code, answer.message):
                break
            self.repeated += 1
            answer = call()
        if not answer.is_ok:
            self.failed.append(f"{answer.code}: {answer.message}")
        return answer


def made_again(history: pathlib.Path) -> int:
    """Calls that preprocessed a session which was cached before they began."""
    cached: dict[str, float] = {}
    again = 0
    with history.open(encoding="utf-8") as lines:
        for line in lines:
            event = json.loads(line)
            if event["kind"] != "call" or event.get("server") != "edge" or not event.get("session"):
                continue
            again += bool(event.get("made")) and cached.get(event["session"], float("inf")) <= event["begin"]
            if event.get("cached"):
                cached.setdefault(event["session"], event["end"])
    return again
