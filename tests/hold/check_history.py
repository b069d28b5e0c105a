#!/usr/bin/env python3
"""Compares what servers answered with what they may answer: a program of its own, which shares no code with the driver.

    tests/hold/check_history.py FILE_OR_FOLDER...

Reads `history.jsonl`, an object a line. `kind` says what it tells; times are seconds of one clock:

  serve   a server is ready: server, store (servers of one folder share it), at; reference (calm, no cache, no refinement),
          mesh_limit (bytes of meshes that it may hold), keeps_uploads (over restarts), tokens (it asks for them), apart (callers
          find only what is theirs)
  end     a server was told to end, or found dead: server, at, how (stopped, killed, crashed)
  fault   calls may fail meanwhile: server, begin, end
  damage  somebody spoiled a session's files: store, session, at
  call    a request and its answer: server, client, caller, call, begin, end, code, message; and, where they apply, credential
          ("valid" or why it is none), mesh, size, session, cached, made (by this very call), request (digest), digest, vertices
          (of the curve that was sampled), settled (no better frame follows), opened (when the stream was)

The model: a session's points are those of a calm server for the same curve and request, or at least always the same; what was
acknowledged stays; what is closed is gone; nobody gets in without a credential, or at another's sessions; every call ends, and
fails only where a server is down. Ends with status 1 where any answer contradicts it.
"""

from __future__ import annotations

import bisect
import collections
import json
import pathlib
import sys
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

Event = dict[str, Any]
Key = tuple[str, str]

CLOSE_SECONDS = 1.0  # after which a closed session has to be gone everywhere
CHANGES = ("CloseSession", "UpdateSession")
REFUSED = ("UNAUTHENTICATED", "PERMISSION_DENIED", "NOT_FOUND", "INVALID_ARGUMENT")  # what changes nothing
READS_MESH = ("GetMesh", "InspectMesh", "CreateSession", "ListMeshReferences")
REMOVED = "Stream removed"  # what gRPC makes of an answer whose rest a proxy has lost: UNAVAILABLE is meant
AGES = float("inf")


class Violation(NamedTuple):
    rule: str
    event: Event
    why: str

    def __str__(self) -> str:
        told = {name: value for name, value in self.event.items() if name not in ("kind", "request")}
        return f"{self.rule}: {self.why}: {json.dumps(told)}"


class Span(NamedTuple):
    begin: float
    end: float
    event: Event


class Facts:
    """What happened to servers, meshes and sessions: gathered first, since an answer may depend on a request that ended later."""

    def __init__(self, events: Iterable[Event]) -> None:
        self.lives: dict[str, list[Span]] = collections.defaultdict(list)  # of each server
        self.faults: dict[str, list[Span]] = collections.defaultdict(list)
        self.uploads: dict[Key, list[Span]] = collections.defaultdict(list)  # acknowledged; by server and mesh
        self.sent: dict[str, list[tuple[float, str, int]]] = collections.defaultdict(list)  # when, mesh and bytes; by server
        self.creates: dict[Key, list[Span]] = collections.defaultdict(list)  # by store and session, as those below
        self.closes: dict[Key, list[Span]] = collections.defaultdict(list)
        self.damages: dict[Key, list[float]] = collections.defaultdict(list)
        self.cached: dict[Key, list[Span]] = collections.defaultdict(list)  # when a server said so
        self.references: dict[tuple[str, ...], str] = {}
        for event in events:
            getattr(self, f"_take_{event['kind']}")(event)
        for spans in self.cached.values():
            spans.sort(key=lambda span: span.end)

    def settings(self, event: Event) -> Event:
        """What the server of a call was last started with."""
        lives = self.lives.get(event["server"])
        return lives[-1].event if lives else {}

    def store(self, event: Event) -> str:
        return str(self.settings(event).get("store", event["server"]))

    def sent_by(self, caller: str, mesh: str, store: str) -> list[Span]:
        """The uploads of a mesh that any server of the store has acknowledged to him."""
        of_mesh = [span for (_, sent), spans in self.uploads.items() if sent == mesh for span in spans]
        return [span for span in of_mesh if span.event["caller"] == caller and self.store(span.event) == store]

    def life(self, server: str, begin: float, end: float) -> Span | None:
        """The life of a server that spans all of this time."""
        return next((life for life in self.lives[server] if life.begin <= begin and end < life.end), None)

    def _take_serve(self, event: Event) -> None:
        self.lives[event["server"]].append(Span(event["at"], AGES, event))

    def _take_end(self, event: Event) -> None:
        lives = self.lives[event["server"]]
        if lives and lives[-1].end == AGES:  # else it had not become ready
            lives[-1] = lives[-1]._replace(end=event["at"])

    def _take_fault(self, event: Event) -> None:
        self.faults[event["server"]].append(Span(event["begin"], event["end"], event))

    def _take_damage(self, event: Event) -> None:
        self.damages[event["store"], event["session"]].append(event["at"])

    def _take_call(self, event: Event) -> None:
        span = Span(event["begin"], event["end"], event)
        call, is_ok = event["call"], event["code"] == "OK"
        if call == "UploadMesh" and event.get("mesh"):
            self.sent[event["server"]].append((span.begin, event["mesh"], event.get("size", 0)))
            if is_ok:
                self.uploads[event["server"], event["mesh"]].append(span)
        if not event.get("session"):
            return
        key = self.store(event), event["session"]
        if call == "CreateSession" and event["code"] not in REFUSED:
            self.creates[key].append(span)
        if call == "CloseSession" and event["code"] not in REFUSED:
            self.closes[key].append(span)
        if is_ok and event.get("cached"):
            self.cached[key].append(span)
        if is_ok and event.get("digest") and event.get("settled", True) and self.settings(event).get("reference"):
            self.references[points_key(event)] = event["digest"]


def points_key(event: Event) -> tuple[str, ...]:
    return (event["call"], event["session"], str(event["vertices"]), event["request"])


class Checker:
    """Every rule takes a call and returns what is wrong with it, or None. Counts how often a rule had something to say."""

    def __init__(self, facts: Facts) -> None:
        self._facts = facts
        self._seen: dict[tuple[str, ...], str] = {}
        self.judged: collections.Counter[str] = collections.Counter()
        self.rules: dict[str, Callable[[Event], str | None]] = {
            "points": self._points,
            "uploads": self._uploads,
            "cached": self._cached,
            "closed": self._closed,
            "owners": self._owners,
            "apart": self._apart,
            "credentials": self._credentials,
            "answers": self._answers,
        }

    def check(self, event: Event) -> Iterator[Violation]:
        if event["kind"] == "end" and event["how"] == "crashed":
            yield Violation("answers", event, "the server ended by itself")
        if event["kind"] != "call":
            return
        for name, rule in self.rules.items():
            why = rule(event)
            if why is not None:
                yield Violation(name, event, why)

    def _points(self, event: Event) -> str | None:
        if event["code"] != "OK" or not event.get("digest") or not event.get("settled", True):
            return None
        key = points_key(event)
        reference = self._facts.references.get(key)
        self.judged["points by reference" if reference else "points by each other"] += 1
        expected = reference or self._seen.setdefault(key, event["digest"])
        return None if event["digest"] == expected else f"other points than {expected}"

    def _uploads(self, event: Event) -> str | None:
        """A mesh that a server has acknowledged is there, unless a limit that it states was reached."""
        mesh = event.get("mesh")
        if event["call"] not in READS_MESH or not mesh or event["code"] not in ("OK", "NOT_FOUND"):
            return None
        facts, server = self._facts, event["server"]
        before = [
            span
            for span in facts.uploads[server, mesh]
            if span.end <= event["begin"] and not (self._is_apart(event) and span.event["caller"] != event["caller"])
        ]
        if not before:
            return None
        self.judged["uploads"] += 1
        if event["code"] == "OK":
            return None
        acknowledged = max(before, key=lambda span: span.end)
        settings = facts.settings(event)
        if not settings.get("keeps_uploads") and facts.life(server, acknowledged.end, event["end"]) is None:
            return None
        held = {name: size for at, name, size in facts.sent[server] if at < event["end"]}
        if sum(held.values()) > settings.get("mesh_limit", AGES):
            return None
        return f"it was acknowledged at {acknowledged.end:.3f}"

    def _cached(self, event: Event) -> str | None:
        """A session that was reported cached is there until somebody closes it, or spoils its files."""
        if not event.get("session") or event["call"] == "CreateSession" or event["code"] not in ("OK", "NOT_FOUND"):
            return None
        facts, key = self._facts, (self._facts.store(event), event["session"])
        spans = facts.cached.get(key, [])
        at = bisect.bisect_right(spans, event["begin"], key=lambda span: span.end)
        if at == 0 or self._is_anothers(event):
            return None
        said = spans[at - 1]
        if any(close.end > said.begin and close.begin < event["end"] for close in facts.closes[key]):
            return None  # also by a close whose outcome nobody knows
        damage: float = max((at for at in facts.damages[key] if at < event["end"]), default=-AGES)
        if damage > -AGES and not any(
            create.event.get("made") and create.begin > damage and create.end <= said.begin for create in facts.creates[key]
        ):
            return None
        self.judged["cached"] += 1
        return None if event["code"] == "OK" else f"it was reported cached at {said.end:.3f}"

    def _closed(self, event: Event) -> str | None:
        """A session that was closed is not found, on any server of the folder, a second later, until somebody makes it anew."""
        if not event.get("session") or event["call"] == "CreateSession" or event["code"] not in ("OK", "NOT_FOUND"):
            return None
        facts, key = self._facts, (self._facts.store(event), event["session"])
        begin: float = event.get("opened") or event["begin"]
        closes = [c for c in facts.closes[key] if c.event["code"] == "OK" and c.end + CLOSE_SECONDS < begin]
        if not closes:
            return None
        last = closes[-1]
        if any(create.end > last.begin and create.begin < event["end"] for create in facts.creates[key]):
            return None
        self.judged["closed"] += 1
        return None if event["code"] == "NOT_FOUND" else f"it was closed at {last.end:.3f}"

    def _owners(self, event: Event) -> str | None:
        """With tokens, only who had a session made may change it; and he may."""
        if event["call"] not in CHANGES or not event.get("session") or not self._facts.settings(event).get("tokens"):
            return None
        if event.get("credential", "valid") != "valid" or event["code"] not in ("OK", "PERMISSION_DENIED"):
            return None
        owners = self._owners_at(event)
        if not owners:
            return None
        self.judged["owners"] += 1
        if event["code"] == "OK" and event["caller"] not in owners:
            return f"it is {' or '.join(sorted(owners))}'s"
        if event["code"] == "PERMISSION_DENIED" and owners == {event["caller"]}:
            return "it is his own"
        return None

    def _apart(self, event: Event) -> str | None:
        """Where callers are kept apart, nobody gets at what is another's, or hears that it is there."""
        if event.get("credential", "valid") != "valid" or event["code"] not in ("OK", "NOT_FOUND", "PERMISSION_DENIED"):
            return None
        if event["call"] != "CreateSession" and self._is_anothers(event):
            self.judged["apart"] += 1
            return None if event["code"] == "NOT_FOUND" else "it is another's"
        mesh = event.get("mesh")
        if event["call"] not in READS_MESH or not mesh or not self._is_apart(event):
            return None
        if any(span.begin < event["end"] for span in self._facts.sent_by(event["caller"], mesh, self._facts.store(event))):
            return None
        self.judged["apart"] += 1
        return None if event["code"] == "NOT_FOUND" else "he has not sent this mesh"

    def _is_apart(self, event: Event) -> bool:
        return bool(self._facts.settings(event).get("apart"))

    def _is_anothers(self, event: Event) -> bool:
        """Whether it is of a session that others have had made, where callers are kept apart."""
        if not event.get("session") or not self._is_apart(event):
            return False
        owners = self._owners_at(event)
        return bool(owners) and event["caller"] not in owners

    def _owners_at(self, event: Event) -> set[str]:
        """Those of whom one had the session made: more than one where their calls overlap."""
        key = self._facts.store(event), event["session"]
        closed = max((c.end for c in self._facts.closes[key] if c.end <= event["begin"] and c.event["code"] == "OK"), default=-AGES)
        creates = [c for c in self._facts.creates[key] if c.end > closed and c.begin < event["begin"]]
        if not creates:
            return set()
        first = min(creates, key=lambda create: create.end)
        return {create.event["caller"] for create in creates if create.begin <= first.end}

    def _credentials(self, event: Event) -> str | None:
        """Who has no credential gets nowhere, and who has one is never told that he has none."""
        credential = event.get("credential")
        if credential is None:
            return None
        self.judged["credentials"] += 1
        if credential == "valid":
            return "the credential is valid" if event["code"] == "UNAUTHENTICATED" else None
        # UNAVAILABLE: of a certificate, no connection.
        return (
            None if event["code"] in ("UNAUTHENTICATED", "UNAVAILABLE") else f"let in with a credential that is none: {credential}"
        )

    def _answers(self, event: Event) -> str | None:
        """Every call ends, with an answer, unless the server was down meanwhile."""
        self.judged["answers"] += 1
        code = event["code"]
        if code == "UNKNOWN" and event.get("message") == REMOVED and self._facts.settings(event).get("is_proxy"):
            code = "UNAVAILABLE"
        if code == "UNKNOWN":
            return "an error that the API does not have"
        if code not in ("UNAVAILABLE", "DEADLINE_EXCEEDED") or event.get("credential", "valid") != "valid":
            return None
        server = event["server"]
        if self._facts.life(server, event["begin"], event["end"]) is None:
            return None
        if any(fault.begin <= event["end"] and event["begin"] <= fault.end for fault in self._facts.faults[server]):
            return None
        return "it never ended" if code == "DEADLINE_EXCEEDED" else "the server was up"


class Result(NamedTuple):
    violations: list[Violation]
    judged: dict[str, int]  # how often each rule had something to say
    events: int


def check(read: Callable[[], Iterable[Event]]) -> Result:
    """Checks a history. `read`: gives all of its events, from the first, each time that it is called."""
    facts = Facts(read())
    checker = Checker(facts)
    violations: list[Violation] = []
    events = 0
    for event in read():
        events += 1
        violations += checker.check(event)
    return Result(violations, dict(sorted(checker.judged.items())), events)


def read_file(path: pathlib.Path) -> Iterator[Event]:
    """ValueError: a line that is no event, with its number."""
    with open(path, encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            try:
                event = json.loads(line)
                if not isinstance(event, dict) or event["kind"] not in ("serve", "end", "fault", "damage", "call"):
                    raise ValueError("it has no kind that is known")
            except (ValueError, KeyError) as error:
                raise ValueError(f"{path}:{number}: this is no event: {error}") from None
            yield event


def check_file(path: pathlib.Path) -> Result:
    return check(lambda: read_file(path))


def find_histories(paths: Iterable[pathlib.Path]) -> list[pathlib.Path]:
    """Files as they are; of folders every history.jsonl below them."""
    return [found for path in paths for found in (sorted(path.rglob("history.jsonl")) if path.is_dir() else [path])]


def main(arguments: list[str]) -> int:
    if not arguments or arguments[0] in ("-h", "--help"):
        print((__doc__ or "").strip())
        return 0 if arguments else 2
    paths = find_histories(map(pathlib.Path, arguments))
    if not paths:
        print(f"check_history: there is no history.jsonl in {' '.join(arguments)}", file=sys.stderr)
        return 3
    failed = False
    for path in paths:
        try:
            result = check_file(path)
        except (OSError, ValueError) as error:
            print(f"check_history: {error}", file=sys.stderr)
            return 3
        failed = failed or bool(result.violations)
        judged = ", ".join(f"{number} {name}" for name, number in result.judged.items())
        print(f"{path}: {result.events} events, judged: {judged or 'nothing'}; {len(result.violations)} violations")
        for violation in result.violations[:20]:
            print(f"  {violation}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
