# SPDX-License-Identifier: Apache-2.0
"""What pyproject.toml cannot say: that the wheel holds modules that were compiled before."""

import pathlib

import setuptools

MODULES = [path.name for path in pathlib.Path(__file__).parent.joinpath("curvecast").glob("*.so")]


class BinaryDistribution(setuptools.Distribution):
    """A wheel for this platform, where it has modules."""

    def has_ext_modules(self) -> bool:
        return bool(MODULES)


# Modules with the stable ABI of nanobind serve Python 3.12 and all that follow; those without it one version.
is_stable = bool(MODULES) and all(name.endswith(".abi3.so") for name in MODULES)
tag = "cp312" if any(name.startswith("_native") for name in MODULES) else "cp310"
setuptools.setup(distclass=BinaryDistribution, options={"bdist_wheel": {"py_limited_api": tag}} if is_stable else {})
