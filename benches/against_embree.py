#!/usr/bin/env python3
"""`lumbre rays` against Embree: the same rays against the same triangles, in turns, on the same number of threads
(of lavapipe).

    benches/against_embree.py SCENE...  [--size 512x512] [--turns 5] [--threads 2] [--lumbre target/release/lumbre]

needs g++ and Embree 3 or 4 with its headers (Debian: libembree-dev). Mrays/s are medians over the turns; `single` is rtcIntersect1 or, for shadow
rays, rtcOccluded1, `packets` is rtcIntersect16 or rtcOccluded16, told that primary rays in the order of the image are coherent. The time of building is that of
rtcCommitScene (robust) and of lumbre's tree, its upload included. Fails where the two do not hit the same share of the rays.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent


def build(folder):
    """Compiles the peer; the path of the program."""
    program = folder / "embree"
    for library in ("embree4", "embree3"):
        command = ["g++", "-O3", "-march=native", "-std=c++17", str(HERE / "peers/embree.cpp"), f"-l{library}", "-pthread", "-o", str(program)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode == 0:
            return program
    sys.exit(f"benches/peers/embree.cpp does not compile; is Embree installed (Debian: libembree-dev)?\n{done.stderr}")


def lumbre_rays(program, scene, size, threads, more):
    """One turn: {(kind, in order): (Mrays/s, share that hits)} and seconds of building."""
    command = [program, "rays", scene, "--size", size, "--repeats", "1", "--json", "-", *more]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LP_NUM_THREADS": str(threads)})
    if done.returncode:
        sys.exit(done.stderr.strip())
    found = json.loads(done.stdout)
    rates = {}
    for row in found["throughput"]:
        rates[row["backend"], row["kind"], True] = row["mrays_per_s"], row["hit"]
        rates[row["backend"], row["kind"], False] = row["shuffled_mrays_per_s"], row["hit"]
    return rates, {row["backend"]: row["build_seconds"] for row in found["structures"]}, found["primitives"]


def embree_rays(program, file, threads):
    done = subprocess.run([program, file, str(threads), "1"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr.strip())
    found = json.loads(done.stdout)
    return {(row["packets"], row["kind"], row["in_order"]): (row["mrays_per_s"], row["hit"]) for row in found["throughput"]}, found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--size", default="512x512")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--lumbre", default="target/release/lumbre")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        embree = build(Path(folder))
        file = Path(folder) / "rays"
        for scene in args.scenes:
            lumbre_rays(args.lumbre, scene, args.size, args.threads, ["--export", str(file)])
            ours, theirs, built, their_build = {}, {}, {}, []
            for _ in range(args.turns):
                rates, seconds, primitives = lumbre_rays(args.lumbre, scene, args.size, args.threads, [])
                for key, value in rates.items():
                    ours.setdefault(key, []).append(value)
                for backend, value in seconds.items():
                    built.setdefault(backend, []).append(value)
                rates, found = embree_rays(embree, file, args.threads)
                their_build.append(found["build_seconds"])
                for key, value in rates.items():
                    theirs.setdefault(key, []).append(value)
            report(scene, primitives, ours, theirs, built, their_build, found["renderer"])


def report(scene, primitives, ours, theirs, built, their_build, renderer):
    backends = sorted(built)
    print(f"\n{scene}: {primitives} triangles; {renderer}")
    seconds = ", ".join(f"{backend} {statistics.median(built[backend]):.3f}" for backend in backends)
    print(f"built in s: {seconds}, Embree {statistics.median(their_build):.3f}")
    print("| rays | order | " + " | ".join(backends) + " | single | packets | bvh over single | bvh over packets |")
    print("|---|---|" + "---|" * (len(backends) + 4))
    for kind in dict.fromkeys(kind for _, kind, _ in ours):
        for in_order in (True, False):
            rate = lambda found, key: statistics.median(value[0] for value in found[key, kind, in_order])
            columns = [rate(ours, backend) for backend in backends] + [rate(theirs, False), rate(theirs, True)]
            bvh = rate(ours, "bvh")
            ratios = [bvh / rate(theirs, False), bvh / rate(theirs, True)]
            print(f"| {kind} | {'image' if in_order else 'shuffled'} | " + " | ".join(f"{value:.2f}" for value in columns + ratios) + " |")
            hits = ours["bvh", kind, in_order][0][1], theirs[False, kind, in_order][0][1]
            if abs(hits[0] - hits[1]) > 1e-3:
                sys.exit(f"{scene}: {hits[0]:.4f} of the {kind} rays hit something in lumbre, {hits[1]:.4f} in Embree")


if __name__ == "__main__":
    main()
