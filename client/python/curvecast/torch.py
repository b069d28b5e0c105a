# SPDX-License-Identifier: Apache-2.0
"""Meshes as a data set of PyTorch, which this module alone needs."""

from __future__ import annotations

import hashlib
import os
import pathlib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import torch
from torch.utils.data import Dataset, IterableDataset, get_worker_info

from curvecast.surface import read
from curvecast.training import training_set

Sample = dict[str, Any]


class MeshPoints(Dataset[Sample]):
    """Training sets of mesh files: MeshPoints(paths, uniform=2048, near=4096)[i] is a dict of tensors, as TrainingSet.arrays()
    names them, with "path" and "index". Works with any sampler, and with workers of a DataLoader, each of which prepares the meshes
    that come to it."""

    def __init__(
        self,
        paths: Sequence[str | os.PathLike[str]],
        *,
        seed: int = 0,
        cache: str | os.PathLike[str] | None = None,
        threads: int = 1,
        **numbers: Any,
    ) -> None:
        """numbers: of training_set(). seed: of epoch 0; see set_epoch(). cache: a folder in which sets are kept as .npz, so that a
        mesh is prepared once for each epoch's seed; None: nowhere. threads: of each worker, 0 = one a core."""
        self.paths = [pathlib.Path(path) for path in paths]
        self.seed = seed
        self.epoch = 0
        self.cache = None if cache is None else pathlib.Path(cache)
        self.threads = threads
        self.numbers = numbers

    def set_epoch(self, epoch: int) -> None:
        """Gives the meshes other points: those of another seed. Call it before the epoch's workers start."""
        self.epoch = epoch

    def __len__(self) -> int:
        return len(self.paths)

    def __getitem__(self, index: int) -> Sample:
        path = self.paths[index]
        arrays = self._cached(path)
        tensors: Sample = {name: torch.from_numpy(column) for name, column in arrays.items() if column.dtype != np.uint32}
        # PyTorch indexes by signed integers.
        tensors |= {name: torch.from_numpy(column.astype(np.int64)) for name, column in arrays.items() if column.dtype == np.uint32}
        return tensors | {"path": str(path), "index": index}

    def _cached(self, path: pathlib.Path) -> dict[str, Any]:
        if self.cache is None:
            return self._made(path)
        status = path.stat()
        key = repr((str(path.resolve()), status.st_size, status.st_mtime_ns, self.seed, self.epoch, sorted(self.numbers.items())))
        kept = self.cache / f"{path.stem}-{hashlib.sha256(key.encode()).hexdigest()[:16]}.npz"
        if kept.exists():
            with np.load(kept) as arrays:
                return dict(arrays)
        arrays = self._made(path)
        self.cache.mkdir(parents=True, exist_ok=True)
        part = kept.with_suffix(f".{os.getpid()}.part")
        with part.open("wb") as file:
            np.savez(file, **arrays)
        part.replace(kept)
        return arrays

    def _made(self, path: pathlib.Path) -> dict[str, Any]:
        seed = self.seed + self.epoch
        return training_set(read(path, prepare=False, threads=self.threads), seed=seed, **self.numbers).arrays()


class ShardedMeshPoints(IterableDataset[Sample]):
    """The same, each mesh once an epoch, in an order by the seed: shard i of n for process i of n (distributed training), and
    within it one mesh after the other for each worker."""

    def __init__(self, data: MeshPoints, shard: int = 0, shards: int = 1) -> None:
        if not 0 <= shard < shards:
            raise ValueError(f"shard is {shard} of {shards}")
        self.data = data
        self.shard = shard
        self.shards = shards

    def __iter__(self) -> Iterator[Sample]:
        worker = get_worker_info()
        first, step = (0, 1) if worker is None else (worker.id, worker.num_workers)
        order = np.random.default_rng([self.data.seed, self.data.epoch]).permutation(len(self.data))
        for index in order[self.shard :: self.shards][first::step]:
            yield self.data[int(index)]
