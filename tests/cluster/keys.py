"""The same key goes to the same replica whatever brings it, keys are shared out evenly, and one replica more moves few of them."""

from __future__ import annotations

import collections
import http.client
import os
import pathlib
import subprocess
import urllib.parse

import grpc

import curvecast
from cluster.edge import REPLICA, Edge
from curvecast.connection import ROUTING_KEY_DIGITS
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc
from hold.calls import Caller, key_of, open_channel
from hold.kills import CALM
from hold.report import Report
from hold.servers import Server, Setting
from hold.shapes import bumpy_ball, plain_view
from hold.web_socket import WebSocket, load_messages

REPLICAS, KEYS, POINTS = 3, 1000, 2000
UNEVEN, MOVED = 0.2, 0.05  # of an even share, and of all keys beyond the share of the new one


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    keys = [f"{setting.random.getrandbits(64):016x}" for _ in range(KEYS)]
    with Edge(setting, REPLICAS, *CALM) as edge:
        report.require("replicas that hold a session of all clients", len(look_with_all(setting, edge)), at_least=1, at_most=1)
        before = by_grpc(edge, keys)
        differ = sum(before[key] != replica for key, replica in by_web(edge, keys).items())
        edge.add_replica()
        edge.stop_proxy()
        edge.start_proxy()
        after = by_grpc(edge, keys)
    shares = collections.Counter(before.values())
    moved = sum(before[key] != after[key] for key in keys)
    strays = sum(before[key] != after[key] != f"r{REPLICAS + 1}" for key in keys)
    report.figure("keys", KEYS)
    report.figure("shares", dict(sorted(shares.items())))
    report.figure("% that went to one replica more", 100 * moved / KEYS)
    report.require("keys whose replica depends on what brings them", differ, at_most=0)
    report.require("replicas with keys", len(shares), at_least=REPLICAS, at_most=REPLICAS)
    report.require(
        "of an even share, the farthest from it", max(abs(n * REPLICAS / KEYS - 1) for n in shares.values()), at_most=UNEVEN
    )
    report.require("of all keys moved", moved / KEYS, at_most=1 / (REPLICAS + 1) + MOVED)
    report.require("keys moved between old replicas", strays, at_most=0)
    return report


def by_grpc(edge: Edge, keys: list[str]) -> dict[str, str]:
    """The replica that answers calls with each key."""
    found = {}
    with open_channel(edge.address) as channel:
        stub = v1_grpc.CurvecastServiceStub(channel)
        for key in keys:
            try:
                _, call = stub.GetSession.with_call(v1.GetSessionRequest(session_id=key + key), metadata=key_of(key))
            except grpc.RpcError as error:
                call = error  # nobody knows such a session
            found[key] = str(dict([*call.initial_metadata(), *call.trailing_metadata()]).get(REPLICA, ""))
    return found


def by_web(edge: Edge, keys: list[str]) -> dict[str, str]:
    """The same of sockets: of the address that opens one."""
    found = {}
    connection = http.client.HTTPConnection(edge.http)
    for key in keys:
        connection.request("GET", f"/v1/socket?key={key}")
        response = connection.getresponse()
        response.read()
        found[key] = response.headers.get(REPLICA, "")
    connection.close()
    return found


def look_with_all(setting: Setting, edge: Edge) -> list[str]:
    """Looks at one session with the command, the Python client and a WebSocket. Returns which replicas have it in memory."""
    mesh = setting.folder / "ball.off"
    mesh.write_bytes(bumpy_ball(24))
    flags = ["--server", edge.address, "-n", str(POINTS)]
    subprocess.run([str(setting.command), "preprocess", str(mesh), *flags], check=True, capture_output=True)
    with curvecast.connect(edge.address) as client:
        session = client.open(client.upload(mesh), POINTS)
        session.sample(POINTS)
    messages = load_messages(str(pathlib.Path(os.environ["CURVECAST_SOURCE"], "proto")))
    with WebSocket(edge.http, messages, query=f"?{urllib.parse.urlencode({'key': session.id[:ROUTING_KEY_DIGITS]})}") as web:
        ended = web.call("Resample", v1.ResampleRequest(session_id=session.id, sample=plain_view(POINTS)).SerializeToString())
        if ended.code:
            raise RuntimeError(f"by the WebSocket: {ended.message}")
    return [name for name, server in edge.replicas.items() if has(setting, server, session.id)]


def has(setting: Setting, server: Server, session: str) -> bool:
    with Caller(server, setting.history, "counter") as caller:
        answer = caller.call("ListSessions", v1.ListSessionsRequest())
    return any(one.session_id == session for one in answer.value.sessions)
