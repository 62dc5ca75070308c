#!/usr/bin/env python3
"""Makes worlds with the release binary and has every one judged from outside.

The full run makes 290 worlds: residential, office and hospital with 5, 8 and 10 rooms and 30 seeds each, school and
warehouse with 10 seeds each. `--sample` makes the same kinds with fewer seeds; `--paper` makes the 450 worlds of
`d3dgen bench paper` instead (with `--sample` 18 of them). Judges: tests/referee/check_world.py, the
referee of ../shared where that folder exists, and `contents` below: required objects, areas within the domain's ranges,
rooms that must or must not adjoin. Exit status 0 when no judge finds anything and every world asked for was made.

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
os.environ["D3DGEN_STORE"] = ""  # worlds of the shipped rules, whatever database the user has
SHARED_REFEREE = ROOT.parent / "shared" / "referee" / "referee.py"

CASES = [  # domain, rooms (None: as the prompt says), prompt
    *[("residential", n, "family apartment in Germany, for a cleaning robot") for n in (5, 8, 10)],
    *[("office", n, "office in the United States, for a service robot") for n in (5, 8, 10)],
    *[("hospital", n, "hospital ward in Germany, for a delivery robot") for n in (5, 8, 10)],
    ("school", None, "primary school with a cleaning robot"),
    ("warehouse", None, "warehouse with a delivery robot"),
    ("residential", None, "two-storey house in Germany: ground floor with kitchen, living room and toilet; upper floor with 3 bedrooms and a bathroom"),
    ("office", 24, "office in the United States on 3 storeys, for a service robot"),
    ("hospital", 24, "hospital in Germany with 2 storeys, for a delivery robot"),
]
CORE = {"residential", "office", "hospital"}
AREAS_IN_RANGE = 0.98  # least share of rooms with an area in the range of their type
THINGS_A_ROOM = 5.0  # least average
COLUMNS = "{:<12} {:>5} {:>6} {:>6} {:>7} {:>6} {:>8} {:>9} {:>9} {:>9} {:>9}"


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


@functools.cache
def domain_of(binary, name):
    """Returns the domain with its lists as tables by id."""
    shown = subprocess.run([binary, "domains", "show", name, "--json"], check=True, capture_output=True, text=True)
    domain = json.loads(shown.stdout)
    tables = {key: {item["id"]: item for item in domain[key]} for key in ("room_types", "groups")}
    return tables | {"adjacency": domain["adjacency"]}


def is_for(line, graph):
    """Tells whether a furnishing line is for a building: one with step-free access, one without some rooms."""
    if line.get("accessible") and not graph.get("accessible"):
        return False
    return not any(room["room_type"] in line.get("unless_rooms", []) for room in graph["rooms"])


def has(here, group, item, least):
    """Tells whether a room has so many of an object, or of a group's anchor with what belongs to it."""
    anchor = group["anchor"] if group else item
    members = [m["object"] for m in group["members"] if m.get("required")] if group else []
    return here[anchor] >= least and all(here[m] for m in members)


def contents(folder, domain):
    """Returns what a world lacks of its domain's demands, its rooms, and how many have an area in their type's range."""
    graph, plan, placed = (
        json.loads((folder / f"{name}.json").read_text()) for name in ("scene_graph", "floorplan", "placements")
    )
    found = []
    rooms = [r for r in plan["rooms"] if not r["circulation"]]
    in_range = 0
    for room in rooms:
        kind = domain["room_types"].get(room["room_type"], domain["room_types"]["room"])
        area = kind["area_m2"]
        in_range += area["min"] - 0.01 <= room["net_area_m2"] <= area["max"] + 0.01
        here = Counter(p["object"] for p in placed["placements"] if p["room_id"] == room["room_id"])
        for line in kind["furnishing"]:
            if line.get("required") and is_for(line, graph):
                items = [line["item"], *line.get("instead_of", [])]
                if not any(has(here, domain["groups"].get(item), item, line["min"]) for item in items):
                    found.append(f"object_missing: {room['room_id']} without {line['item']}")
    kinds = {r["room_id"]: r["room_type"] for r in plan["rooms"]}
    links = {frozenset(d["room_ids"]) for d in plan["doors"] if len(d["room_ids"]) == 2}
    links |= {frozenset((e["a"], e["b"])) for e in graph["edges"] if e["connector"] == "open" and e.get("required", True)}
    for rule in domain["adjacency"]:
        if rule.get("via") not in ("door", "open") or (places := rule.get("jurisdictions")) and graph["country_code"] not in places:
            continue
        ours, others = ([i for i, kind in kinds.items() if kind == rule[side]] for side in "ab")
        for room in ours:
            joined = any(frozenset((room, other)) in links for other in others)
            if rule["relation"] == "must" and others and not joined:
                found.append(f"adjacency_missing: {room} to {rule['b']}")
            if rule["relation"] == "must_not" and joined:
                found.append(f"adjacency_forbidden: {room} to {rule['b']}")
    return found, len(rooms), in_range


def judge(task):
    """Returns what each judge finds in one world, and its figures."""
    folder, binary, name = task
    graph = json.loads(subprocess.run(
        [binary, "scene-graph", "--from", folder / "scene_graph.json", "--simple"], check=True, capture_output=True, text=True,
    ).stdout)
    found, rooms, in_range = contents(folder, domain_of(binary, name))
    found = [f"contents: {line}" for line in found]
    figures = {"rooms": rooms, "in_range": in_range}
    files = sorted(folder.rglob("world.yaml"))
    if len(files) != len(json.loads((folder / "floorplan.json").read_text()).get("levels", [0])):
        found.append(f"contents: level_missing: {len(files)} world.yaml")
    judges = [("own", ROOT / "tests" / "referee" / "check_world.py")]
    judges += [("shared", SHARED_REFEREE)] if SHARED_REFEREE.exists() else []
    for label, path in judges:
        sums = Counter()
        for file in files:
            broken, seen = load(f"{label}_referee", path).judge(file, on_level(folder, graph, int(file.parent.name)))
            found += [f"{label}: {b['rule']}: {b['subject']}" for b in broken]
            sums.update({key: value for key, value in seen.items() if isinstance(value, (int, float))})
        if label == "own":
            found += [f"{label}: {b['rule']}: {b['subject']}" for b in load("own_referee", path).judge_building(files)]
        figures = sums | figures
    return folder, found, figures


def on_level(folder, graph, level):
    """Returns the part of a simple graph that a level's world shows: above the ground without stairwells and shafts."""
    full = json.loads((folder / "scene_graph.json").read_text())
    shafts = {room for link in full.get("links", []) for room in link["room_ids"]} if level else set()
    here = {r["id"] for r in full["rooms"] if r.get("level", 0) == level} - shafts
    rooms = [r for r in graph["rooms"] if r["id"] in here]
    return {"rooms": rooms, "edges": [e for e in graph["edges"] if {e["a"], e["b"]} <= here]}


def make(binary, out, domain, rooms, prompt, seeds):
    """Returns the sound worlds made, and how many of `seeds` were not."""
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


def make_paper(binary, out, each):
    """Returns the sound worlds of the paper's benchmark by domain and number of rooms, and how many were not made."""
    command = [binary, "bench", "paper", "--each", str(each), "--out", out]
    done = subprocess.run(command, capture_output=True, text=True)
    print(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "")
    if done.returncode not in (0, 1):
        sys.exit(done.stderr)
    cases = {}
    for world in json.loads((out / "evaluation.json").read_text())["worlds"]:
        line = {
            "path": out / world["path"], "stage_ms": world["stage_ms"], "area_m2": world["layout"]["floor_area_m2"],
            "rooms": world["fidelity"]["rooms_built"], "sound": world["sound"],
            "constraints": {k: sum(world["compliance"][f][k] for f in ("mandatory", "advice")) for k in ("satisfied", "violated")},
        }
        cases.setdefault((world["domain"], world["fidelity"]["rooms_asked"]), []).append(line)
    made = {key: [line for line in lines if line["sound"]] for key, lines in cases.items()}
    return made, 9 * each - sum(map(len, made.values()))


def row(domain, rooms, seeds, worlds, verdicts):
    """Returns the line of one case."""
    count = max(1, len(worlds))
    figures = [f for _, _, f in verdicts]
    things, zones, of_rooms, in_range = (sum(f[k] for f in figures) for k in ("things", "zones", "rooms", "in_range"))
    middle = sorted(sum(w["stage_ms"].values()) for w in worlds)[len(worlds) // 2] if worlds else 0
    satisfied, violated = (sum(w["constraints"][k] for w in worlds) / count for k in ("satisfied", "violated"))
    return COLUMNS.format(
        domain, rooms or "", seeds, sum(not found for _, found, _ in verdicts), f"{things / count:.0f}",
        f"{things / max(1, zones):.1f}", f"{100 * in_range / max(1, of_rooms):.1f} %",
        f"{sum(w['area_m2'] for w in worlds) / count:.0f}", f"{middle:.0f}", f"{satisfied:.1f}", f"{violated:.1f}",
    )


def seeded(binary, base, sample, causes):
    """Makes the worlds of CASES one case after the other."""
    for domain, rooms, prompt in CASES:
        seeds = (4 if sample else 30) if domain in CORE else (2 if sample else 10)
        worlds, missing = make(binary, base / f"{domain}_{rooms or 'default'}", domain, rooms, prompt, seeds)
        causes["not made"] += missing
        yield domain, rooms, seeds, worlds


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sample", action="store_true", help="4 seeds a case (2 of the custom ones) instead of 30 and 10")
    parser.add_argument("--paper", action="store_true", help="the worlds of `d3dgen bench paper`: 450, or 18 with --sample")
    parser.add_argument("--binary", type=Path, default=ROOT / "target" / "release" / "d3dgen")
    parser.add_argument("--out", type=Path, help="keep the worlds in this folder, which must be new or empty")
    args = parser.parse_args()
    in_venv()
    if not args.binary.exists():
        sys.exit(f"{args.binary} is missing; build it: cargo build --release")
    print("judges: tests/referee/check_world.py, contents" + (", ../shared/referee" if SHARED_REFEREE.exists() else
          " (there is no ../shared/referee beside this checkout)"))
    header = ("domain", "rooms", "worlds", "clean", "things", "a room", "in range", "area m2", "median ms", "satisfied", "violated")
    print(COLUMNS.format(*header))
    total, clean, causes, sums = 0, 0, Counter(), Counter()
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch, ProcessPoolExecutor() as pool:
        base = args.out or Path(scratch)
        if args.paper:
            base = args.out or base / "paper"
            made, missing = make_paper(args.binary, base, 2 if args.sample else 50)
            causes["not made"] += missing
            total += missing
            runs = ((domain, rooms, len(worlds), worlds) for (domain, rooms), worlds in sorted(made.items()))
        else:
            runs = seeded(args.binary, base, args.sample, causes)
        for domain, rooms, seeds, worlds in runs:
            verdicts = list(pool.map(judge, [(Path(w["path"]), args.binary, domain) for w in worlds]))
            for folder, found, figures in verdicts:
                causes.update(f"{domain}: {': '.join(f.split(': ')[:2])}" for f in found)
                sums.update({key: figures[key] for key in ("rooms", "in_range", "things", "zones")})
                for line in found[:5]:
                    print(f"  {folder.relative_to(base)}: {line}")
            causes["wrong number of rooms"] += sum(w["rooms"] != rooms for w in worlds if rooms)
            total += seeds
            clean += sum(not found for _, found, _ in verdicts)
            print(row(domain, rooms, seeds, worlds, verdicts), flush=True)
    share, average = sums["in_range"] / max(1, sums["rooms"]), sums["things"] / max(1, sums["zones"])
    print(f"{100 * share:.1f} % of {sums['rooms']} rooms have an area in the range of their type, {average:.1f} things a room")
    causes["too few areas in range"] += share < AREAS_IN_RANGE
    causes["too few things a room"] += average < THINGS_A_ROOM
    for cause, count in causes.most_common():
        if count:
            print(f"  {count:>5}  {cause}")
    print(f"{clean} of {total} worlds clean, {time.monotonic() - begun:.0f} s")
    sys.exit(0 if clean == total and not +causes else 1)


if __name__ == "__main__":
    main()
