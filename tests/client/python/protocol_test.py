"""What the comments of the .proto files say, beside the numbers that programs have."""

import json
import os
import pathlib
import re
import unittest

from curvecast import protocol

SOURCE = pathlib.Path(os.environ["CURVECAST_SOURCE"])
PROTO = SOURCE / "proto" / "curvecast" / "v1"


class ProtocolTest(unittest.TestCase):
    def setUp(self) -> None:
        self.numbers: dict[str, int] = json.loads((SOURCE / "tests" / "client" / "protocol.json").read_text())

    def test_the_shared_numbers_are_those_of_the_table(self) -> None:
        text = (PROTO / "curvecast.proto").read_text()
        table = {
            name: int(number.replace(",", "")) for name, number in re.findall(r"^//   ([A-Z_]+) +([\d,]+) ", text, re.MULTILINE)
        }
        self.assertEqual(self.numbers, table)

    def test_comments_name_numbers_of_the_table_only(self) -> None:
        codes = {"INVALID_ARGUMENT", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION", "PERMISSION_DENIED", "NOT_FOUND", "OUT_OF_RANGE"}
        for path in PROTO.glob("*.proto"):
            comments = "\n".join(line.partition("//")[2] for line in path.read_text().splitlines())
            names = set(re.findall(r"\b[A-Z]+(?:_[A-Z]+)+\b", comments)) - codes
            self.assertLessEqual({name for name in names if not name.startswith("FRAME_KIND_")}, set(self.numbers), path.name)

    def test_this_client_has_the_same_numbers(self) -> None:
        own = {name: value for name, value in vars(protocol).items() if name.isupper()}
        self.assertEqual(own, {name: self.numbers[name] for name in own})
        self.assertGreater(len(own), 0)

    def test_every_field_and_value_has_a_comment(self) -> None:
        declaration = re.compile(r"^ +(?:\w+ )?(?:[\w.]+|map<\w+, \w+>) \w+ = \d+;|^ +[A-Z][A-Z_0-9]+ = \d+;")
        found = 0
        for path in PROTO.glob("*.proto"):
            before = ""
            for line in path.read_text().splitlines():
                if match := declaration.match(line):
                    found += 1
                    is_said = line[match.end() :].lstrip().startswith("// ") or before.lstrip().startswith("// ")
                    self.assertTrue(is_said, f"{path.name}: {line.strip()}")
                before = line
        self.assertGreater(found, 300)


if __name__ == "__main__":
    unittest.main()
