"""Certificates of two authorities, of which the server trusts one."""

from __future__ import annotations

import pathlib
import subprocess
from typing import NamedTuple

import grpc

CURVE = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")


class Pair(NamedTuple):
    chain: pathlib.Path
    key: pathlib.Path


class Certificates:
    """In a folder; made by openssl, for two days."""

    def __init__(self, folder: pathlib.Path) -> None:
        self._folder = folder / "certificates"
        self._folder.mkdir()
        self.authority, self.other = self._make_authority("authority"), self._make_authority("other")
        self.server = self._make("server", self.authority)
        self.client = self._make("client", self.authority)
        self.stranger = self._make("stranger", self.other)

    def credentials(self, client: Pair | None = None) -> grpc.ChannelCredentials:
        """Of a client that trusts the server, and shows `client`."""
        pair = (client.key.read_bytes(), client.chain.read_bytes()) if client is not None else (None, None)
        return grpc.ssl_channel_credentials(self.authority.chain.read_bytes(), *pair)

    def _pair(self, name: str) -> Pair:
        return Pair(self._folder / f"{name}.pem", self._folder / f"{name}.key")

    def _make_authority(self, name: str) -> Pair:
        pair = self._pair(name)
        openssl("req", "-x509", "-days", "2", "-subj", f"/CN={name}", *CURVE, "-keyout", str(pair.key), "-out", str(pair.chain))
        return pair

    def _make(self, name: str, authority: Pair) -> Pair:
        pair, request, names = self._pair(name), self._folder / "request.pem", self._folder / "names"
        names.write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
        openssl("req", "-subj", f"/CN={name}", *CURVE, "-keyout", str(pair.key), "-out", str(request))
        sign = ("-CA", str(authority.chain), "-CAkey", str(authority.key), "-CAcreateserial", "-extfile", str(names))
        openssl("x509", "-req", "-days", "2", "-in", str(request), *sign, "-out", str(pair.chain))
        return pair


def openssl(*arguments: str) -> None:
    subprocess.run(["openssl", *arguments], check=True, capture_output=True)
