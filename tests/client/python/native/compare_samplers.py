"""Point sets of many meshes by Curvecast and by what others use, on one core, in one run: how long they take and how even they are.

    compare_samplers.py [MESH...] [--meshes 1000] [--points 16384] [--measured 10] [--only NAME]... [--part 0.25]

Prints a table in Markdown; discrepancies are over those that random points are expected to have. Each mesh is deformed anew for
every run, so that nothing is prepared; of slow samplers fewer meshes are tried. `deploy/compare_samplers` installs what it takes;
programs that are not there are left out.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS", "TBB_NUM_THREADS"):
    os.environ[variable] = "1"
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

import numpy as np
from shapes import Floats, Ints, torus

import curvecast

Sampler = Callable[[Floats, Ints, int, int], Floats]


def ours_equalised(rounds: int) -> Sampler:
    def sample(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
        surface = curvecast.Surface(vertices, faces, threads=1)
        return surface.sample(points, seed=seed, relaxation_rounds=rounds).world_positions()

    return sample


def ours_scattered(rounds: int) -> Sampler:
    def sample(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
        scattered = curvecast.scatter(vertices, faces, points, seed=seed, relaxation_rounds=rounds, threads=1)
        return scattered.world_positions()

    return sample


def in_order(points: curvecast.Points) -> Floats:
    """Of which every prefix is a set."""
    assert points.ranks is not None
    ordered: Floats = points.world_positions()[np.argsort(points.ranks)]
    return ordered


def ours_nested(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
    options: dict[str, Any] = {"relaxation_rounds": 2, "attributes": ["rank"]}
    return in_order(curvecast.scatter(vertices, faces, points, seed=seed, threads=1, **options))


def ours_ranked(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
    surface = curvecast.Surface(vertices, faces, threads=1)
    return in_order(surface.sample(points, seed=seed, sampler="progressive", attributes=["rank"]))


def open3d_mesh(vertices: Floats, faces: Ints) -> Any:
    import open3d

    return open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(vertices), open3d.utility.Vector3iVector(faces))


def open3d_uniform(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
    import open3d

    open3d.utility.random.seed(seed)
    return np.asarray(open3d_mesh(vertices, faces).sample_points_uniformly(points).points)


def open3d_poisson(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
    import open3d

    open3d.utility.random.seed(seed)
    return np.asarray(open3d_mesh(vertices, faces).sample_points_poisson_disk(points, init_factor=5).points)


def trimesh_even(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
    import trimesh

    return np.asarray(trimesh.sample.sample_surface_even(trimesh.Trimesh(vertices, faces, process=False), points, seed=seed)[0])


def pcu_poisson(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
    import point_cloud_utils

    f, w = point_cloud_utils.sample_mesh_poisson_disk(vertices, faces.astype(np.int32), points, random_seed=seed)
    return np.asarray(point_cloud_utils.interpolate_barycentric_coords(faces.astype(np.int32), f, w, vertices))


def pcu_lloyd(vertices: Floats, faces: Ints, points: int, _seed: int) -> Floats:
    import point_cloud_utils  # takes no seed

    return np.asarray(point_cloud_utils.sample_mesh_lloyd(vertices, faces.astype(np.int32), points))


def fpsample_farthest(vertices: Floats, faces: Ints, points: int, seed: int) -> Floats:
    import fpsample

    dense = open3d_uniform(vertices, faces, 8 * points, seed)
    return np.asarray(dense[fpsample.bucket_fps_kdline_sampling(dense, points, h=7, start_idx=0)])


SAMPLERS: dict[str, tuple[Sampler, float]] = {  # with the share of the meshes that are tried
    "curvecast, scattered": (ours_scattered(0), 1),
    "curvecast, scattered, 1 round": (ours_scattered(1), 1),
    "curvecast, scattered, 2 rounds": (ours_scattered(2), 1),
    "curvecast, scattered, 2 rounds, ranks": (ours_nested, 0.1),
    "curvecast, scattered, 10 rounds": (ours_scattered(10), 0.1),
    "curvecast, scattered, 60 rounds": (ours_scattered(60), 0.1),
    "curvecast, equalised": (ours_equalised(0), 1),
    "curvecast, equalised, 3 rounds": (ours_equalised(3), 0.1),
    "curvecast, progressive": (ours_ranked, 0.02),
    "open3d, uniform": (open3d_uniform, 1),
    "open3d, Poisson disk": (open3d_poisson, 0.1),
    "trimesh, even": (trimesh_even, 1),
    "point-cloud-utils, Poisson disk": (pcu_poisson, 0.05),
    "point-cloud-utils, Lloyd": (pcu_lloyd, 0.02),
    "fpsample of 8 times as many": (fpsample_farthest, 0.1),
}


def deformed(vertices: Floats, seed: int) -> Floats:
    """Bent by waves as long as the mesh, so that no two are the same."""
    generator = np.random.default_rng(seed)
    scale = np.ptp(vertices, axis=0).max()
    waves = generator.normal(size=(3, 3)) * 3 / scale
    moved: Floats = vertices + 0.05 * scale * np.sin(vertices @ waves + generator.uniform(0, 6, 3))
    return moved


def bases(paths: Sequence[str]) -> list[tuple[Floats, Ints]]:
    """The meshes, made anew of 20,000 triangles."""
    made = []
    for path in paths:
        mesh = curvecast.read(path).remesh(10_000)
        made.append((mesh.vertices.world_positions(), mesh.triangles.astype(np.int64)))
    return made or [torus(125, 80)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes_given", nargs="*", metavar="MESH")
    parser.add_argument("--meshes", type=int, default=1000)
    parser.add_argument("--points", type=int, default=16_384)
    parser.add_argument("--measured", type=int, default=10, help="sets of each sampler whose evenness is measured")
    parser.add_argument(
        "--only", action="append", default=[], metavar="NAME", help="samplers whose names have this in them; repeat"
    )
    parser.add_argument(
        "--part", type=float, default=1, help="measure so much of each set, from the front: of ranks and farthest points a set, too"
    )
    flags = parser.parse_args()
    given = bases(flags.meshes_given)
    print(f"{flags.meshes} meshes of about {np.mean([len(f) for _, f in given]):.0f} triangles, {flags.points} points, one core\n")
    print("| sampler | meshes | CPU seconds, mean (most) | points | ring discrepancy | ball discrepancy | rho | coverage |")
    print("|---|---|---|---|---|---|---|---|")
    for name, (sample, share) in SAMPLERS.items():
        if flags.only and not any(part in name for part in flags.only):
            continue
        seconds: list[float] = []
        counts: list[int] = []
        measures = []
        count = max(int(flags.meshes * share), min(flags.meshes, flags.measured))
        try:
            sample(*torus(9, 6), 64, 0)  # what is loaded and started first is nobody's work
            for i in range(count):
                vertices, faces = given[i % len(given)]
                vertices = deformed(vertices, i)
                start = time.process_time()
                points = sample(vertices, faces, flags.points, i)
                seconds.append(time.process_time() - start)
                counts.append(len(points))
                if i < flags.measured:
                    surface = curvecast.Surface(vertices, faces, threads=1)
                    points = points[: round(flags.part * len(points))]
                    measures.append(surface.measure(points, ring_seeds=256, ball_centres=1024).sets[0])
        except ModuleNotFoundError as error:
            print(f"| {name} | {error} |")
            continue
        rings = statistics.fmean(m.ring_discrepancy.rms_relative for m in measures)
        balls = statistics.fmean(m.ball_discrepancy.rms_relative for m in measures)
        rho = statistics.fmean(m.spacing.rho for m in measures)
        coverage = statistics.fmean(m.spacing.coverage for m in measures)
        numbers = [f"{statistics.fmean(seconds):.3f} ({max(seconds):.3f})", f"{statistics.fmean(counts):.0f}"]
        numbers += [f"{value:.3f}" for value in (rings, balls, rho, coverage)]
        print(f"| {name} | {count} | {' | '.join(numbers)} |", flush=True)


if __name__ == "__main__":
    main()
