"""The gateway of deploy/helm, truly run: HAProxy with the settings of its pod, and a name server and servers that stand in for the
cluster's. deploy/check_helm runs it."""

from __future__ import annotations

import contextlib
import http.client
import http.server
import os
import pathlib
import re
import shutil
import socket
import struct
import subprocess
import tempfile
import threading
import unittest
from typing import ClassVar

import helm_chart
from helm_chart import NAMESPACE, container, environment, eventually, find

REPLICAS = 3
KEYS = [f"{number * 0x9E3779B97F4A7C15 % 2**64:016x}" for number in range(1, 91)]
HAPROXY = shutil.which("haproxy") or "/usr/sbin/haproxy"


class Names:
    """A name server that knows IPv4 addresses; of other names it says that there are none."""

    def __init__(self) -> None:
        self.addresses: dict[str, str] = {}
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self) -> None:
        while True:
            try:
                query, sender = self.socket.recvfrom(4096)
            except OSError:
                return  # closed
            self.socket.sendto(self.answer(query), sender)

    def answer(self, query: bytes) -> bytes:
        labels, place = [], 12
        while query[place]:
            labels.append(query[place + 1 : place + 1 + query[place]].decode())
            place += 1 + query[place]
        (kind,) = struct.unpack(">H", query[place + 1 : place + 3])
        question = query[12 : place + 5]
        address = self.addresses.get(".".join(labels))
        is_asked = address is not None and kind == 1  # A
        code = 0x8180 if address is not None else 0x8183  # or: there is no such name
        answer = struct.pack(">HHHIH", 0xC00C, 1, 1, 5, 4) + socket.inet_aton(address) if address and is_asked else b""
        return query[:2] + struct.pack(">HHHHH", code, 1, int(is_asked), 0, 0) + question + answer

    def close(self) -> None:
        self.socket.close()


class Pod:
    """Says that it is ready, and its name."""

    def __init__(self, name: str, address: str, port: int) -> None:
        text = f"{name} at {address}".encode()

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("content-length", str(len(text)))
                # HAProxy's checks have gone once they know the status.
                with contextlib.suppress(ConnectionError):
                    self.end_headers()
                    self.wfile.write(text)

            def log_message(self, format: str, *args: object) -> None:  # noqa: A002
                pass

        self.server = http.server.ThreadingHTTPServer((address, port), Handler)
        self.port = self.server.server_port
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def stop(self) -> None:
        self.server.shutdown()
        self.server.server_close()


@unittest.skipUnless(os.access(HAPROXY, os.X_OK), "there is no haproxy: deploy/setup --cluster installs it")
class GatewayTest(unittest.TestCase):
    folder: ClassVar[pathlib.Path]
    names: ClassVar[Names]
    pods: ClassVar[dict[str, Pod]]
    port: ClassVar[int]
    command: ClassVar[list[str]]
    variables: ClassVar[dict[str, str]]

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="curvecast-gateway-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.names = Names()
        cls.addClassCleanup(cls.names.close)
        cls.pods = {}
        cls.addClassCleanup(cls.stop_all)
        outcome = helm_chart.template({"openToAll": True, "replicas": REPLICAS})
        objects = outcome.objects()
        cls.port = 0
        for number in range(REPLICAS):
            cls.start(number, f"127.0.7.{number + 1}")
        data = find(objects, "ConfigMap")["data"]
        (cls.folder / "haproxy.cfg").write_text(data["haproxy.cfg"])
        # What the cluster has at ports and at a name server of its own.
        replicas = data["replicas.cfg"].replace("parse-resolv-conf", f"nameserver test 127.0.0.1:{cls.names.port}")
        replicas = re.sub(r":(50051|8080)\b|(?<=port )9464", lambda match: f":{cls.port}" if match[1] else f"{cls.port}", replicas)
        (cls.folder / "replicas.cfg").write_text(replicas)
        gateway = find(objects, "Deployment")
        cls.command = [HAPROXY, *container(gateway)["command"][1:]]
        cls.variables = environment(gateway)

    @classmethod
    def start(cls, number: int, address: str) -> None:
        """A pod, at all its ports at once."""
        name = f"curvecast-{number}"
        cls.pods[name] = Pod(name, address, cls.port)
        cls.port = cls.pods[name].port
        cls.names.addresses[f"{name}.curvecast-servers.{NAMESPACE}.svc.cluster.local"] = address

    @classmethod
    def stop_all(cls) -> None:
        for pod in cls.pods.values():
            pod.stop()

    def gateway(self, name: str) -> tuple[str, str]:
        """Runs one. Addresses of pages and of its metrics."""
        ports = []
        for _ in range(3):
            with socket.create_server(("127.0.0.1", 0)) as taken:
                ports.append(f"127.0.0.1:{taken.getsockname()[1]}")
        where = {"EDGE_GRPC": ports[0], "EDGE_HTTP": ports[1], "EDGE_ADMIN": ports[2], "EDGE_SOCKET": f"{self.folder}/{name}.sock"}
        command = ["setpriv", "--pdeathsig", "TERM", *(part.replace("/etc/curvecast", str(self.folder)) for part in self.command)]
        log = (self.folder / f"{name}.log").open("w")
        process = subprocess.Popen(command, env={**self.variables, **where}, stdout=log, stderr=log)
        self.addCleanup(log.close)
        self.addCleanup(process.wait, 60)
        self.addCleanup(process.terminate)
        return ports[1], ports[2]

    def wait_for(self, admin: str, count: int) -> None:
        """Until so many servers have their full weight, in both backends."""
        full = re.compile(r'^haproxy_server_weight\{proxy="(?:grpc|http)",server="[\w-]+"\} 100$', re.MULTILINE)
        up = re.compile(r'^haproxy_server_status\{proxy="(?:grpc|http)",server="[\w-]+",state="UP"\} 1$', re.MULTILINE)
        for _ in eventually():
            try:
                text = get(admin, "/metrics")[0]
            except OSError:
                continue  # not yet
            if len(up.findall(text)) == 2 * count and len(full.findall(text)) >= 2 * count:
                return

    def test_keys_have_their_servers_at_every_gateway_and_for_good(self) -> None:
        first, first_admin = self.gateway("first")
        second, second_admin = self.gateway("second")
        for admin in (first_admin, second_admin):
            self.wait_for(admin, REPLICAS)
        place = {key: get(first, f"/v1/socket?key={key}")[1] for key in KEYS}
        self.assertEqual(set(place.values()), set(self.pods))
        for key in KEYS:
            text, replica = get(second, f"/v1/socket?key={key}")
            self.assertEqual(replica, place[key])
            self.assertTrue(text.startswith(f"{replica} at "), text)

        # A pod goes, others take its keys and keep theirs; it comes again at another address.
        gone = "curvecast-1"
        self.pods.pop(gone).stop()
        del self.names.addresses[f"{gone}.curvecast-servers.{NAMESPACE}.svc.cluster.local"]
        self.wait_for(first_admin, REPLICAS - 1)
        for key in KEYS:
            replica = get(first, f"/v1/socket?key={key}")[1]
            self.assertEqual(replica == place[key], place[key] != gone, key)
        self.start(1, "127.0.7.77")
        self.wait_for(first_admin, REPLICAS)
        for key in KEYS:
            text, replica = get(first, f"/v1/socket?key={key}")
            self.assertEqual(replica, place[key])
            self.assertEqual("127.0.7.77" in text, replica == gone)

    def test_the_gateway_is_ready_when_a_server_is(self) -> None:
        kept = dict(self.names.addresses)
        self.names.addresses.clear()
        self.addCleanup(self.names.addresses.update, kept)
        _, admin = self.gateway("alone")
        for _ in eventually():
            try:
                self.assertEqual(status(admin, "/healthz"), 503)
                break
            except OSError:
                continue  # not yet
        self.names.addresses.update(kept)
        for _ in eventually():
            if status(admin, "/healthz") == 200:
                break


def ask(address: str, path: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection(address, timeout=10)
    connection.request("GET", path, headers={"connection": "close"})
    return connection.getresponse()


def get(address: str, path: str) -> tuple[str, str]:
    """The text, and who has given it."""
    with ask(address, path) as response:
        if response.status != 200:
            raise AssertionError(f"{path}: {response.status}")
        return response.read().decode(), response.getheader("curvecast-replica", "")


def status(address: str, path: str) -> int:
    with ask(address, path) as response:
        return response.status


if __name__ == "__main__":
    unittest.main()
