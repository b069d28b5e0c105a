"""A real server, called by tools that know it by its reflection alone: grpcurl and ghz. deploy/check_grpc runs it."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
from typing import IO, Any, ClassVar, cast

SOURCE = pathlib.Path(os.environ.get("CURVECAST_SOURCE", pathlib.Path(__file__).parents[2]))
TOOLS = SOURCE / "build/tools"
SERVICE = "curvecast.v1.CurvecastService"
SECONDS = 120

Message = dict[str, Any]

#: An octahedron.
MESH = "\n".join(
    [*(f"v {x} {y} {z}" for x, y, z in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)))]
    + [f"f {i} {j} {k}" for i, j, k in ((1, 3, 5), (3, 2, 5), (2, 4, 5), (4, 1, 5), (3, 1, 6), (2, 3, 6), (4, 2, 6), (1, 4, 6))]
).encode()
MESH_ID = hashlib.sha256(MESH).hexdigest()[:32]

#: gRPC's C++ library serves it without a description.
HEALTH = """
syntax = "proto3";
package grpc.health.v1;
message HealthCheckRequest { string service = 1; }
message HealthCheckResponse {
  enum ServingStatus { UNKNOWN = 0; SERVING = 1; NOT_SERVING = 2; SERVICE_UNKNOWN = 3; }
  ServingStatus status = 1;
}
service Health { rpc Check(HealthCheckRequest) returns (HealthCheckResponse); }
"""


class GrpcTest(unittest.TestCase):
    address: ClassVar[str]
    session_id: ClassVar[str]
    health: ClassVar[pathlib.Path]

    @classmethod
    def setUpClass(cls) -> None:
        folder = pathlib.Path(tempfile.mkdtemp(prefix="curvecast-grpc-"))
        cls.addClassCleanup(shutil.rmtree, folder)
        cls.health = folder / "health.proto"
        cls.health.write_text(HEALTH)
        # It ends with this process, however that ends.
        command = ["setpriv", "--pdeathsig", "TERM", os.environ["CURVECAST_COMMAND"], "serve"]
        command += ["--listen", "127.0.0.1:0", "--http", "none", "--quiet"]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        output = cast(IO[str], server.stdout)
        cls.addClassCleanup(output.close)
        cls.addClassCleanup(cls.stop, server)
        line = output.readline()
        if not line.startswith("listening on "):
            raise AssertionError(f"the server did not start: {line!r}")
        cls.address = line.split()[-1]
        header = {"header": {"name": "octahedron.obj", "size": len(MESH), "mesh_id": MESH_ID}}
        (uploaded,) = call("UploadMesh", cls.address, header, {"chunk": base64.b64encode(MESH).decode()})
        if uploaded != {"mesh_id": MESH_ID, "size": str(len(MESH))}:
            raise AssertionError(uploaded)
        *progress, ready = call("CreateSession", cls.address, {"mesh_id": MESH_ID, "options": {"max_points": 10_000}})
        if not all("progress" in update for update in progress):
            raise AssertionError(progress)
        cls.session_id = ready["session"]["session_id"]

    @staticmethod
    def stop(server: subprocess.Popen[str]) -> None:
        server.terminate()
        if (status := server.wait(SECONDS)) != 0:
            raise AssertionError(f"the server ended with status {status}")

    # grpcurl

    def test_the_server_lists_what_it_has(self) -> None:
        services = grpcurl(self.address, "list").split()
        self.assertEqual([name for name in services if "reflection" not in name], [SERVICE, "grpc.health.v1.Health"])
        calls = re.findall(r"^  rpc (\w+)\(", (SOURCE / "proto/curvecast/v1/curvecast.proto").read_text(), re.MULTILINE)
        self.assertEqual(sorted(grpcurl(self.address, "list", SERVICE).split()), sorted(f"{SERVICE}.{name}" for name in calls))

    def test_the_server_describes_every_message(self) -> None:
        text = grpcurl(self.address, "describe", SERVICE)
        messages = set(re.findall(r"\.(curvecast\.v1\.\w+)", text))
        self.assertGreater(len(messages), 30)
        for message in sorted(messages):
            self.assertIn(f"{message} is a message:", grpcurl(self.address, "describe", message))

    def test_the_server_is_well(self) -> None:
        for service in ("", SERVICE):
            options = ("-import-path", str(self.health.parent), "-proto", self.health.name)
            text = grpcurl(*options, self.address, "grpc.health.v1.Health/Check", given=json.dumps({"service": service}))
            self.assertEqual(json.loads(text), {"status": "SERVING"})

    def test_a_mesh_is_inspected(self) -> None:
        (answer,) = call("InspectMesh", self.address, {"mesh_id": MESH_ID})
        self.assertEqual(answer["mesh"]["name"], "octahedron.obj")

    def test_a_view_is_answered(self) -> None:
        """Without acknowledgements, as the tool sends all it has at once: one frame, and the end."""
        answers = call("StreamViews", self.address, *self.conversation(2_000))
        self.assertEqual(answers[0]["frame"]["sequence"], "1")
        self.assertEqual(answers[0]["frame"]["held_points"], "2000")
        self.assertNotIn("error", answers[0]["frame"])

    def test_mistakes_have_codes(self) -> None:
        mistakes: dict[str, tuple[str, Message]] = {
            "NotFound": ("GetSession", {"session_id": "0" * 32}),
            "InvalidArgument": ("CreateSession", {"mesh_id": MESH_ID, "options": {"omega": 1001}}),
        }
        for code, (name, message) in mistakes.items():
            done = run("grpcurl", "-plaintext", "-d", json.dumps(message), self.address, f"{SERVICE}/{name}")
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(f"Code: {code}", done.stderr)

    # ghz

    def test_hundreds_of_calls_have_no_error(self) -> None:
        self.check_load(ghz(self.address, "grpc.health.v1.Health.Check", 500, {}, "--proto", str(self.health)), 500)
        calls: dict[str, Message] = {
            f"{SERVICE}.GetSession": {"session_id": self.session_id},
            f"{SERVICE}.GetMesh": {"mesh_id": MESH_ID},
            f"{SERVICE}.ListSessions": {},
        }
        for name, message in calls.items():
            self.check_load(ghz(self.address, name, 500, message), 500)

    def test_hundreds_of_point_sets_and_streams_have_no_error(self) -> None:
        sample = {"session_id": self.session_id, "sample": {"points": 1_000}}
        self.check_load(ghz(self.address, f"{SERVICE}.Resample", 200, sample), 200)
        self.check_load(ghz(self.address, f"{SERVICE}.StreamViews", 200, self.conversation(1_000)), 200)

    def test_errors_of_calls_would_be_counted(self) -> None:
        report = ghz(self.address, f"{SERVICE}.GetSession", 20, {"session_id": "0" * 32})
        self.assertEqual(report["statusCodeDistribution"], {"NotFound": 20})

    def check_load(self, report: Message, count: int) -> None:
        self.assertEqual(report["count"], count)
        self.assertEqual(report["statusCodeDistribution"], {"OK": count})
        self.assertFalse(report.get("errorDistribution"))
        name = report["options"]["call"].rpartition(".")[2]
        times = {each["percentage"]: each["latency"] / 1e6 for each in report["latencyDistribution"]}
        print(
            f"\n  ghz {name}: {count} calls, 0 errors, {report['rps']:.0f}/s, p50 {times[50]:.1f} ms, p99 {times[99]:.1f} ms",
            end=" ",
        )

    def conversation(self, points: int) -> list[Message]:
        return [{"open": {"session_id": self.session_id}}, {"view": {"sequence": 1, "sample": {"points": points}}}]


def run(tool: str, *arguments: str, given: str | None = None) -> subprocess.CompletedProcess[str]:
    command = [str(TOOLS / tool), *arguments]
    return subprocess.run(command, input=given, capture_output=True, text=True, timeout=SECONDS, check=False)


def grpcurl(*arguments: str, given: str | None = None) -> str:
    done = run("grpcurl", "-plaintext", "-max-time", "60", *(("-d", "@") if given is not None else ()), *arguments, given=given)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


def call(name: str, address: str, *messages: Message) -> list[Message]:
    """The answers of one call of ours."""
    text = grpcurl(address, f"{SERVICE}/{name}", given="\n".join(json.dumps(message) for message in messages))
    answers: list[Message] = []
    decoder = json.JSONDecoder()
    place = 0
    while place < len(text):
        answer, place = decoder.raw_decode(text, place)
        answers.append(answer)
        place += len(text[place:]) - len(text[place:].lstrip())
    return answers


def ghz(address: str, name: str, count: int, message: Message | list[Message], *more: str) -> Message:
    """What it reports of so many calls over four connections, eight at a time."""
    options = ["--insecure", "--format", "json", "--total", str(count), "--concurrency", "8", "--connections", "4"]
    done = run("ghz", *options, *more, "--timeout", "60s", "--call", name, "--data", json.dumps(message), address)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return dict(json.loads(done.stdout))


if __name__ == "__main__":
    unittest.main()
