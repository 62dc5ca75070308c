#!/usr/bin/env python3
"""Makes worlds and has the consumers' own code load and step them, then writes what came of it as a table.

Usage: judge_simulators.py --kit FOLDER [--program d3dgen] [--worlds N | --prompts FILE | --made FOLDER...] [--formats LIST]
                           [--out FOLDER] [--skip LIST] [--table docs/simulators.md]

The kit is the folder of acceptance checks (check_mjcf.py, check_sdf.py, check_usd.py, check_simready.py, check_glb.mjs,
check_nav2.py, check_rmf.py), installed by its setup.sh. Worlds are those of PROMPTS in turn of domains, or those of a file with
a prompt a line, seed by place in the list; or folders of worlds that are there already. --skip leaves out consumers by the start of their titles: `--skip Newton,SimReady`.
Every figure is what a check printed; nothing is rounded up. Interrupted, it counts the worlds that were judged whole. Exit status 0 when every world is accepted by every check that ran.
"""

import argparse
import collections
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

PROMPTS = {
    "residential": [
        "two-bedroom flat in Germany, for a delivery robot",
        "house on 2 floors with three bedrooms, for a cleaning robot",
        "studio flat with a balcony",
        "three-bedroom flat in France with an open kitchen",
        "flat for a family of five with two bathrooms",
        "one-bedroom flat for a wheelchair user, for a service robot",
        "house with a garage and four bedrooms",
        "flat of 120 m2 with a study and a guest toilet, for a cleaning robot",
        "shared flat for four students",
        "house on 2 floors, 180 m2, with a home office",
    ],
    "office": [
        "office for 20 people with a reception and two meeting rooms, for a delivery robot",
        "office on 2 floors, 20 people, 2 delivery robots",
        "open-plan office for 40 people with a kitchen",
        "law firm with eight single offices and a library",
        "coworking space for 30 people with phone booths, for a cleaning robot",
        "office for 12 people in the United States",
        "architects' office with a workshop and a meeting room for 10",
        "office on 3 floors for 60 people",
        "call center for 50 people with a break room",
        "small office with two rooms, for a service robot",
    ],
    "hospital": [
        "hospital ward with 8 rooms in Germany, for two delivery robots",
        "outpatient clinic with six treatment rooms and a waiting area",
        "surgery department with two operating rooms, for a transport robot",
        "ward with 12 double rooms and a nurse station, for a delivery robot",
        "dental practice with four rooms",
        "hospital on 2 floors with a ward of 10 rooms above an outpatient clinic",
        "emergency department with three trauma rooms",
        "radiology department with a CT and an MRI room",
        "maternity ward with six rooms, for a cleaning robot",
        "small clinic with a pharmacy and a laboratory, for a delivery robot",
    ],
    "general": [
        "bakery shop with a storage room and an office, for a delivery robot",
        "library with a reading room and a cafe",
        "restaurant with a kitchen and 40 seats, for a serving robot",
        "hairdresser's shop with a staff room",
        "gym with changing rooms",
        "bookshop on 2 floors with a cafe",
        "pharmacy with a back office",
        "hotel with 8 rooms and a lobby, for a delivery robot",
        "supermarket with a storage room, for a cleaning robot",
        "community center with a hall and a kitchen",
    ],
}


# Radius of a robot of usual size, m.
RADIUS_M = 0.25


def last_json(command, timeout=1500):
    """Runs a check; returns what it printed last as JSON, and how long it took, s."""
    begun = time.monotonic()
    try:
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        return {"ok": False, "failures": [{"code": "timeout", "message": f"longer than {timeout} s"}], "facts": {}}, timeout
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    took = time.monotonic() - begun
    if not lines:
        return {"ok": False, "failures": [{"code": "no_verdict", "message": done.stderr[-400:]}], "facts": {}}, took
    return json.loads(lines[-1]), took


class Consumer:
    """One row of the table: what it is called, the format it reads, how it is asked, and what is read from its facts."""

    def __init__(self, title, format, commands, facts):
        self.title, self.format, self.commands, self.facts = title, format, commands, facts

    def found(self, verdict, seconds):
        """Returns the figures of one verdict."""
        facts = verdict.get("facts", {})
        codes = collections.Counter(f["code"] for f in verdict.get("failures", []))
        figures = {name: facts.get(key) for name, key in self.facts.items()}
        return {"ok": verdict.get("ok", False), "seconds": seconds, "refused": codes["joint_blocked"] + codes["joint_limit"], "moved": codes["drift"] + codes["tilt"], "codes": codes, **figures}


def kit_python():
    """The Python of the kit's `world` environment, which has all that its checks import; this one where it is not there."""
    cache = Path(os.environ.get("SIM_ACCEPT_CACHE") or Path.home() / ".cache/sim-accept")
    own = cache / "venv/world/bin/python"
    return own if own.exists() else sys.executable


def radius(world):
    """Radius of the disc that has to pass, m: that of the world's smallest robot, at most RADIUS_M."""
    robots = json.loads((world / "scenario.json").read_text()).get("robots", [])
    return min([RADIUS_M, *(task["robot"]["radius_m"] for task in robots)])


def consumers(kit):
    """The consumers, with the commands that judge a world's folder."""
    python = kit_python()
    check = lambda name: [python, kit / name]
    sweep = {"doorways": "sweep_paths", "doorways_open": "sweep_open"}
    stepped = lambda engine: {"bodies": f"{engine}_dynamic_bodies", "joints": f"{engine}_joints", "drift": f"{engine}_max_drift_m"}
    usd = lambda w, engine: [*check("check_usd.py"), w / "usd/world.usda", "--engine", engine, "--world", w / "usd/manifest.json", "--path", w / "usd/paths.json", "--timeout", 1400]
    mujoco = {"bodies": "settle_free_bodies", "stable": "settle_stable_percent", "joints": "doors", "doors_open": "doors_open_percent", **sweep}
    return [
        Consumer("MuJoCo, scenes (MolmoSpaces' rule)", "mujoco", lambda w: [[*check("check_mjcf.py"), w / "mujoco/world.xml", "--settle", "--doors", "--path", w / "mujoco/paths.json"]], mujoco),
        Consumer("MuJoCo, all joints at once", "mujoco", lambda w: [[*check("check_mjcf.py"), w / "mujoco/world.xml"]], stepped("mujoco")),
        Consumer("Gazebo Fortress (libsdformat, DART)", "gazebo", lambda w: [[*check("check_sdf.py"), w / "gazebo/world.sdf", "--timeout", 1400]], stepped("gazebo")),
        Consumer("OpenUSD and NVIDIA's rules", "usd", lambda w: [usd(w, "none")], sweep),
        Consumer("Newton", "usd", lambda w: [usd(w, "newton")], {**stepped("newton"), **sweep}),
        Consumer("SimReady Robotics-Prop 3.2", "usd", lambda w: [[*check("check_simready.py"), w / "usd/models"]], {}),
        Consumer("glTF (Khronos validator)", "gltf", lambda w: [["node", kit / "check_glb.mjs", *sorted((w / "gltf").glob("*.glb"))]], {}),
        Consumer("nav2 (map, graph, masks)", "nav2", lambda w: [[*check("check_nav2.py"), w / "nav2", "--radius", radius(w)]], {}),
        Consumer("Open-RMF (rmf_site_format)", "rmf", lambda w: [[*check("check_rmf.py"), b, "--radius", radius(w)] for b in sorted((w / "rmf").glob("*.building.yaml"))], {}),
    ]


def rooms_reached(world, verdict):
    """Rooms that are joined to the room of the main entrance by doorways that the sweep found open, and all rooms."""
    plan = json.loads((world / "world.json").read_text())["floorplan"]
    blocked = {f["message"].split(":")[0] for f in verdict.get("failures", []) if f["code"] == "doorway_blocked"}
    beside = collections.defaultdict(set)
    for door in plan["doors"]:
        if len(door["room_ids"]) == 2 and door["door_id"] not in blocked:
            a, b = door["room_ids"]
            beside[a].add(b)
            beside[b].add(a)
    for link in plan.get("links", []):
        for a, b in zip(link["room_ids"], link["room_ids"][1:]):
            beside[a].add(b)
            beside[b].add(a)
    entrances = [d for d in plan["doors"] if d.get("entrance")] or plan["doors"]
    ahead, seen = [entrances[0]["room_ids"][0]] if entrances else [], set()
    while ahead:
        room = ahead.pop()
        if room not in seen:
            seen.add(room)
            ahead.extend(beside[room])
    return len(seen), len(plan["rooms"])


def share(part, whole):
    return "-" if not whole else f"{part} of {whole}"


def row(title, results):
    """A line of the table from the figures of all worlds."""
    total = lambda key: sum(r[key] for r in results if r.get(key) is not None)
    settled = [r for r in results if r.get("stable") is not None]
    stable = sum(round((r["bodies"] or 0) * r["stable"] / 100) for r in settled) if settled else total("bodies") - total("moved")
    opened = [r for r in results if r.get("doors_open") is not None]
    doors = sum(round(r["joints"] * r["doors_open"] / 100) for r in opened) if opened else total("joints") - total("refused")
    cells = [
        title,
        share(sum(r["ok"] for r in results), len(results)),
        share(stable, total("bodies")),
        share(doors, total("joints")),
        share(total("doorways_open"), total("doorways")),
        share(total("reached"), total("rooms")),
        f"{statistics.median(r['seconds'] for r in results):.1f}",
    ]
    return "| " + " | ".join(cells) + " |"


SECTION = "## How they are judged"


def refusals(results):
    """What was refused, by consumer, in a line; nothing where nothing was."""
    counts = {title: sum((r["codes"] for r in found), collections.Counter()) for title, found in results.items()}
    said = [f"{title}: " + ", ".join(f"{code} {n}" for code, n in sorted(codes.items())) for title, codes in counts.items() if codes]
    return [f"Refused, by the codes of the kit: {'; '.join(said)}.", ""] if said else []


def page(before, rows, counts, took, refused):
    """The page with the section of figures written anew; sections after it stay."""
    made, storeys, asked = counts
    head, _, old = before.partition(SECTION)
    after = old.partition("\n## ")
    return head + "\n".join(
        [
            SECTION,
            "",
            f"Measured on {made} worlds, {storeys} of several storeys, with the consumers' own code, headless, on a machine without a GPU, by",
            f"`python tests/judge_simulators.py --kit FOLDER {asked} --table docs/simulators.md`; the kit is a set of scripts that load",
            "and step a world and print what they found. Gazebo's graphics, sensors and plugins, RTX and PhysX are not part of it.",
            "",
            "| consumer | worlds accepted | things stable | joints to their limits and back | doorways open | rooms reached | seconds (median) |",
            "|---|---|---|---|---|---|---|",
            *rows,
            "",
            "*Stable*: in MuJoCo a thing that can be moved ends less than 5 cm from where it was in the three seconds after the first, as",
            "MolmoSpaces asks of its scenes; in Gazebo and Newton any body moves at most 2 cm and turns at most 0.05 rad in two seconds.",
            "*Joints*: pushed with 8 N m or 8 N to one limit, to the other and back, they cover nine tenths of their range; in MuJoCo those of",
            "doors, in the others all that there are. *Doorways*: a disc of 0.25 m radius, or what the narrowest door leaves, is carried through",
            "the middle of each and along the routes of robots. nav2 and Open-RMF: a disc as large as the smallest robot, at most 0.25 m.",
            "*Rooms reached*: joined to the main entrance by open doorways. *Seconds*: the check itself.",
            "",
        ]
        + ([f"Making and writing a world took {statistics.median(took):.1f} s (median), with the start of the program.", ""] if took else [])
        + refused
    ) + after[1] + after[2]


def worlds(given, formats):
    """The folders of the worlds that are asked for, made one after the other, each with how long that took, s; none for one that
    cannot be made."""
    if given.made:
        yield from ((folder, None) for folder in given.made)
        return
    if given.prompts:
        prompts = [line.strip() for line in given.prompts.read_text().splitlines() if line.strip()]
    else:
        prompts = [p for group in zip(*PROMPTS.values()) for p in group][: given.worlds]
    for seed, prompt in enumerate(prompts, 1):
        folder, begun = given.out / f"{seed:02}", time.monotonic()
        command = [given.program, "generate", prompt, "--seed", str(seed), "--no-png", "--format", ",".join(formats), "--out", folder]
        done = subprocess.run(command, capture_output=True, text=True)
        made = done.returncode == 0 and (folder / "world.json").exists()
        if not made:
            print(f"{prompt}: not made: {done.stderr[-300:]}")
        yield folder if made else None, time.monotonic() - begun


def judge(world, consumer):
    """The figures of a world from every command of a consumer, each said as it comes."""
    for command in consumer.commands(world):
        verdict, seconds = last_json(command)
        found = consumer.found(verdict, seconds)
        if found.get("doorways") is not None:
            found["reached"], found["rooms"] = rooms_reached(world, verdict)
        print(f"{world.name} {consumer.title}: {'accepted' if found['ok'] else 'REFUSED'}, {seconds:.0f} s", flush=True)
        for failure in [] if found["ok"] else verdict.get("failures", [])[:8]:
            print(f"    {failure['code']}: {failure['message'][:220]}", flush=True)
        yield found


def which(given):
    """How this run is asked for again."""
    if given.made:
        return "--made FOLDER..."
    return f"--prompts {given.prompts.name}" if given.prompts else f"--worlds {given.worlds}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kit", type=Path, required=True)
    parser.add_argument("--program", default="target/debug/d3dgen")
    parser.add_argument("--worlds", type=int, default=sum(map(len, PROMPTS.values())))
    parser.add_argument("--prompts", type=Path)
    parser.add_argument("--made", type=Path, nargs="+")
    parser.add_argument("--formats", default="mujoco,gazebo,usd,gltf,nav2,rmf")
    parser.add_argument("--skip", default="")
    parser.add_argument("--out", type=Path, default=Path("target/simulators"))
    parser.add_argument("--table", type=Path)
    given = parser.parse_args()
    formats = given.formats.split(",")
    left_out = tuple(title for title in given.skip.split(",") if title)
    asked = [c for c in consumers(given.kit) if c.format in formats and not (left_out and c.title.startswith(left_out))]
    results, made, storeys, refused, took = collections.defaultdict(list), 0, 0, 0, []
    try:
        for world, seconds in worlds(given, formats):
            took.extend([seconds] if seconds is not None else [])
            if world is None:
                refused += 1
                continue
            judged = [(c.title, found) for c in asked for found in judge(world, c)]
            for title, found in judged:
                results[title].append(found)
            made += 1
            storeys += len(json.loads((world / "world.json").read_text())["floorplan"].get("levels", [])) > 1
            refused += sum(not found["ok"] for _, found in judged)
    except KeyboardInterrupt:
        print("interrupted: the table is of the worlds that were judged whole")
    rows = [row(c.title, results[c.title]) for c in asked if results[c.title]]
    print("\n".join(rows))
    if given.table and rows:
        given.table.write_text(page(given.table.read_text(), rows, (made, storeys, which(given)), took, refusals(results)))
    print(f"simulators: {made} worlds, {len(asked)} consumers, {refused} refused")
    sys.exit(1 if refused or not rows else 0)


if __name__ == "__main__":
    os.environ.setdefault("PYTHONDONTWRITEBYTECODE", "1")
    main()
