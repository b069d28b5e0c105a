"""A client that writes down all that it asks and is told. Errors of the server are answers here, not exceptions."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import Any, NamedTuple

import grpc

from curvecast.connection import ROUTING_KEY, ROUTING_KEY_DIGITS
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc
from hold.history import History, digest_of, now
from hold.servers import Target, eventually

PATIENCE = 120.0  # seconds that a call may take, on a machine that does other things too
CHUNK_BYTES = 1 << 19
CACHED_SECONDS = 45.0  # that wait_until_cached() looks for
# Not the client's own: it gives a connection a tenth of a second at first, which a busy machine does not keep.
OPTIONS = [("grpc.use_local_subchannel_pool", 1), ("grpc.max_receive_message_length", -1)]
LOOKS_UP = {"queued", "load"}  # stages of CreateSession that make nothing


class Answer(NamedTuple):
    code: str  # the name of a gRPC status code
    message: str  # of an error
    value: Any  # the answer, or the last message of several

    @property
    def is_ok(self) -> bool:
        return self.code == "OK"


class Who(NamedTuple):
    """Who calls: the name that the server knows him by, his token, and whether that is "valid" or why not; None: no matter."""

    name: str = ""
    token: str = ""
    credential: str | None = None
    kind: str = "Bearer"

    @property
    def metadata(self) -> tuple[tuple[str, str], ...]:
        return (("authorization", f"{self.kind} {self.token}".strip()),) if self.token else ()


NOBODY = Who()


def key_of(about: str) -> tuple[tuple[str, str], ...]:
    """What our clients tell proxies of a call about a mesh or a session."""
    return ((ROUTING_KEY, about[:ROUTING_KEY_DIGITS]),) if about else ()


def open_channel(address: str, credentials: grpc.ChannelCredentials | None = None) -> grpc.Channel:
    """A connection of its own, whoever else is connected."""
    if credentials is None:
        return grpc.insecure_channel(address, OPTIONS)
    return grpc.secure_channel(address, credentials, OPTIONS)


class Caller:
    """Calls one server, or those behind one proxy. Thread-safe."""

    def __init__(
        self,
        server: Target,
        history: History,
        client: str,
        who: Who = NOBODY,
        credentials: grpc.ChannelCredentials | None = None,
        patience: float = PATIENCE,
    ) -> None:
        self.who, self.server, self.client, self.patience = who, server, client, patience
        self._history = history
        self._channel = open_channel(server.address, credentials)
        self.stub = v1_grpc.CurvecastServiceStub(self._channel)

    def __enter__(self) -> Caller:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        self._channel.close()

    def call(
        self,
        method: str,
        request: Any,
        take: Callable[[Any], dict[str, Any]] | None = None,
        /,
        *,
        patience: float | None = None,
        **fields: Any,
    ) -> Answer:
        """Makes a call. `request`: a message, or an iterator of them. `take`: gets each message of the answer and returns fields
        for the history."""
        begin = now()
        value: Any = None
        code, message = "OK", ""
        try:
            call = getattr(self.stub, method)
            metadata = (*self.who.metadata, *key_of(fields.get("session") or fields.get("mesh") or ""))
            answer = call(request, timeout=patience or self.patience, metadata=metadata)
            for value in answer if isinstance(answer, Iterator) else [answer]:  # noqa: B007: the last one is returned
                fields |= take(value) if take is not None else {}
        except grpc.RpcError as error:
            code, message = error.code().name, error.details() or ""
        except ValueError:  # close() was faster
            code = "CANCELLED"
        self.tell(method, begin, code, message, **fields)
        return Answer(code, message, value)

    def tell(self, method: str, begin: float, code: str, message: str = "", **fields: Any) -> None:
        if message:
            fields["message"] = message
        if self.who.credential is not None:
            fields["credential"] = self.who.credential
        call = {"server": self.server.name, "client": self.client, "caller": self.who.name, "call": method}
        self._history.tell("call", **call, begin=begin, end=now(), code=code, **fields)

    # ------------------------------------------------------------------------------------------------------------ the calls

    def upload(self, name: str, data: bytes) -> Answer:
        mesh = mesh_id_of(data)

        def requests() -> Iterator[v1.UploadMeshRequest]:
            yield v1.UploadMeshRequest(header=v1.UploadHeader(name=name, size=len(data), mesh_id=mesh))
            for at in range(0, len(data), CHUNK_BYTES):
                yield v1.UploadMeshRequest(chunk=data[at : at + CHUNK_BYTES])

        return self.call("UploadMesh", requests(), mesh=mesh, size=len(data))

    def get_mesh(self, mesh: str) -> Answer:
        return self.call("GetMesh", v1.GetMeshRequest(mesh_id=mesh), mesh=mesh)

    def inspect(self, mesh: str, patience: float | None = None) -> Answer:
        return self.call("InspectMesh", v1.InspectMeshRequest(mesh_id=mesh), mesh=mesh, patience=patience)

    def create(self, mesh: str, points: int, *, omega: float = 0, seed: int = 0, patience: float | None = None) -> Answer:
        """Of a session that is ready, the value is the session."""
        options = v1.SessionOptions(max_points=points, omega=omega, seed=seed)
        request = v1.CreateSessionRequest(mesh_id=mesh, options=options, without_preview=True)

        def take(message: v1.CreateSessionResponse) -> dict[str, Any]:
            if message.HasField("progress"):
                return {} if message.progress.stage in LOOKS_UP else {"made": True}
            session = message.session
            return {"session": session.session_id, "cached": session.cached}

        answer = self.call("CreateSession", request, take, mesh=mesh, patience=patience)
        return answer._replace(value=answer.value.session) if answer.is_ok else answer

    def get(self, session: str) -> Answer:
        """The value is the session."""

        def take(message: v1.GetSessionResponse) -> dict[str, Any]:
            return {"cached": message.session.cached}

        answer = self.call("GetSession", v1.GetSessionRequest(session_id=session), take, session=session)
        return answer._replace(value=answer.value.session) if answer.is_ok else answer

    def is_cached(self, session: str) -> bool:
        answer = self.get(session)
        return answer.is_ok and bool(answer.value.cached)

    def wait_until_cached(self, sessions: list[str]) -> int:
        """How many are, after a while."""
        saved = 0
        for _ in eventually(CACHED_SECONDS):
            saved = sum(self.is_cached(session) for session in sessions)
            if saved == len(sessions):
                break
        return saved

    def sample(self, session: str, sample: v1.SampleRequest, patience: float | None = None) -> Answer:
        """The value is the digest of all points, as they came."""
        digest = hashlib.sha256()

        def take(message: v1.ResampleResponse) -> dict[str, Any]:
            digest.update(message.points.SerializeToString(deterministic=True))
            if not message.HasField("statistics"):
                return {}
            return {"vertices": message.statistics.curve_vertices, "settled": True, "digest": digest.hexdigest()[:32]}

        request = v1.ResampleRequest(session_id=session, sample=sample)
        answer = self.call("Resample", request, take, session=session, request=request_key(sample), patience=patience)
        return answer._replace(value=digest.hexdigest()[:32])

    def end_session(self, session: str) -> Answer:
        return self.call("CloseSession", v1.CloseSessionRequest(session_id=session), session=session)


def mesh_id_of(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:32]


def request_key(sample: v1.SampleRequest) -> str:
    return digest_of(sample.SerializeToString(deterministic=True))[:16]
