"""Requests that nobody means: messages of every call with absurd values in their fields, and bytes that are hardly messages."""

from __future__ import annotations

import random
import warnings
from collections.abc import Sequence
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.message import DecodeError, Message

from curvecast.v1 import curvecast_pb2 as v1

METHODS = {method.name: method for method in v1.DESCRIPTOR.services_by_name["CurvecastService"].methods}
MAX_DEPTH, MAX_REPEATED = 6, 5
SPECIAL = (
    "",
    "0" * 32,
    "\0",
    "../../etc/passwd",
    "/dev/zero",
    "a" * 70_000,
    "\u202e\U0001f600",
    "%s%n",
    "x^x^x^x^x",
    "1/0",
    "ball.off",
)
FLOATS = (0.0, -0.0, 1.0, -1.0, 1e-308, 1e308, -1e308, float("inf"), float("-inf"), float("nan"), 0.5, 45.0, 180.0)
WHOLE = (0, 1, 2, 3, 63, 64, 255, 1000, 65_536, 4_000_000, 4_000_001, 1 << 30)
WIDE = (1 << 31, (1 << 32) - 1, 1 << 53, (1 << 63) - 1)

# What an absurd request may cost where the server takes it: the scenario of memory has those that cost too much.
MOST_POINTS, MOST_NEIGHBOURS, MOST_VERTICES, MOST_PIXELS, MOST_SAMPLES, MOST_RELAXATIONS = 5000, 300, 20_000, 256, 1000, 2


class Absurdity:
    """Makes requests. `meshes`, `sessions`: ids that there are, so that requests get further than that."""

    def __init__(self, chance: random.Random, meshes: Sequence[str], sessions: Sequence[str]) -> None:
        self._chance, self.meshes, self.sessions = chance, meshes, sessions

    def request(self, method: str) -> bytes:
        """A request of a call: of several messages of one, the next."""
        descriptor = METHODS[method].input_type
        message = self._message(descriptor, 0)
        tame(message)
        data = message.SerializeToString()
        if self._chance.random() < 0.5:
            return data
        mutated = self._mutate(data)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                parsed: Message = getattr(v1, descriptor.name).FromString(mutated)
        except DecodeError:
            return mutated
        return mutated if not tame(parsed) else parsed.SerializeToString()

    def _message(self, descriptor: Descriptor, depth: int) -> Message:
        message: Message = getattr(v1, descriptor.full_name.removeprefix("curvecast.v1."))()
        for field in descriptor.fields:
            if self._chance.random() < (0.35 if depth else 0.15) or (field.message_type is not None and depth >= MAX_DEPTH):
                continue
            if field.message_type is not None and field.message_type.GetOptions().map_entry:
                for _ in range(self._chance.randrange(MAX_REPEATED)):
                    getattr(message, field.name)[self._text()] = self._text()
            elif field.label == FieldDescriptor.LABEL_REPEATED:
                values = [self._value(field, depth) for _ in range(self._chance.randrange(MAX_REPEATED))]
                getattr(message, field.name).extend(values)
            elif field.message_type is not None:
                getattr(message, field.name).CopyFrom(self._value(field, depth))
            else:
                setattr(message, field.name, self._value(field, depth))
        return message

    def _value(self, field: FieldDescriptor, depth: int) -> Any:
        kind, pick = field.cpp_type, self._chance.choice
        if kind == FieldDescriptor.CPPTYPE_MESSAGE:
            return self._message(field.message_type, depth + 1)
        if field.type == FieldDescriptor.TYPE_BYTES:
            return self._chance.randbytes(self._chance.randrange(300))
        if kind == FieldDescriptor.CPPTYPE_STRING:
            return self._id(field) if field.name.endswith("_id") and self._chance.random() < 0.9 else self._text()
        if kind == FieldDescriptor.CPPTYPE_ENUM:
            return pick([*(value.number for value in field.enum_type.values), 1000])
        if kind in (FieldDescriptor.CPPTYPE_DOUBLE, FieldDescriptor.CPPTYPE_FLOAT):
            return pick(FLOATS) if self._chance.random() < 0.7 else self._chance.gauss(0, 3)
        is_wide = kind in (FieldDescriptor.CPPTYPE_UINT64, FieldDescriptor.CPPTYPE_INT64)
        is_flag = kind == FieldDescriptor.CPPTYPE_BOOL
        return pick((False, True) if is_flag else WHOLE + WIDE if is_wide else WHOLE)

    def _id(self, field: FieldDescriptor) -> str:
        """One that there is, but of a session seldom where the call ends it."""
        if field.name != "session_id":
            return self.meshes[0]
        is_rare = field.containing_type.name == "CloseSessionRequest" and self._chance.random() < 0.9
        return "0" * 32 if is_rare else self._chance.choice(self.sessions)

    def _text(self) -> str:
        return self._chance.choice((*self.meshes, *self.sessions) if self._chance.random() < 0.5 else SPECIAL)

    def _mutate(self, data: bytes) -> bytes:
        out = bytearray(data)
        for _ in range(self._chance.randrange(1, 6)):
            at = self._chance.randrange(len(out) + 1)
            match self._chance.randrange(5):
                case 0 if at < len(out):
                    out[at] ^= 1 << self._chance.randrange(8)
                case 1:
                    out[at:at] = self._chance.randbytes(self._chance.randrange(1, 20))
                case 2:
                    del out[at : at + self._chance.randrange(1, 20)]
                case 3:
                    out[at:at] = out[: self._chance.randrange(len(out) + 1)][:10_000]
                case _:
                    del out[at:]
        return bytes(out)


def tame(message: Any) -> bool:
    """Lessens what would take minutes and be no fault of the server's. Tells whether it changed anything."""
    before = message.SerializeToString()
    name = message.DESCRIPTOR.name
    if name == "CreateSessionRequest":
        tame_options(message.options)
        message.without_preview = True
    elif name == "MeasureRequest":
        message.ring_seeds, message.ball_centres = least(message.ring_seeds, 100), least(message.ball_centres, 100)
        message.distance_samples = least(message.distance_samples, MOST_SAMPLES)
    elif name == "RenderRequest":
        message.width, message.height = least(message.width, MOST_PIXELS), least(message.height, MOST_PIXELS)
    elif name == "RemeshRequest" and message.relaxations <= 100:
        message.relaxations = min(message.relaxations, MOST_RELAXATIONS)
    sample = message
    for step in {"StreamViewsRequest": ("view", "sample")}.get(name, ("sample",)):
        if step not in sample.DESCRIPTOR.fields_by_name or not sample.HasField(step):
            return bool(before != message.SerializeToString())
        sample = getattr(sample, step)
    tame_sample(sample, MOST_NEIGHBOURS if name in ("FindNeighboursRequest", "RemeshRequest") else MOST_POINTS)
    return bool(before != message.SerializeToString())


def tame_options(options: v1.SessionOptions) -> None:
    omega = options.omega if 1 <= options.omega <= 1000 else 10
    if (options.max_points or 65_536) * omega > MOST_VERTICES and options.max_points <= 4_000_000:
        options.max_points = max(1, int(MOST_VERTICES / omega))


def tame_sample(sample: v1.SampleRequest, most: int) -> None:
    budget = sample.WhichOneof("budget")
    if budget == "points" and sample.points <= 4_000_000:
        sample.points = min(sample.points, most)
    elif budget in ("pixel_error", "max_bytes", "automatic") or (budget is None and most):
        sample.points = most  # up to four million else


def least(value: int, most: int) -> int:
    """0, which stands for a default, becomes the most."""
    return min(value, most) or most
