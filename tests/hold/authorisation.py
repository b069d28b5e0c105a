"""Every call with every kind of credential, wherever the session is: nobody gets in who should not, and everybody who should.

Tokens: none, wrong, malformed, expired, another's, revoked; over gRPC and WebSockets; certificates of the right and of another
authority; with the session in memory, only in the cache, after a restart and on a second server of the folder. And callers who
are kept apart, of whom one asks for all that is another's.
"""

from __future__ import annotations

import hashlib
import os
import pathlib
import signal
import ssl
import time
from typing import Any, NamedTuple

import grpc

from curvecast.v1 import curvecast_pb2 as v1
from hold.calls import NOBODY, Answer, Caller, Who, mesh_id_of
from hold.certificates import Certificates, Pair
from hold.history import now
from hold.report import Report
from hold.servers import Server, Setting, eventually
from hold.shapes import bumpy_ball, plain_view
from hold.web_socket import ClosedError, WebSocket, load_messages

POINTS = 300
FILE = "ball.off"
CHANGES = ("UpdateSession", "CloseSession")  # last: after them there is nothing left to call
LOOK = ("--max-curve-vertices", "0")
PATIENCE, RELOAD_SECONDS, CLOSED_SECONDS = 60.0, 5.0, 1.1
ANNA, BERT, CARL = Who("anna", "anna's", "valid"), Who("bert", "bert's", "valid"), Who("carl", "carl's", "valid")
APART = BERT._replace(token="bert's")  # where he finds only what is his own
FOR_ALL = ("UploadMesh", "GetUpload", "ImportMesh", "ListMeshes", "ListSessions")  # what names nothing that is another's
NOBODIES = (
    Who(credential="none"),
    Who("", "nobody's", "wrong"),
    Who("", "late's", "expired"),
    Who("", "ANNA'S", "malformed: in capitals"),
    Who("", "anna's,bert's", "malformed: two"),
    Who("", "a" * 5000, "malformed: long"),
    Who("", "anna's", "malformed: of another kind", "Basic"),
    Who("", "anna's", "malformed: of no kind", ""),
)


class Tally:
    def __init__(self) -> None:
        self.cases = self.let_in = self.kept_out = 0
        self.examples: list[str] = []

    def count(self, where: str, method: str, who: Who, code: str) -> None:
        """Holds an answer against what it should be."""
        self.cases += 1
        is_refused = code in ("UNAUTHENTICATED", "UNAVAILABLE")
        if who.credential != "valid":
            wrong = not is_refused
            self.let_in += wrong
        elif who is APART:
            wrong = code != ("OK" if method in FOR_ALL else "NOT_FOUND")
            self.let_in += wrong
        elif who is BERT and method in CHANGES:
            wrong = code != "PERMISSION_DENIED"
            self.let_in += wrong
        else:
            wrong = code != "OK"
            self.kept_out += wrong
        if wrong:
            self.examples.append(f"{where}: {method} by {who.name or 'nobody'} ({who.credential}): {code}")


class Subject(NamedTuple):
    """What the calls are about."""

    mesh: bytes
    points: bytes  # an upload that can be measured
    session: str

    def requests(self, method: str) -> list[Any]:
        """A request of each call that is well, and small."""
        mesh, session, sample = mesh_id_of(self.mesh), self.session, plain_view(POINTS)
        every: dict[str, list[Any]] = {
            "UploadMesh": [
                v1.UploadMeshRequest(header=v1.UploadHeader(name=FILE, size=len(self.mesh))),
                v1.UploadMeshRequest(chunk=self.mesh),
            ],
            "GetUpload": [v1.GetUploadRequest(mesh_id=mesh)],
            "ImportMesh": [v1.ImportMeshRequest(path=FILE)],
            "ListMeshes": [v1.ListMeshesRequest()],
            "GetMesh": [v1.GetMeshRequest(mesh_id=mesh)],
            "ListMeshReferences": [v1.ListMeshReferencesRequest(mesh_id=mesh)],
            "InspectMesh": [v1.InspectMeshRequest(mesh_id=mesh)],
            "GetParameterMesh": [v1.GetParameterMeshRequest(mesh_id=mesh)],
            "Scatter": [v1.ScatterRequest(mesh_id=mesh, sample=sample)],
            "CreateSession": [v1.CreateSessionRequest(mesh_id=mesh, options=v1.SessionOptions(max_points=POINTS))],
            "GetSession": [v1.GetSessionRequest(session_id=session)],
            "ListSessions": [v1.ListSessionsRequest()],
            "Resample": [v1.ResampleRequest(session_id=session, sample=sample)],
            "FindNeighbours": [v1.FindNeighboursRequest(session_id=session, sample=sample, count=2)],
            "StreamViews": [v1.StreamViewsRequest(open=v1.OpenView(session_id=session))],
            "Render": [v1.RenderRequest(session_id=session, width=32, height=32)],
            "Remesh": [v1.RemeshRequest(session_id=session, sample=sample)],
            "Measure": [
                v1.MeasureRequest(
                    mesh_id=mesh, sets=[v1.UploadedPoints(points_id=mesh_id_of(self.points))], ring_seeds=4, ball_centres=4
                )
            ],
            "GetSurface": [v1.GetSurfaceRequest(session_id=session)],
            "GetCurve": [v1.GetCurveRequest(session_id=session)],
            "UpdateSession": [v1.UpdateSessionRequest(session_id=session, time_to_live=1e6)],
            "CloseSession": [v1.CloseSessionRequest(session_id=session)],
        }
        return every[method]

    def fields(self, method: str) -> dict[str, str]:
        """What the history says of such a call."""
        names = {field.name for field in type(self.requests(method)[0]).DESCRIPTOR.fields}
        return {"session": self.session} if "session_id" in names or method in ("StreamViews", "CreateSession") else {}


METHODS = tuple(method.name for method in v1.DESCRIPTOR.services_by_name["CurvecastService"].methods if method.name not in CHANGES)


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    tally = Tally()
    source = os.environ["CURVECAST_SOURCE"]
    messages = load_messages(f"{source}/proto")
    tokens = setting.folder / "tokens"
    write_tokens(tokens, "anna", "bert", "carl")
    (setting.folder / FILE).write_bytes(bumpy_ball(8))
    options = (*LOOK, "--tokens", str(tokens), "--mesh-folder", str(setting.folder), "--max-sessions", "1")
    cache = setting.folder / "cache"

    def start(name: str) -> Server:
        return Server(setting, name, *options, cache=cache, tokens=True)

    with start("first") as server:
        subject = prepare(setting, server)
        try_all(setting, server, subject, messages, "in memory", tally)
        subject = prepare(setting, server)
        with Caller(server, setting.history, "bert", BERT) as caller:  # there is room for one
            caller.upload("other.off", bumpy_ball(8, seed=1))
            caller.create(mesh_id_of(bumpy_ball(8, seed=1)), POINTS)
        try_all(setting, server, subject, messages, "in the cache", tally)
        subject = prepare(setting, server)
    with start("first") as server:
        bring(setting, server, subject)
        try_all(setting, server, subject, messages, "after a restart", tally)
        subject = prepare(setting, server)
        with start("second") as second:
            bring(setting, second, subject)
            try_all(setting, second, subject, messages, "on a second server", tally)
            if not setting.is_quick:  # closed on one server, a session is gone on the other, within a second
                time.sleep(CLOSED_SECONDS)
                with Caller(server, setting.history, "afterwards", ANNA) as caller:
                    gone = caller.get(subject.session)
                report.require("closed sessions found on another server", int(gone.is_ok), at_most=0)
    try_apart(setting, messages, tokens, tally)
    try_certificates(setting, messages, tally)
    still = try_revoked(setting, tokens)
    report.require("cases", tally.cases, at_least=1000)
    report.require("let in who should not be", tally.let_in, at_most=0)
    report.require("kept out who should be let in", tally.kept_out, at_most=0)
    report.require("calls with a revoked token let in", len(METHODS) if still is None else still, at_most=0)
    report.notes += tally.examples[:10]
    return report


def write_tokens(path: pathlib.Path, *names: str) -> None:
    lines = [f"{name} {hashlib.sha256(f'{name}{chr(39)}s'.encode()).hexdigest()}" for name in names]
    late = hashlib.sha256(b"late's").hexdigest()
    path.write_text("\n".join([*lines, f"late {late} 1000000000"]) + "\n")


def prepare(setting: Setting, server: Server) -> Subject:
    """Has Anna make a session, and waits until it is in the cache."""
    subject = Subject(bumpy_ball(8), bytes(12) + b"\0\0\x80?" * 3, "")
    with Caller(server, setting.history, "anna", ANNA) as caller:
        bring(setting, server, subject)
        session = caller.create(mesh_id_of(subject.mesh), POINTS).value.session_id
        for _ in eventually(PATIENCE):
            if caller.is_cached(session):
                break
    return subject._replace(session=session)


def bring(setting: Setting, server: Server, subject: Subject) -> None:
    with Caller(server, setting.history, "anna", ANNA) as caller:
        caller.upload(FILE, subject.mesh)
        caller.upload("points", subject.points)


def try_all(setting: Setting, server: Server, subject: Subject, messages: tuple[Any, Any], where: str, tally: Tally) -> None:
    """Who may do nothing comes first, and who may end the session last."""
    for who in (*NOBODIES, BERT, ANNA):
        with Caller(server, setting.history, where, who, patience=PATIENCE) as caller:
            for method in (*METHODS, *CHANGES):
                if who is ANNA and method in CHANGES:
                    continue  # until she has come over a WebSocket, too
                tally.count(where, method, who, ask(caller, method, subject))
        for method in (*METHODS, *CHANGES) if who.kind == NOBODY.kind else ():  # a WebSocket has one kind
            code = ask_over_socket(setting, server, f"{where}, WebSocket", who, method, subject, messages)
            tally.count(f"{where}, WebSocket", method, who, code)


def ask(caller: Caller, method: str, subject: Subject) -> str:
    requests = subject.requests(method)
    is_many = method in ("UploadMesh", "StreamViews")
    answer: Answer = caller.call(method, iter(requests) if is_many else requests[0], patience=PATIENCE, **subject.fields(method))
    return answer.code


def ask_over_socket(
    setting: Setting,
    server: Server,
    client: str,
    who: Who,
    method: str,
    subject: Subject,
    messages: tuple[Any, Any],
    tls: ssl.SSLContext | None = None,
) -> str:
    begin, text = now(), ""
    try:
        with WebSocket(server.http, messages, who.token, tls, PATIENCE) as socket:
            ended = socket.call(method, *(request.SerializeToString() for request in subject.requests(method)))
            code = next(code.name for code in grpc.StatusCode if code.value[0] == ended.code)
            text = ended.message
    except ClosedError as closed:
        # 1008: the server does not take the caller; a status of HTTP: it will not even open.
        code, text = "UNAUTHENTICATED" if closed.code in (1008, 401, 403, 400) else "UNAVAILABLE", str(closed)
    except OSError as error:
        code, text = "UNAVAILABLE", str(error)
    fields = {"message": text[:200], **subject.fields(method)}
    setting.history.tell(
        "call",
        server=server.name,
        client=client,
        caller=who.name,
        call=method,
        begin=begin,
        end=now(),
        code=code,
        credential=who.credential,
        **fields,
    )
    return code


def try_apart(setting: Setting, messages: tuple[Any, Any], tokens: pathlib.Path, tally: Tally) -> None:
    """Servers that keep callers apart: Bert asks for all that is Anna's, wherever it is."""
    options = (*LOOK, "--isolate", "--tokens", str(tokens), "--mesh-folder", str(setting.folder), "--max-sessions", "1")

    def start(name: str) -> Server:
        return Server(setting, name, *options, cache=setting.folder / "apart", tokens=True, apart=True)

    def try_it(server: Server, where: str) -> None:
        with Caller(server, setting.history, where, APART, patience=PATIENCE) as caller:
            for method in (*METHODS, *CHANGES):
                if method in ("UploadMesh", "ImportMesh"):
                    continue  # after which the mesh is his, too
                tally.count(where, method, APART, ask(caller, method, subject))
                code = ask_over_socket(setting, server, where, APART, method, subject, messages)
                tally.count(f"{where}, WebSocket", method, APART, code)
        with Caller(server, setting.history, "anna", ANNA) as caller:
            tally.count(where, "GetMesh", ANNA, ask(caller, "GetMesh", subject))
            tally.count(where, "Resample", ANNA, ask(caller, "Resample", subject))

    with start("apart") as server:
        subject = prepare(setting, server)
        try_it(server, "apart, in memory")
    with start("apart") as server:
        try_it(server, "apart, after a restart")
        with start("apart too") as second:
            try_it(second, "apart, on a second server")


def try_certificates(setting: Setting, messages: tuple[Any, Any], tally: Tally) -> None:
    """A server that asks for certificates, and clients with a good one, another authority's, and none."""
    made = Certificates(setting.folder)
    options = (
        "--tls-cert",
        str(made.server.chain),
        "--tls-key",
        str(made.server.key),
        "--tls-client-ca",
        str(made.authority.chain),
    )
    shown: list[tuple[Who, Pair | None]] = [
        (Who(credential="no certificate"), None),
        (Who(credential="another authority's certificate"), made.stranger),
        (Who("client", credential="valid"), made.client),
    ]
    with Server(setting, "certified", *LOOK, *options, "--mesh-folder", str(setting.folder)) as server:
        subject = Subject(bumpy_ball(8), bytes(12) + b"\0\0\x80?" * 3, "")
        with Caller(server, setting.history, "maker", Who("client"), made.credentials(made.client)) as caller:
            caller.upload(FILE, subject.mesh)
            caller.upload("points", subject.points)
            subject = subject._replace(session=caller.create(mesh_id_of(subject.mesh), POINTS).value.session_id)
        for who, pair in shown:
            context = ssl.create_default_context(cafile=str(made.authority.chain))
            if pair is not None:
                context.load_cert_chain(pair.chain, pair.key)
            with Caller(server, setting.history, "TLS", who, made.credentials(pair), patience=PATIENCE) as caller:
                for method in METHODS:
                    tally.count("TLS", method, who, ask(caller, method, subject))
                    tally.count(
                        "TLS, WebSocket",
                        method,
                        who,
                        ask_over_socket(setting, server, "TLS", who, method, subject, messages, context),
                    )


def try_revoked(setting: Setting, tokens: pathlib.Path) -> int | None:
    """Takes a token out of the file and sends SIGHUP. Returns how many calls end wrong; None: the signal ended the server."""
    with Server(setting, "reloaded", "--tokens", str(tokens), "--mesh-folder", str(setting.folder), tokens=True) as server:
        subject = prepare_in_memory(setting, server)
        write_tokens(tokens, "anna", "bert")
        sent = now()
        server.process.send_signal(signal.SIGHUP)
        revoked = Who("carl", "carl's", "revoked")
        with Caller(server, setting.history, "carl", CARL._replace(credential=None)) as caller:
            for _ in eventually(RELOAD_SECONDS):
                if server.process.poll() is not None:
                    server.tell_killed(sent)
                    return None
                if caller.call("ListSessions", v1.ListSessionsRequest()).code == "UNAUTHENTICATED":
                    break
        with Caller(server, setting.history, "carl", revoked) as caller:
            codes = [ask(caller, method, subject) for method in METHODS]
        with Caller(server, setting.history, "anna", ANNA) as caller:
            codes += ["OK" for method in METHODS if ask(caller, method, subject) != "OK"]
        return sum(code != "UNAUTHENTICATED" for code in codes)


def prepare_in_memory(setting: Setting, server: Server) -> Subject:
    subject = Subject(bumpy_ball(8), bytes(12) + b"\0\0\x80?" * 3, "")
    with Caller(server, setting.history, "carl", CARL) as caller:
        bring(setting, server, subject)
        return subject._replace(session=caller.create(mesh_id_of(subject.mesh), POINTS).value.session_id)
