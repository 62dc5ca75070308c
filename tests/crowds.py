#!/usr/bin/env python3
"""Simulates a few worlds at three hours each and has the crowds judged by the kit's referee (check_crowd.py).

  crowds.py PROGRAM KIT OUT
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


def run(*command):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True)


def main():
    program, kit, out = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    clean = broken = 0
    for seed, (prompt, times) in enumerate(WORLDS, 1):
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
            print(f"{prompt} at {time}: {facts.get('agents')} people, {facts.get('robots')} robots, ratio {facts.get('travel_ratio')}")
            if judged.returncode:
                print("  ", judged.stdout or judged.stderr)
                broken += 1
            else:
                clean += 1
    print(f"{clean} crowds move as the referee demands" if not broken else f"{broken} crowds are refused")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
