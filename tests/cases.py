#!/usr/bin/env python3
"""Runs the cases of ../shared/cases: the smallest inputs of faults that users met, each with what it should give.

    tests/cases.py [FOLDER] [--program target/debug/d3dgen] [--only 01 10 ...]

A case is a folder `<nn>_<name>` with its inputs, README.md and EXPECTED.txt. What EXPECTED.txt says in words is a function
here, under its number in CHECKS; a case without one is named and not judged. Exit status 1 when a case gives something else.
"""
import argparse
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

SLOW_S = 600


class World:
    """What `furnish` or `generate` wrote, and what it said."""

    def __init__(self, done, folder):
        self.code, self.told = done.returncode, done.stderr
        self.folder = folder

    def document(self, name):
        path = self.folder / f"{name}.json"
        return json.loads(path.read_text()) if path.exists() else {}

    @property
    def rooms(self):
        return self.document("floorplan").get("rooms", [])

    @property
    def doors(self):
        return self.document("floorplan").get("doors", [])

    @property
    def notes(self):
        graph = self.document("scene_graph")
        return " ".join(n["message"] for key in ("assumptions", "conflicts") for n in graph.get(key, [])) + self.told

    def areas(self):
        return sorted(room["net_area_m2"] for room in self.rooms)

    def count(self, kind):
        placed = self.document("placements").get("placements", [])
        return sum(p["object"].split("_")[-1] == kind for p in placed)


class Bench:
    """The program, with a store of its own, in a folder that is thrown away."""

    def __init__(self, program, home):
        self.program, self.home, self.made = program, pathlib.Path(home), 0

    def run(self, *args):
        command = [str(self.program), *map(str, args)]
        environment = {**os.environ, "D3DGEN_STORE": ""}
        return subprocess.run(command, capture_output=True, text=True, env=environment, timeout=SLOW_S)

    def world(self, *args):
        self.made += 1
        folder = self.home / f"world_{self.made}"
        return World(self.run(*args, "--no-png", "--out", folder), folder)

    def furnish(self, plan, *flags):
        return self.world("furnish", plan, *flags)

    def generate(self, prompt, *flags):
        return self.world("generate", prompt, *flags)

    def write(self, name, text):
        path = self.home / name
        path.write_text(text)
        return path


def expect(truth, message):
    if not truth:
        raise AssertionError(message)


def same_rooms(world, plain, off=0.03):
    a, b = world.areas(), plain.areas()
    expect(len(a) == len(b), f"{len(a)} rooms, not {len(b)}: {world.told[-300:]}")
    expect(all(abs(x / y - 1) <= off for x, y in zip(a, b)), f"areas {a}, not {b}")


def says(world, *words):
    missing = [w for w in words if w.lower() not in world.notes.lower()]
    expect(not missing, f"no note says {missing}: {world.notes[-600:]}")


def prompts(case):
    return [line.strip() for line in (case / "prompts.txt").read_text().splitlines() if line.strip()]


def furniture_layer(bench, case):
    plain = bench.furnish(case / "d_walls_only.dxf")
    expect(len(plain.rooms) == 2, "the walls alone are two rooms")
    for name in ("d_furn_slanted.dxf", "d_furn_straight.dxf"):
        world = bench.furnish(case / name)
        same_rooms(world, plain)
        says(world, "Furnitures")


def columns(bench, case):
    world = bench.furnish(case / "d_columns_circle.dxf")
    solid = world.document("floorplan").get("obstacles", [])
    expect(len(solid) == 2 and all(o["kind"] == "column" for o in solid), f"obstacles {solid}")
    says(world, "COLUMN")


def wall_ends(bench, case):
    world = bench.furnish(case / "rmf_small.building.yaml")
    rules = world.document("report").get("rules", [])
    expect(rules, f"no report: {world.told[-300:]}")
    jambs = [v for r in rules if r["rule"] == "door_jamb" for v in r["violations"]]
    expect(not jambs, f"{jambs}")


def free_wall(bench, case):
    world = bench.furnish(case / "free_wall.yaml")
    same_rooms(world, bench.furnish(case / "plain.yaml"))
    walls = [o for o in world.document("floorplan").get("obstacles", []) if o["kind"] == "wall"]
    expect(len(walls) == 1, f"{len(walls)} walls stand free")
    xs, ys = ([p[k] for p in walls[0]["outline"]] for k in ("x", "y"))
    expect(max(max(xs) - min(xs), max(ys) - min(ys)) > 1.5, f"the wall is {walls[0]['outline']}")


def room_feature(name, box, kind="room"):
    x0, y0, x1, y1 = box
    ring = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]
    return {"type": "Feature", "properties": {"name": name, "kind": kind},
            "geometry": {"type": "Polygon", "coordinates": [ring]}}


def door_feature(x0, y0, x1, y1):
    return {"type": "Feature", "properties": {"kind": "door"},
            "geometry": {"type": "LineString", "coordinates": [[x0, y0], [x1, y1]]}}


def collection(features):
    return json.dumps({"type": "FeatureCollection", "features": features})


def main_room(bench, _):
    hall = [room_feature("", (0, 0, 40, 25)), room_feature("Office", (40, 0, 45, 6)), door_feature(40, 2, 40, 3),
            door_feature(10, 0, 13, 0)]
    world = bench.furnish(bench.write("small_warehouse.geojson", collection(hall)))
    largest = max(world.rooms, key=lambda r: r["net_area_m2"])
    expect(largest["room_type"] not in ("room", "office"), f"the hall is of the type {largest['room_type']}")
    says(world, "guess")
    corridor = [room_feature("Corridor", (0, 5, 24, 7))]
    for k in range(6):
        corridor += [room_feature("", (4 * k, 7, 4 * k + 4, 13)), door_feature(4 * k + 1, 7, 4 * k + 2, 7)]
    corridor += [room_feature("Lobby", (0, 0, 24, 5)), door_feature(11, 5, 12.5, 5), door_feature(3, 0, 5, 0)]
    world = bench.furnish(bench.write("hotel.geojson", collection(corridor)))
    kinds = [r["room_type"] for r in world.rooms]
    expect(kinds.count("guest_room") + kinds.count("hotel_room") == 6, f"rooms are {kinds}")
    says(world, "guess")


def large_hall(bench, _):
    begun = resource.getrusage(resource.RUSAGE_CHILDREN)
    world = bench.furnish(bench.write("hall.geojson", collection(
        [room_feature("", (0, 0, 190, 60)), room_feature("Lounge", (0, 60, 20, 75)), door_feature(4, 60, 5, 60),
         door_feature(90, 0, 93, 0)])))
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
    expect(len(world.rooms) == 2, world.told[-300:])
    expect(spent < 30, f"{spent:.0f} s of CPU")


def venue(bench, case):
    for name in ("imdf", "venue.zip", "imdf_all.geojson"):
        world = bench.furnish(case / name)
        expect(len(world.rooms) == 6, f"{name}: {len(world.rooms)} rooms: {world.told[-300:]}")
        expect(len(world.doors) >= 5, f"{name}: {len(world.doors)} doors")
        says(world, "fixture")


def unnamed_path(bench, case):
    world = bench.furnish(case / "s_door_path.svg")
    same_rooms(world, bench.furnish(case / "s_plain.svg"))
    says(world, "path")


def unknown_layer(bench, case):
    plan, layer = case / "d_unknown_layer_lines.dxf", "A-210 G - Existing Structure"
    world = bench.furnish(plan)
    told = bool(world.rooms) or (world.code == 2 and layer in world.told and "4" in world.told and "--layer" in world.told)
    expect(told, f"exit {world.code}: {world.told[-300:]}")
    world = bench.furnish(plan, "--layer", f"{layer}=wall")
    expect(len(world.rooms) == 1, f"with --layer: {world.told[-300:]}")


def assets(bench, folder, *words):
    store = bench.home / f"store_{folder.name}"
    done = bench.run("assets", "ingest", folder, "--json", "--store", store)
    expect(done.returncode == 0, done.stderr[-300:])
    done = bench.run("assets", "list", "--json", "--limit", "10000", "--store", store)
    expect(done.returncode == 0, done.stderr[-300:])
    return [json.loads(line) for line in done.stdout.splitlines()]


def inspected(bench, path):
    done = bench.run("assets", "inspect", path, "--json")
    expect(done.returncode == 0, done.stderr[-300:])
    found = []
    for line in done.stdout.splitlines():
        box = json.loads(line).get("bbox_zup") or json.loads(line).get("bbox_stage")
        found.append([box[1][i] - box[0][i] for i in range(3)] if box else None)
    return found


def near(size, expected, off=0.003):
    return size is not None and all(abs(a - b) <= off for a, b in zip(sorted(size), sorted(expected)))


def collision_meshes(bench, case):
    ids = sorted(str(a.get("asset_id") or a.get("id") or a.get("name")) for a in assets(bench, case / "a"))
    expect(not [i for i in ids if "collision" in i], f"assets {ids}")
    for name in ("wardrobe_small", "side_table_boxes", "cabinet_two_parts"):
        expect(sum(name in i for i in ids) == 1, f"{name} among {ids}")
    for name, size in (("side_table_boxes", (1.2, 0.6, 0.745)), ("cabinet_two_parts", (0.8, 0.4, 1.8))):
        found = inspected(bench, case / "a" / name / "model.sdf")
        expect(found and near(found[0], size), f"{name} is {found}")


def name_and_unit(bench, case):
    found = inspected(bench, case / "washer" / "model.sdf")
    expect(found and near(found[0], (0.035, 0.035, 0.002), 0.001), f"{found}")


def arena_address(bench, case):
    found = inspected(bench, case / "static/office_desk/sdf/office_desk.sdf")
    expect(found and near(found[0], (1.6, 0.8, 0.75)), f"{found}")


def one_room(bench, case):
    for prompt in prompts(case):
        world = bench.generate(prompt)
        expect(len(world.rooms) == 1, f"{prompt}: {len(world.rooms)} rooms")


def room_size(bench, case):
    for prompt in prompts(case):
        world = bench.generate(prompt)
        sides = sorted(float(n) for n in re.search(r"(\d+)\s*m\s*x\s*(\d+)\s*m", prompt).groups())
        expect(len(world.rooms) == 1, f"{prompt}: {len(world.rooms)} rooms")
        net = world.rooms[0]["net_polygon"]
        xs, ys = [p["x"] for p in net], [p["y"] for p in net]
        found = sorted([max(xs) - min(xs), max(ys) - min(ys)])
        expect(all(abs(a / b - 1) <= 0.05 for a, b in zip(found, sides)), f"{prompt}: {found}")


def objects(bench, case):
    wanted = ({"desk": 3, "chair": 3}, {"desk": 3, "chair": 3}, {"desk": 2})
    for prompt, counts in zip(prompts(case), wanted):
        world = bench.generate(prompt)
        for kind, number in counts.items():
            # chairs follow their desks: what is said of one says it of both
            told = re.search(rf"{number} [\w ]*({'|'.join(counts)})s? asked for, \d+ (?:built|there)", world.told)
            told = told or f"not as asked `{number} {kind}s`" in world.told
            expect(world.count(kind) == number or told, f"{prompt}: {world.count(kind)} of {kind}: {world.told[-300:]}")


def classroom(bench, case):
    for prompt in prompts(case):
        world = bench.generate(prompt)
        kinds = [r["room_type"] for r in world.rooms]
        expect(kinds == ["classroom"], f"{prompt}: {kinds}: {world.told[-200:]}")


def unknown_building(bench, case):
    for prompt in prompts(case):
        world = bench.generate(prompt)
        if world.code == 2:
            expect("office" in world.told and "hospital" in world.told, f"{prompt}: {world.told[-300:]}")
        else:
            expect(len(world.rooms) == 1, f"{prompt}: {len(world.rooms)} rooms")


def comparison(bench, case):
    out = bench.home / "danish"
    done = bench.run("research", "--domain", "residential", "--country", "DK", "--documents", case / "rda",
                     "--offline", "--out", out)
    expect(done.returncode == 0, done.stderr[-300:])
    found = [json.loads(line) for line in (out / "constraints.jsonl").read_text().splitlines()]
    of = [c for c in found if "2,5" in json.dumps(c, ensure_ascii=False)]
    expect(all(c.get("constraint_type", c.get("type")) == "maximum" for c in of), f"{of}")


def french_search(bench, case):
    store = bench.home / "rules"
    for line in prompts(case):
        words, country, _ = (part.strip() for part in line.split("|"))
        done = bench.run("knowledge", "search", *words.split(), "--country", country, "--limit", "3", "--store", store)
        found = done.stdout.lower()
        expect("corridor" in found or "hallway" in found, f"{line}: {done.stdout[:600]}{done.stderr[-200:]}")
        expect("width" in found, f"{line}: {done.stdout[:600]}")


def reads_and_refusals(bench, case):
    plain = bench.furnish(case / "negate.yaml")
    expect(plain.rooms, plain.told[-300:])
    same_rooms(bench.furnish(case / "rgba.yaml"), plain)
    world = bench.furnish(case / "nan.yaml")
    same_rooms(world, plain)
    says(world, "yaw")
    expect(bench.furnish(case / "yaw.yaml").code in (0, 1, 2), "a turned map is read or refused")
    indoor = bench.furnish(case / "osm_indoor.geojson")
    expect(len(indoor.rooms) == 4, f"{len(indoor.rooms)} rooms: {indoor.told[-300:]}")
    ifc = bench.write("model.ifc", "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\nENDSEC;\n")
    refused = bench.furnish(ifc)
    expect(refused.code == 2 and "IFC" in refused.told and "DXF" in refused.told, refused.told[-300:])


CHECKS = {
    "01": furniture_layer, "03": columns, "05": wall_ends, "06": free_wall, "08": main_room, "09": large_hall,
    "10": venue, "12": unnamed_path, "14": unknown_layer, "16": collision_meshes, "18": name_and_unit,
    "20": arena_address, "22": one_room, "24": room_size, "26": objects, "28": classroom, "30": unknown_building,
    "32": comparison, "34": french_search, "36": reads_and_refusals,
}


def main():
    here = pathlib.Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=here.parent / "shared/cases")
    parser.add_argument("--program", type=pathlib.Path, default=here / "target/debug/d3dgen")
    parser.add_argument("--only", nargs="+", metavar="NN")
    asked = parser.parse_args()
    cases = sorted(d for d in asked.folder.glob("[0-9][0-9]_*") if (d / "EXPECTED.txt").is_file())
    if not cases:
        print(f"skipped: the cases of users, {asked.folder} is not here")
        return 0
    wrong = passed = 0
    for case in cases:
        number = case.name[:2]
        if asked.only and number not in asked.only:
            continue
        if number not in CHECKS:
            print(f"{case.name}: not judged, tests/cases.py has no check for it")
            continue
        with tempfile.TemporaryDirectory() as home:
            try:
                CHECKS[number](Bench(asked.program.resolve(), home), case)
            except (AssertionError, OSError, ValueError, LookupError, TypeError, subprocess.TimeoutExpired) as fault:
                wrong += 1
                print(f"{case.name}: FAILED: {fault}")
                continue
        passed += 1
        print(f"{case.name}: ok")
    print(f"cases of users: {passed} right, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
