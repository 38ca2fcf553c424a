#!/usr/bin/env python3
"""Renders the shards of an image on a Ray cluster and merges them: the bits of one run, whatever workers die on the way.

    pip install ray
    ray_render.py scene.xml -n 4096 --shards 64 --folder /shared/shards -o image.exr [--lumbre PROGRAM] [-- OPTIONS OF LUMBRE RENDER]

Each shard is a task. A task whose worker or node dies is started again elsewhere, and goes on from the checkpoint of its shard: the folder must be
one that all nodes see. So does the whole script: what is finished there is not rendered again. Without an address (RAY_ADDRESS) Ray starts on this
machine, with --workers tasks at a time.
"""

import argparse
import ctypes
import os
import signal
import subprocess
import sys
from pathlib import Path

import ray


def die_with_parent():
    """A program whose worker is killed must not go on: it holds the lock of the checkpoint that the next worker needs (Linux)."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class Killed(Exception):
    """A signal ended the program, of the system that was short of memory, say: the task is tried again."""


@ray.remote(max_retries=20, retry_exceptions=[Killed])
def render(command, shard):
    done = subprocess.run(command, preexec_fn=die_with_parent, stderr=subprocess.PIPE, text=True)
    if done.returncode < 0:
        raise Killed(f"shard {shard}: signal {-done.returncode}")
    # Not an exception, as a wrong command stays wrong.
    return None if done.returncode == 0 else f"shard {shard}: {done.stderr.strip()}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("-n", "--spp", type=int, required=True, help="samples per pixel of all shards together")
    parser.add_argument("--shards", type=int, required=True, help="how many there are: at most SPP / 64")
    parser.add_argument("--folder", type=Path, required=True, help="where the shards' checkpoints lie: seen by all nodes")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--lumbre", default="lumbre", help="the program, in the same version on all nodes")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="tasks at a time, where Ray starts on this machine")
    parser.add_argument("--cpus", type=float, default=1, help="processors that a task takes")
    parser.add_argument("--gpus", type=float, default=0, help="GPUs that a task takes")
    parser.add_argument("--interval", type=float, default=60, help="seconds between two checkpoints")
    options = sys.argv[1:]
    further = []
    if "--" in options:
        at = options.index("--")
        options, further = options[:at], options[at + 1 :]
    args = parser.parse_args(options)

    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    checkpoint = [str(folder / f"shard-{number:05}") for number in range(args.shards + 1)]

    def command(number):
        shard = ["--shard", f"{number}/{args.shards}", "--checkpoint", checkpoint[number], "--resume"]
        interval = ["--checkpoint-interval", str(args.interval)]
        return [args.lumbre, "render", str(args.scene.resolve()), "-n", str(args.spp), *shard, *interval, "-q", *further]

    ray.init(**({} if "RAY_ADDRESS" in os.environ else {"num_cpus": args.workers}))
    task = render.options(num_cpus=args.cpus, num_gpus=args.gpus)
    left = [task.remote(command(number), number) for number in range(1, args.shards + 1)]
    done = 0
    while left:
        ready, left = ray.wait(left)
        for error in ray.get(ready):
            if error is not None:
                sys.exit(error)
            done += 1
            print(f"{done} of {args.shards} shards", flush=True)
    ray.shutdown()
    merge = subprocess.run([args.lumbre, "merge", *checkpoint[1:], "-o", str(args.output)])
    sys.exit(merge.returncode)


if __name__ == "__main__":
    main()
