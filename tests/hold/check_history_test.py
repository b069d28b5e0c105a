"""The checker finds what is planted: histories that are well, each doctored in one place."""

import io
import json
import pathlib
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout
from typing import Any

from hold import check_history
from hold.check_history import Event, Result


class Story:
    """A history, told in order. Every call takes a tenth of a second, unless it says otherwise."""

    def __init__(self) -> None:
        self.now = 0.0
        self.events: list[Event] = []

    def serve(self, server: str = "a", **settings: Any) -> None:
        self.events.append({"kind": "serve", "server": server, "store": "cache", "at": self.now, **settings})

    def end(self, how: str, server: str = "a") -> None:
        self.events.append({"kind": "end", "server": server, "at": self.now, "how": how})

    def damage(self, session: str = "s") -> None:
        self.events.append({"kind": "damage", "store": "cache", "session": session, "at": self.now})
        self.now += 0.1

    def fault(self, seconds: float, server: str = "a") -> None:
        self.events.append({"kind": "fault", "server": server, "begin": self.now, "end": self.now + seconds})

    def call(self, call: str, code: str = "OK", server: str = "a", caller: str = "anna", **fields: Any) -> None:
        begin = fields.pop("begin", self.now)
        end = fields.pop("end", begin + 0.1)
        self.events.append(
            {"kind": "call", "client": "c", "call": call, "code": code, "server": server, "caller": caller}
            | {"begin": begin, "end": end}
            | fields
        )
        self.now = max(self.now, end + 0.1)

    def create(self, session: str = "s", **fields: Any) -> None:
        self.call("CreateSession", session=session, mesh="m", **fields)

    def sample(self, digest: str, code: str = "OK", **fields: Any) -> None:
        told: dict[str, Any] = {"digest": digest, "vertices": 100, "request": "q", **fields}
        self.call("Resample", code, session="s", **told)

    def check(self) -> Result:
        return check_history.check(lambda: self.events)


class CheckerTest(unittest.TestCase):
    def setUp(self) -> None:
        self.story = Story()

    def assert_well(self, *judged: str) -> None:
        result = self.story.check()
        self.assertEqual(result.violations, [])
        for rule in judged:
            self.assertIn(rule, result.judged)

    def assert_found(self, rule: str, why: str = "") -> None:
        result = self.story.check()
        self.assertEqual([violation.rule for violation in result.violations], [rule], result.violations)
        self.assertIn(why, result.violations[0].why)

    # -------------------------------------------------------------------------------------------------------------- points

    def test_points_are_those_of_the_reference(self) -> None:
        self.story.serve()
        self.story.sample("right")
        self.story.serve("calm", reference=True)  # also where the reference comes later
        self.story.sample("right", server="calm")
        self.assert_well("points by reference")
        self.story.sample("wrong")
        self.assert_found("points", "right")

    def test_points_without_a_reference_are_always_the_same(self) -> None:
        self.story.serve()
        self.story.sample("one")
        self.story.sample("two", request="another view")
        self.story.sample("three", vertices=200)  # a finer curve
        self.story.sample("part", settled=False)
        self.story.sample("", code="NOT_FOUND")
        self.assert_well("points by each other")
        self.story.sample("four")
        self.assert_found("points", "one")

    # ------------------------------------------------------------------------------------------------------------- uploads

    def test_a_mesh_that_was_acknowledged_is_there(self) -> None:
        self.story.serve()
        self.story.call("GetMesh", "NOT_FOUND", mesh="m")
        self.story.call("UploadMesh", mesh="m", size=10)
        self.story.call("GetMesh", mesh="m")
        self.assert_well("uploads")
        self.story.call("CreateSession", "NOT_FOUND", mesh="m")
        self.assert_found("uploads", "acknowledged")

    def test_an_upload_that_was_not_acknowledged_may_be_lost(self) -> None:
        self.story.serve()
        self.story.call("UploadMesh", "RESOURCE_EXHAUSTED", mesh="m", size=10)
        self.story.call("GetMesh", "NOT_FOUND", mesh="m")
        self.assert_well()

    def test_a_stated_limit_may_cost_a_mesh(self) -> None:
        for limit, rule in ((15, None), (20, "uploads")):
            self.story = Story()
            self.story.serve(mesh_limit=limit)
            self.story.call("UploadMesh", mesh="m", size=10)
            self.story.call("UploadMesh", mesh="n", size=10)
            self.story.call("GetMesh", "NOT_FOUND", mesh="m")
            self.assert_well() if rule is None else self.assert_found(rule)

    def test_uploads_outlive_a_server_that_says_so(self) -> None:
        for keeps, rule in ((False, None), (True, "uploads")):
            self.story = Story()
            self.story.serve(keeps_uploads=keeps)
            self.story.call("UploadMesh", mesh="m", size=10)
            self.story.end("killed")
            self.story.now += 1
            self.story.serve(keeps_uploads=keeps)
            self.story.call("GetMesh", "NOT_FOUND", mesh="m")
            self.assert_well() if rule is None else self.assert_found(rule)

    # ------------------------------------------------------------------------------------------------------------ sessions

    def tell_of_cached_session(self) -> None:
        self.story.serve()
        self.story.create(made=True)
        self.story.call("GetSession", session="s", cached=True)

    def test_a_cached_session_outlives_its_server(self) -> None:
        self.tell_of_cached_session()
        self.story.end("killed")
        self.story.serve()
        self.story.sample("right")
        self.assert_well("cached")
        self.story.sample("", "NOT_FOUND")
        self.assert_found("cached")

    def test_a_session_that_nobody_called_cached_may_be_lost(self) -> None:
        self.story.serve()
        self.story.create(made=True)
        self.story.end("killed")
        self.story.serve()
        self.story.sample("", "NOT_FOUND")
        self.assert_well()

    def test_a_cached_session_may_be_closed(self) -> None:
        self.tell_of_cached_session()
        self.story.call("CloseSession", session="s")
        self.story.sample("", "NOT_FOUND")
        self.assert_well()

    def test_a_close_whose_outcome_nobody_knows_may_have_closed(self) -> None:
        for code in ("NOT_FOUND", "OK"):
            self.story = Story()
            self.tell_of_cached_session()
            self.story.end("killed")
            self.story.call("CloseSession", "UNAVAILABLE", session="s")
            self.story.now += 10
            self.story.serve()
            self.story.call("GetSession", code, session="s")
            self.assert_well()

    def test_a_close_that_was_refused_closes_nothing(self) -> None:
        self.tell_of_cached_session()
        self.story.call("CloseSession", "PERMISSION_DENIED", session="s")
        self.story.call("GetSession", "NOT_FOUND", session="s")
        self.assert_found("cached")

    def test_a_spoilt_session_may_be_lost_until_it_is_made_anew(self) -> None:
        self.tell_of_cached_session()
        self.story.damage()
        self.story.call("GetSession", session="s", cached=True)  # from memory
        self.story.sample("", "NOT_FOUND")
        self.assert_well()
        self.story.create(made=True)
        self.story.call("GetSession", session="s", cached=True)
        self.story.sample("", "NOT_FOUND")
        self.assert_found("cached")

    def test_what_is_closed_is_gone_everywhere(self) -> None:
        self.tell_of_cached_session()
        self.story.serve("b")
        self.story.call("CloseSession", session="s")
        self.story.sample("right", server="b")  # within the second
        self.story.now += 2
        self.story.call("GetSession", "NOT_FOUND", session="s")
        self.story.sample("right", server="b", opened=0.5)  # a stream that was opened before goes on
        self.assert_well("closed")
        self.story.sample("right", server="b")
        self.assert_found("closed")

    def test_what_is_closed_may_be_made_anew(self) -> None:
        self.tell_of_cached_session()
        self.story.call("CloseSession", session="s")
        self.story.now += 2
        self.story.create()
        self.story.sample("right")
        self.assert_well()

    # -------------------------------------------------------------------------------------------------------------- owners

    def test_a_session_is_its_makers_to_change(self) -> None:
        for call in ("CloseSession", "UpdateSession"):
            self.story = Story()
            self.story.serve(tokens=True)
            self.story.create()
            self.story.create(caller="bert")  # who joins owns nothing
            self.story.call(call, "PERMISSION_DENIED", session="s", caller="bert")
            self.assert_well("owners")
            self.story.call(call, session="s", caller="bert")
            self.assert_found("owners", "anna")
            self.story.events.pop()
            self.story.call(call, "PERMISSION_DENIED", session="s")
            self.assert_found("owners", "his own")

    def test_of_two_who_make_it_at_once_either_may_own_it(self) -> None:
        self.story.serve(tokens=True)
        self.story.create(begin=1.0, end=2.0)
        self.story.create(begin=1.5, end=2.5, caller="bert")
        self.story.call("CloseSession", session="s", caller="bert")
        self.assert_well("owners")
        self.story.create(caller="carl")  # a session of his
        self.story.call("CloseSession", session="s", caller="bert")
        self.assert_found("owners", "carl")

    def test_without_tokens_everybody_may(self) -> None:
        self.story.serve()
        self.story.create()
        self.story.call("CloseSession", session="s", caller="bert")
        self.assert_well()

    def test_where_callers_are_apart_nothing_is_anothers(self) -> None:
        self.story.serve(tokens=True, apart=True)
        self.story.call("UploadMesh", mesh="m", size=10)
        self.story.create()
        self.story.call("GetSession", session="s", cached=True)
        for call in ("GetSession", "Resample", "CloseSession"):
            self.story.call(call, "NOT_FOUND", session="s", caller="bert")
        self.story.call("GetMesh", "NOT_FOUND", mesh="m", caller="bert")
        self.story.call("GetSession", session="s")
        self.assert_well("apart", "cached")
        for code in ("OK", "PERMISSION_DENIED"):
            self.story.call("GetSession", code, session="s", caller="bert")
            self.assert_found("apart", "another's")
            self.story.events.pop()
        self.story.call("GetMesh", mesh="m", caller="bert")
        self.assert_found("apart", "not sent")
        self.story.events.pop()
        self.story.call("GetMesh", "NOT_FOUND", mesh="m")
        self.assert_found("uploads", "acknowledged")
        self.story.events.pop()
        self.story.call("GetSession", "NOT_FOUND", session="s")
        self.assert_found("cached", "reported")

    def test_nobody_gets_in_without_a_credential(self) -> None:
        self.story.serve(tokens=True)
        self.story.call("ListSessions", "UNAUTHENTICATED", credential="expired")
        self.story.call("ListSessions", "UNAVAILABLE", credential="another authority's certificate")
        self.story.call("ListSessions", credential="valid")
        self.assert_well("credentials")
        for code in ("OK", "NOT_FOUND", "INVALID_ARGUMENT", "PERMISSION_DENIED"):
            self.story.call("ListSessions", code, credential="expired")
            self.assert_found("credentials", "expired")
            self.story.events.pop()
        self.story.call("ListSessions", "UNAUTHENTICATED", credential="valid")
        self.assert_found("credentials", "valid")

    # ------------------------------------------------------------------------------------------------------------- answers

    def test_calls_fail_only_where_the_server_is_down(self) -> None:
        self.story.serve()
        self.story.call("ListSessions", "UNAVAILABLE", begin=1, end=3)
        self.story.events[-1:-1] = [{"kind": "end", "server": "a", "at": 2, "how": "killed"}]
        self.story.call("ListSessions", "UNAVAILABLE")
        self.story.serve()
        self.story.now += 1
        self.story.fault(10)
        self.story.call("ListSessions", "DEADLINE_EXCEEDED", end=self.story.now + 5)
        self.story.now += 10
        self.assert_well("answers")
        self.story.call("ListSessions", "UNAVAILABLE")
        self.assert_found("answers", "was up")

    def test_a_server_that_ends_before_it_is_ready_changes_nothing(self) -> None:
        self.story.serve()
        self.story.end("killed")
        self.story.call("ListSessions", "UNAVAILABLE")
        self.story.end("killed")
        self.assert_well("answers")

    def test_every_call_ends(self) -> None:
        self.story.serve()
        self.story.call("Render", "DEADLINE_EXCEEDED", end=100)
        self.assert_found("answers", "never ended")

    def test_no_server_ends_by_itself(self) -> None:
        self.story.serve()
        self.story.end("crashed")
        self.assert_found("answers", "by itself")

    def test_no_error_is_without_a_name(self) -> None:
        self.story.serve()
        self.story.call("Render", "UNKNOWN")
        self.assert_found("answers")

    def test_a_proxy_may_lose_an_answer_while_it_has_no_server(self) -> None:
        self.story.serve("edge", is_proxy=True)
        self.story.fault(10, "edge")
        self.story.call("Render", "UNKNOWN", "edge", message=check_history.REMOVED)
        self.assert_well("answers")
        self.story.now += 10
        self.story.call("Render", "UNKNOWN", "edge", message=check_history.REMOVED)
        self.assert_found("answers", "was up")

    def test_no_server_loses_an_answer(self) -> None:
        self.story.serve()
        self.story.fault(10)
        self.story.call("Render", "UNKNOWN", message=check_history.REMOVED)
        self.assert_found("answers", "does not have")


class ProgramTest(unittest.TestCase):
    def run_on(self, text: str) -> tuple[int, str]:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "kills", "history.jsonl")
            path.parent.mkdir()
            path.write_text(text)
            out, err = io.StringIO(), io.StringIO()
            with redirect_stdout(out), redirect_stderr(err):
                status = check_history.main([folder])
            return status, out.getvalue() + err.getvalue()

    def test_says_what_it_found(self) -> None:
        story = Story()
        story.serve()
        story.call("ListSessions")
        self.assertEqual(self.run_on("".join(json.dumps(event) + "\n" for event in story.events))[0], 0)
        story.end("crashed")
        status, output = self.run_on("".join(json.dumps(event) + "\n" for event in story.events))
        self.assertEqual(status, 1)
        self.assertIn("3 events", output)
        self.assertIn("ended by itself", output)

    def test_names_the_line_that_is_none(self) -> None:
        for line in ("{", "[]", '{"kind": "guess"}', "{}"):
            status, output = self.run_on('{"kind": "fault", "server": "a", "begin": 1, "end": 2}\n' + line + "\n")
            self.assertEqual(status, 3)
            self.assertIn("history.jsonl:2", output)

    def test_needs_a_history(self) -> None:
        with redirect_stderr(io.StringIO()), redirect_stdout(io.StringIO()):
            self.assertEqual(check_history.main(["/nonexistent"]), 3)
            self.assertEqual(check_history.main([]), 2)
            self.assertEqual(check_history.main(["--help"]), 0)


if __name__ == "__main__":
    unittest.main()
