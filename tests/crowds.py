#!/usr/bin/env python3
"""Simulates worlds at three hours each and has the crowds judged by the kit's referee (check_crowd.py): nobody in a wall, none
stuck for 20 s, goals in order, no overlap, travel times within a factor of 1.3 of JuPedSim's on the same floor.

  crowds.py PROGRAM KIT OUT          a few worlds
  crowds.py PROGRAM KIT OUT --all    90 worlds: 30 sentences with three seeds each, of which no two are alike
"""
import json
import pathlib
import subprocess
import sys

WORLDS = [
    ("hospital ward with 8 patient rooms, for a delivery robot", ["shift_change", "morning_round", "night"]),
    ("office for 16 people with a reception, for a delivery robot", ["opening", "lunch", "day"]),
    ("two-bedroom flat for a couple", ["day", "evening", "night"]),
    ("airport terminal", ["boarding", "busy", "night"]),
    ("primary school with 4 classrooms and a canteen", ["school_break", "lunch", "opening"]),
    ("restaurant with 40 seats", ["lunch", "busy", "evening"]),
]
SECONDS = "300"
CARE = ["shift_change", "morning_round", "visiting"]
WORK = ["opening", "lunch", "closing"]
HOME = ["day", "evening", "night"]
PUBLIC = ["opening", "busy", "closing"]
MANY = [
    ("hospital ward with 6 patient rooms in Japan", CARE),
    ("hospital ward with 12 patient rooms in Germany, for two delivery robots", CARE),
    ("intensive care unit with 8 beds, for a disinfection robot", CARE),
    ("outpatient clinic with 6 exam rooms and a laboratory", PUBLIC),
    ("surgery department with 2 operating rooms", CARE),
    ("emergency department with 6 treatment rooms", CARE),
    ("dental practice with 4 treatment rooms in France", PUBLIC),
    ("office for 8 people", WORK),
    ("office for 30 people with 3 meeting rooms and a canteen, for a cleaning robot", WORK),
    ("law firm with 6 private offices and a library", WORK),
    ("call centre for 40 people", WORK),
    ("office on two floors for 24 people, for a delivery robot", WORK),
    ("coworking space with a cafe", WORK),
    ("studio flat in Tokyo", HOME),
    ("three-bedroom flat in Spain with a cleaning robot", HOME),
    ("bungalow with a garage for a family of four", HOME),
    ("two-storey house with 4 bedrooms", HOME),
    ("shared flat with 5 bedrooms", HOME),
    ("loft with an open kitchen and a home office", HOME),
    ("primary school with 6 classrooms, a gym and a canteen", ["school_break", "lunch", "opening"]),
    ("kindergarten with 3 groups", ["opening", "lunch", "closing"]),
    ("warehouse with a loading dock and an office, for three transport robots", ["shift_change", "day", "night"]),
    ("small airport terminal", ["boarding", "busy", "night"]),
    ("museum with 5 exhibition rooms and a shop", PUBLIC),
    ("hotel with 10 rooms and a breakfast room", ["morning_round", "busy", "evening"]),
    ("restaurant with 60 seats and a bar", ["lunch", "busy", "evening"]),
    ("supermarket with 4 tills", PUBLIC),
    ("public library with a reading room", PUBLIC),
    ("bank branch with 3 counters", PUBLIC),
    ("fitness club with changing rooms and a sauna", PUBLIC),
]
SEEDS = 3


def run(*command):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True)


def main():
    program, kit, out = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    clean = broken = 0
    chosen = [case for case in MANY for _ in range(SEEDS)] if "--all" in sys.argv[4:] else WORLDS
    for seed, (prompt, times) in enumerate(chosen, 1):
        world = out / str(seed)
        made = run(program, "generate", prompt, "--seed", seed, "--no-png", "--format", "tasks", "--out", world)
        if made.returncode:
            sys.exit(f"{prompt}: {made.stderr}")
        for time in times:
            folder = out / f"{seed}_{time}"
            made = run(program, "simulate", world, "--time", time, "--seconds", SECONDS, "--no-film", "--out", folder)
            if made.returncode:
                sys.exit(f"{prompt} at {time}: {made.stderr}")
            judged = run(sys.executable, kit / "check_crowd.py", folder / "trajectory.json", folder / "walkable.geojson", "--ratio", "0.77,1.3")
            verdict = json.loads(judged.stdout or "{}")
            facts = verdict.get("facts", {})
            print(f"{seed} {prompt} at {time}: {facts.get('agents')} people, {facts.get('robots')} robots, ratio {facts.get('travel_ratio')}")
            if judged.returncode:
                print("  ", judged.stdout or judged.stderr)
                broken += 1
            else:
                clean += 1
    print(f"{len(chosen)} worlds, {clean + broken} crowds")
    print(f"{clean} crowds move as the referee demands" if not broken else f"{broken} crowds are refused")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
