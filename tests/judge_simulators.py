#!/usr/bin/env python3
"""Makes worlds and has the consumers' own code load and step them, then writes what came of it as a table.

Usage: judge_simulators.py --kit FOLDER [--program d3dgen] [--worlds N] [--formats LIST] [--out FOLDER] [--write docs/simulators.md]

The kit is the folder of acceptance checks (check_mjcf.py, check_sdf.py, check_usd.py, check_glb.mjs, check_nav2.py,
check_rmf.py), installed by its setup.sh. Worlds are those of PROMPTS, in turn of domains, seed by place in the list. Every
figure is what a check printed; nothing is rounded up. Exit status 0 when every world is accepted by every check that ran.
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
        "studio flat with a balcony",
        "house on 2 floors with three bedrooms, for a cleaning robot",
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
}


def last_json(command, timeout=900):
    """Runs a check; returns what it printed last as JSON, and how long it took."""
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
    """One row of the table: what it is called, the format it reads, and how it is asked."""

    def __init__(self, title, format, commands, figures):
        self.title, self.format, self.commands, self.figures = title, format, commands, figures


def consumers(kit, python):
    """The consumers; each gives the commands for a world's folder and reads figures from the facts printed."""
    sdf = lambda f, out: out.update(bodies=f.get("gazebo_dynamic_bodies"), joints=f.get("gazebo_joints"), drift=f.get("gazebo_max_drift_m"))

    def mjcf(f, out):
        out.update(
            bodies=f.get("settle_free_bodies"),
            stable=f.get("settle_stable_percent"),
            penetration=f.get("settle_max_penetration_m"),
            joints=f.get("doors"),
            doors_open=f.get("doors_open_percent"),
            doorways=f.get("sweep_paths"),
            doorways_open=f.get("sweep_open"),
        )

    def usd(f, out):
        out.update(doorways=f.get("sweep_paths"), doorways_open=f.get("sweep_open"), bodies=f.get("newton_dynamic_bodies"), drift=f.get("newton_max_drift_m"), joints=f.get("newton_joints"))

    nothing = lambda f, out: None
    check = lambda name: [python, kit / name]
    return [
        Consumer("MuJoCo", "mujoco", lambda w: [[*check("check_mjcf.py"), w / "mujoco/world.xml", "--settle", "--doors", "--path", w / "mujoco/paths.json"]], mjcf),
        Consumer("Gazebo Fortress (libsdformat, DART)", "gazebo", lambda w: [[*check("check_sdf.py"), w / "gazebo/world.sdf"]], sdf),
        Consumer("USD, Newton", "usd", lambda w: [[*check("check_usd.py"), w / "usd/world.usda", "--world", w / "usd/manifest.json", "--path", w / "usd/paths.json"]], usd),
        Consumer("glTF (Khronos validator)", "gltf", lambda w: [["node", kit / "check_glb.mjs", *sorted((w / "gltf").glob("*.glb"))]], nothing),
        Consumer("nav2 (map, graph, masks)", "nav2", lambda w: [[*check("check_nav2.py"), w / "nav2", "--radius", "0.25"]], nothing),
        Consumer("Open-RMF (rmf_site_format)", "rmf", lambda w: [[*check("check_rmf.py"), b, "--radius", "0.25"] for b in sorted((w / "rmf").glob("*.building.yaml"))], nothing),
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


def row(consumer, results):
    """A line of the table from the figures of all worlds."""
    total = lambda key: sum(r[key] for r in results if r.get(key) is not None)
    known = [r for r in results if r.get("stable") is not None]
    bodies = sum(r["bodies"] or 0 for r in known)
    stable = sum(round((r["bodies"] or 0) * r["stable"] / 100) for r in known)
    drift = [r["drift"] for r in results if r.get("drift") is not None]
    held = share(stable, bodies) if known else (f"{total('bodies')} move at most {max(drift) * 1000:.1f} mm" if drift else "-")
    opened = [r for r in results if r.get("doors_open") is not None]
    doors = share(sum(round(r["joints"] * r["doors_open"] / 100) for r in opened), sum(r["joints"] for r in opened)) if opened else "-"
    if not opened and total("joints"):
        refused = sum(r["joints_refused"] for r in results)
        doors = share(total("joints") - refused, total("joints"))
    cells = [
        consumer.title,
        share(sum(r["ok"] for r in results), len(results)),
        held,
        doors,
        share(total("doorways_open"), total("doorways")),
        share(total("reached"), total("rooms")),
        f"{statistics.median(r['seconds'] for r in results):.1f}",
    ]
    return "| " + " | ".join(cells) + " |"


SECTION = "## How they are judged"


def page(before, rows, worlds, storeys, wrote):
    """The page with the section of figures written anew."""
    return before.split(SECTION)[0] + "\n".join(
        [
            SECTION,
            "",
            f"Measured on {worlds} worlds of homes, offices and hospitals, {storeys} of several storeys, with the consumers' own code, headless, by",
            "`python tests/judge_simulators.py --kit FOLDER --write docs/simulators.md`; the kit is a set of scripts that load and step a world",
            "and print what they found. Gazebo's graphics, sensors and plugins, RTX and PhysX are not part of it.",
            "",
            "| consumer | worlds accepted | things stable | doors to their limit and back | doorways open | rooms reached | seconds (median) |",
            "|---|---|---|---|---|---|---|",
            *rows,
            "",
            "*Stable*: a thing that can be moved ends less than 5 cm from where it was in the three seconds after the first, as MolmoSpaces",
            "asks of its scenes; for Gazebo, how far the least stable of all moved in two seconds. *Doorways*: a disc of 0.25 m radius, or",
            "what the narrowest door leaves, is carried through the middle of each and along the routes of robots. *Rooms reached*: joined",
            "to the main entrance by open doorways. *Seconds*: the check itself.",
            "",
            f"Writing all of these formats took {wrote}.",
            "",
        ]
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kit", type=Path, required=True)
    parser.add_argument("--program", default="target/debug/d3dgen")
    parser.add_argument("--worlds", type=int, default=sum(map(len, PROMPTS.values())))
    parser.add_argument("--formats", default="mujoco,gazebo,usd,gltf,nav2,rmf")
    parser.add_argument("--out", type=Path, default=Path("target/simulators"))
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    known = subprocess.run([given.program, "version"], capture_output=True, text=True).stdout
    formats = [f for f in given.formats.split(",") if f in known]
    asked = [c for c in consumers(given.kit, sys.executable) if c.format in formats]
    turn = [p for group in zip(*PROMPTS.values()) for p in group][: given.worlds]
    results, storeys, refused, took = collections.defaultdict(list), 0, 0, []
    for seed, prompt in enumerate(turn, 1):
        world = given.out / f"{seed:02}"
        begun = time.monotonic()
        done = subprocess.run([given.program, "generate", prompt, "--seed", str(seed), "--no-png", "--format", ",".join(formats), "--out", world], capture_output=True, text=True)
        took.append(time.monotonic() - begun)
        if not (world / "world.json").exists():
            print(f"{prompt}: not made: {done.stderr[-300:]}")
            refused += 1
            continue
        storeys += len(json.loads((world / "world.json").read_text())["floorplan"].get("levels", [])) > 1
        for consumer in asked:
            for command in consumer.commands(world):
                verdict, seconds = last_json(command)
                codes = collections.Counter(f["code"] for f in verdict.get("failures", []))
                found = {"ok": verdict.get("ok", False), "seconds": seconds, "joints_refused": codes["joint_blocked"]}
                consumer.figures(verdict.get("facts", {}), found)
                if found.get("doorways") is not None:
                    found["reached"], found["rooms"] = rooms_reached(world, verdict)
                results[consumer.title].append(found)
                if not found["ok"]:
                    refused += 1
                    for failure in verdict.get("failures", [])[:6]:
                        print(f"{seed:02} {consumer.format}: {failure['code']}: {failure['message'][:220]}")
        sys.stdout.flush()
    rows = [row(c, results[c.title]) for c in asked if results[c.title]]
    print("\n".join(rows))
    if given.write:
        wrote = f"{statistics.median(took):.1f} s a world (median), making the world and starting the program included"
        given.write.write_text(page(given.write.read_text(), rows, len(turn), storeys, wrote))
    print(f"simulators: {len(turn)} worlds, {len(asked)} consumers, {refused} refused")
    sys.exit(1 if refused or not rows else 0)


if __name__ == "__main__":
    os.environ.setdefault("PYTHONDONTWRITEBYTECODE", "1")
    main()
