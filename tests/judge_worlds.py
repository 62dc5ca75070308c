#!/usr/bin/env python3
"""Makes worlds with the release binary and has every one judged from outside.

The full run makes 290 worlds: residential, office and hospital with 5, 8 and 10 rooms and 30 seeds each, school and
warehouse with 10 seeds each. `--sample` makes the same kinds with fewer seeds. Judges: tests/referee/check_world.py, and
the referee of ../shared where that folder exists. Exit status 0 when no judge finds anything.

Needs the packages of tests/requirements.txt; without them it makes .venv in the checkout and starts again in it.
"""

import argparse
import functools
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SHARED_REFEREE = ROOT.parent / "shared" / "referee" / "referee.py"

CASES = [  # domain, rooms (None: as the prompt says), prompt
    *[("residential", n, "family apartment in Germany, for a cleaning robot") for n in (5, 8, 10)],
    *[("office", n, "office in the United States, for a service robot") for n in (5, 8, 10)],
    *[("hospital", n, "hospital ward in Germany, for a delivery robot") for n in (5, 8, 10)],
    ("school", None, "primary school with a cleaning robot"),
    ("warehouse", None, "warehouse with a delivery robot"),
]
CORE = {"residential", "office", "hospital"}


def in_venv():
    """Starts this script again in .venv when the packages are missing here."""
    if all(importlib.util.find_spec(name) for name in ("shapely", "numpy", "scipy", "yaml")):
        return
    python = ROOT / ".venv" / "bin" / "python"
    if Path(sys.prefix) == ROOT / ".venv":
        sys.exit("packages of tests/requirements.txt are missing in .venv; remove it and run again")
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", ROOT / ".venv"], check=True)
    requirements = ROOT / "tests" / "requirements.txt"
    subprocess.run([python, "-m", "pip", "install", "-q", "--disable-pip-version-check", "-r", requirements], check=True)
    os.execv(python, [str(python), *sys.argv])


@functools.cache
def load(name, path):
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def judge(task):
    """Returns what each judge finds in one world, and its figures."""
    folder, binary = task
    graph = json.loads(subprocess.run(
        [binary, "scene-graph", "--from", folder / "scene_graph.json", "--simple"], check=True, capture_output=True, text=True,
    ).stdout)
    found, figures = [], {}
    (file,) = folder.rglob("world.yaml")
    judges = [("own", ROOT / "tests" / "referee" / "check_world.py")]
    judges += [("shared", SHARED_REFEREE)] if SHARED_REFEREE.exists() else []
    for name, path in judges:
        broken, seen = load(f"{name}_referee", path).judge(file, graph)
        found += [f"{name}: {b['rule']}: {b['subject']}" for b in broken]
        figures = figures or seen
    return folder, found, figures


def make(binary, out, domain, rooms, prompt, seeds):
    """Returns the folders of the worlds made, and how many of `seeds` were not."""
    command = [binary, "generate", prompt, "--domain", domain, "--count", str(seeds), "--seed", "0", "--json", "--no-png"]
    command += ["--out", out] + (["--rooms", str(rooms)] if rooms else [])
    if seeds == 1:
        command[command.index("--out") + 1] = out / "0"
    done = subprocess.run(command, capture_output=True, text=True)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    sound = [line for line in lines if line["sound"]]
    if len(sound) < seeds:
        print(f"{domain} {rooms}: {seeds - len(sound)} of {seeds} worlds not made\n{done.stderr[-2000:]}", file=sys.stderr)
    return sound, seeds - len(sound)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sample", action="store_true", help="4 seeds a case (2 of the custom ones) instead of 30 and 10")
    parser.add_argument("--binary", type=Path, default=ROOT / "target" / "release" / "d3dgen")
    parser.add_argument("--out", type=Path, help="keep the worlds in this folder, which must be new or empty")
    args = parser.parse_args()
    in_venv()
    if not args.binary.exists():
        sys.exit(f"{args.binary} is missing; build it: cargo build --release")
    print("judges: tests/referee/check_world.py" + (", ../shared/referee" if SHARED_REFEREE.exists() else
          " (there is no ../shared/referee beside this checkout)"))
    row = "{:<12} {:>5} {:>6} {:>6} {:>7} {:>9} {:>8} {:>10} {:>9} {:>9}"
    print(row.format("domain", "rooms", "worlds", "clean", "things", "per room", "m2", "ms median", "satisfied", "violated"))
    total, clean, causes = 0, 0, Counter()
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch, ProcessPoolExecutor() as pool:
        base = args.out or Path(scratch)
        for domain, rooms, prompt in CASES:
            seeds = (4 if args.sample else 30) if domain in CORE else (2 if args.sample else 10)
            worlds, missing = make(args.binary, base / f"{domain}_{rooms or 'default'}", domain, rooms, prompt, seeds)
            causes["not made"] += missing
            verdicts = list(pool.map(judge, [(Path(w["path"]), args.binary) for w in worlds]))
            for folder, found, _ in verdicts:
                causes.update(f"{domain}: {': '.join(f.split(': ')[:2])}" for f in found)
                for line in found[:5]:
                    print(f"  {folder.relative_to(base)}: {line}")
            for world in worlds:
                if rooms and world["rooms"] != rooms:
                    causes["wrong number of rooms"] += 1
            total += seeds
            good = sum(not found for _, found, _ in verdicts)
            clean += good
            count = max(1, len(worlds))
            middle = sorted(sum(w["stage_ms"].values()) for w in worlds)[len(worlds) // 2] if worlds else 0
            things = sum(f["things"] for _, _, f in verdicts)
            zones = max(1, sum(f["zones"] for _, _, f in verdicts))
            constraints = [sum(w["constraints"][k] for w in worlds) / count for k in ("satisfied", "violated")]
            print(row.format(
                domain, rooms or "", seeds, good, f"{things / count:.0f}", f"{things / zones:.1f}",
                f"{sum(w['area_m2'] for w in worlds) / count:.0f}", f"{middle:.0f}", *(f"{c:.1f}" for c in constraints),
            ), flush=True)
    for cause, count in causes.most_common():
        if count:
            print(f"  {count:>5}  {cause}")
    print(f"{clean} of {total} worlds clean, {time.monotonic() - begun:.0f} s")
    sys.exit(0 if clean == total and not +causes else 1)


if __name__ == "__main__":
    main()
