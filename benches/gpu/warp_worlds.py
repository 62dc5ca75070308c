"""Steps many worlds at once in MuJoCo Warp on a GPU, beside MuJoCo on the CPU, and prints what each does a second.

    python benches/gpu/warp_worlds.py WORLD.xml... [--worlds 256] [--steps 200] [--json FILE]

WORLD.xml are worlds that `d3dgen export --format mujoco` wrote. They share the number of worlds evenly: with 8 files and
256 worlds there are 32 copies of each, all on the GPU at the same time and stepped in turn by CUDA graphs. Needs the
packages mujoco, mujoco-warp and warp-lang, and an NVIDIA GPU. The kernels are compiled on the first run, which takes minutes.
Memory is what the worlds take of the GPU's pool; steps are those of single worlds (256 worlds stepped once are 256 steps).
The no-slip iterations of the worlds are left out on both sides: they are solved row by row, which a GPU is slow at.
"""

import argparse
import json
import sys
import time
from pathlib import Path

import mujoco
import numpy
import warp

import mujoco_warp

CPU_STEPS = 200
WARM_UP = 20
"""Steps before anything is measured: objects come to rest, contacts are at their number."""


def loaded(path):
    """Returns the model of a file with its data after the warm-up, on the CPU."""
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.noslip_iterations = 0
    data = mujoco.MjData(model)
    for _ in range(WARM_UP):
        mujoco.mj_step(model, data)
    return model, data


def cpu_steps_per_second(model, data):
    begun = time.perf_counter()
    for _ in range(CPU_STEPS):
        mujoco.mj_step(model, data)
    return CPU_STEPS / (time.perf_counter() - begun)


class Batch:
    """Copies of one world on the GPU, with the graph of one step."""

    def __init__(self, model, data, worlds):
        # room for three times what the settled world has: objects bounce at first
        contacts, rows = max(64, 3 * data.ncon), max(256, 3 * data.nefc)
        self.worlds = worlds
        self.model = mujoco_warp.put_model(model)
        self.data = mujoco_warp.put_data(model, data, nworld=worlds, nconmax=contacts, njmax=rows)
        mujoco_warp.step(self.model, self.data)  # compiles the kernels
        with warp.ScopedCapture() as capture:
            mujoco_warp.step(self.model, self.data)
        self.graph = capture.graph

    def step(self):
        warp.capture_launch(self.graph)

    def is_finite(self):
        return bool(numpy.isfinite(self.data.qpos.numpy()).all())


def measured(paths, worlds, steps):
    """Returns the figures of all worlds together."""
    device = warp.get_device()
    before = warp.get_mempool_used_mem_current(device)
    begun = time.perf_counter()
    models = [loaded(path) for path in paths]
    cpu = [cpu_steps_per_second(model, data) for model, data in models]
    shares = [worlds // len(paths) + (i < worlds % len(paths)) for i in range(len(paths))]
    batches = [Batch(model, data, share) for (model, data), share in zip(models, shares)]
    warp.synchronize()
    ready = time.perf_counter() - begun
    begun = time.perf_counter()
    for _ in range(steps):
        for batch in batches:
            batch.step()
    warp.synchronize()
    seconds = time.perf_counter() - begun
    if not all(batch.is_finite() for batch in batches):
        sys.exit("a world blew up: its positions are not finite")
    return {
        "gpu": device.name,
        "files": len(paths),
        "worlds": worlds,
        "steps": steps,
        "bodies_a_world": round(float(numpy.mean([m.nbody for m, _ in models])), 1),
        "shapes_a_world": round(float(numpy.mean([m.ngeom for m, _ in models])), 1),
        "freedoms_a_world": round(float(numpy.mean([m.nv for m, _ in models])), 1),
        "gpu_steps_per_s": round(worlds * steps / seconds),
        "cpu_steps_per_s_one_core": round(float(numpy.mean(cpu))),
        "times_real_time": round(worlds * steps * models[0][0].opt.timestep / seconds, 1),
        "memory_mib": round((warp.get_mempool_used_mem_current(device) - before) / 2**20),
        "seconds_until_ready": round(ready, 1),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="+", type=Path, metavar="WORLD.xml")
    parser.add_argument("--worlds", type=int, default=256)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    warp.init()
    if not warp.is_cuda_available():
        sys.exit("no NVIDIA GPU is here")
    figures = [measured(asked.paths[:1], asked.worlds, asked.steps)]
    if len(asked.paths) > 1:
        figures.append(measured(asked.paths, asked.worlds, asked.steps))
    for row in figures:
        print(json.dumps(row), flush=True)
    if asked.json:
        asked.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
