"""What `curvecast serve` makes of its environment."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Mapping


def setting_name(variable: str) -> str:
    """CURVECAST_MAX_UPLOAD stands for max-upload."""
    return variable.removeprefix("CURVECAST_").lower().replace("_", "-")


def settings(command: str, variables: Mapping[str, str]) -> dict[str, str]:
    """What `serve` takes from the environment, and what it has else."""
    done = subprocess.run([command, "serve", "--print-config"], env=variables, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    found = dict(re.findall(r"^([a-z-]+)=(.*)$", done.stdout, re.MULTILINE))
    return {name: re.sub(r'^\["|"\]$|^"|"$', "", value).replace('", "', ";") for name, value in found.items()}


def expected(value: str) -> str:
    """As the server prints it."""
    if size := re.fullmatch(r"(\d+)([KMGT])B", value):
        return str(int(size[1]) * 1024 ** ("KMGT".index(size[2]) + 1))
    return value
