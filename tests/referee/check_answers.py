#!/usr/bin/env python3
"""Compares what reports answer to each wish with a count of its own in the finished world.

    tests/referee/check_answers.py WORLD_FOLDER...                    judges worlds that were made
    tests/referee/check_answers.py --prompts FILE --program d3dgen    makes a world of each line of a file, and judges it
    tests/referee/check_answers.py --selftest WORLD_FOLDER...         tells what it finds in worlds whose answers are made false

Reads `world.json` (brief and documents), `report.json` (answers) and the words of `domains/*/*.toml`, and shares no code with the
program. Two kinds of faults: an answer says `honored` and the world has something else, or elsewhere; an answer says that a thing is
missing and the world has it where it was asked for. Exit status 1 when there is one.
"""
import argparse
import collections
import concurrent.futures
import copy
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).parents[2]
BED_FOR_TWO_M, BUNK_BED_M, BENCH_SEAT_M, SOFA_SEAT_M = 1.35, 1.4, 0.55, 0.65
AREA_MISS, ROOM_MISS = 0.15, 0.05
DESK = re.compile(r"(^|_)(desk|workstation|console)$")
SEAT = re.compile(r"chair|stool|bench|sofa|seat|couch|pew|armchair|bean_bag|cushion")
ASLEEP = re.compile(r"bed|patient|guest|resident|dorm")
BED = re.compile(r"(^|_)(bed|bunk|cot|futon)(_|$)|_bed$")


def words_of_domains():
    """Returns the words of each id, of rooms and of objects, over all domains; and what room types have in the place of others, by domain
    and kind of building."""
    words, means, kinds = collections.defaultdict(set), {}, []
    for path in sorted(ROOT.glob("domains/*/*.toml")):
        table = tomllib.loads(path.read_text(encoding="utf8"))
        for entry in table.get("room_types", []) + table.get("objects", []):
            if "id" in entry:
                lists = [*entry.get("keywords", {}).values(), *entry.get("called", {}).values()]
                words[entry["id"]] |= {w.lower() for ws in lists for w in ws}
        means |= {(path.parent.name, p["id"]): p.get("means", {}) for p in table.get("programs", [])}
        kinds += [(path.parent.name, b["id"], b.get("program")) for b in table.get("building_types", [])]
    return words, {(domain, kind): means.get((domain, program), {}) for domain, kind, program in kinds}


WORDS, MEANS = words_of_domains()


def as_id(name):
    return re.sub(r"\W", "_", name.lower()).strip("_")


def is_kind(found, asked):
    return found == asked or found.startswith(asked + "_") or found.endswith("_" + asked)


def fits(found, subject, means=None):
    """Returns whether an id of the world is what a name of the brief means."""
    asked = subject.get("id") or as_id(subject["name"])
    stands = means is not None and any(w in means and is_kind(found, means[w]) for w in (asked, "room" if ASLEEP.search(asked) else asked))
    return stands or is_kind(found, asked) or subject["name"].lower() in WORDS[found]


def allows(count, n):
    asked, bound = count["n"], count.get("bound", "exactly")
    return {"exactly": n == asked, "at_least": n >= asked, "at_most": n <= asked, "about": abs(n - asked) <= max(asked // 10, 1)}[bound]


class World:
    def __init__(self, world, report):
        self.brief, graph, self.plan = world["brief"], world["scene_graph"], world["floorplan"]
        self.graph, self.scenario = graph, world["scenario"]
        self.means = MEANS.get((graph["domain"], graph.get("building_type")), {})
        self.rooms = {r["id"]: r for r in graph["rooms"]}
        self.areas = {r["room_id"]: r["net_area_m2"] for r in self.plan["rooms"]}
        self.things = {p["placement_id"]: p for p in world["placements"]["placements"]}
        self.answers = {a["ask_id"]: a for a in report["asks"]}
        self.asks = {a["id"]: (a, *next(iter(a["fact"].items()))) for a in self.brief["asks"]}
        self.points = {p["poi_id"]: p["room_id"] for p in self.scenario["pois"]}

    def named(self, room, subject):
        """Returns whether a room has the name, or is of the type, that the brief says."""
        plain, asked = as_id(re.sub(r"\s*\d+$", "", room["name"])), as_id(subject["name"])
        entered = subject.get("id") == "entrance" and room["entrance"]
        return entered or fits(room["room_type"], subject, self.means) or plain in (asked, asked.removesuffix("s"))

    def rooms_of(self, subject, exact=False):
        """Returns the rooms that a name may mean."""
        found = [r for r in self.rooms.values() if self.named(r, subject)]
        own = [r for r in found if r["room_type"] == subject.get("id")]
        return own if exact and own else found

    def asked_rooms(self, subject):
        """Returns the ids that answer the wishes for rooms of a name, and whether there is such a wish."""
        same = [self.answers[i] for i, (_, kind, fact) in self.asks.items()
                if kind == "rooms" and not fact.get("among") and fact["room"] == subject]
        return {i for a in same for i in a.get("ids", [])}, bool(same)

    def in_room(self, room_id):
        return [p for p in self.things.values() if p["room_id"] == room_id]

    def desks(self, rooms):
        return sum(bool(DESK.search(p["object"])) for r in rooms for p in self.in_room(r))

    def seats_on(self, p):
        name, width = p["object"], p["size_m"][0]
        if not SEAT.search(name):
            return 0
        if re.search("sofa|couch", name):
            return max(int(width / SOFA_SEAT_M), 1)
        return max(int(width / BENCH_SEAT_M + 1e-9), 1) if re.search("bench|seating|seats$|pew|row", name) else 1

    def seats(self, rooms, guests=False):
        standing = [p for r in rooms for p in self.in_room(r) if not (guests and re.search("swivel|task_chair", p["object"]))]
        return sum(map(self.seats_on, standing))

    def commonest(self, rooms):
        """The objects of the kind that most people sit on, and the seats on them."""
        kinds = collections.defaultdict(list)
        for p in (p for r in rooms for p in self.in_room(r) if SEAT.search(p["object"]) and "swivel" not in p["object"]):
            kinds[p["object"]].append(self.seats_on(p))
        most = max(kinds.values(), key=sum, default=[])
        return {len(most), sum(most)}

    def beds(self, rooms, sleepers=False):
        beds = [p for r in rooms for p in self.in_room(r) if BED.search(p["object"])]
        return sum((1 + (p["size_m"][0] >= BED_FOR_TWO_M)) * (1 + (p["size_m"][2] >= BUNK_BED_M)) if sleepers else 1 for p in beds)

    def is_later(self, first, second):
        """Returns whether a wish names rooms again: by the same name alone, in another sentence, or within the words of another fact."""
        if next(iter(second["fact"].values())) == {"room": next(iter(first["fact"].values()))["room"], "count": {"n": 1, "bound": "at_least"}}:
            return True
        sums = [sum(k == "rooms" and not f.get("among") and a["words"] == x["words"] for x, k, f in self.asks.values()) > 1 for a in (first, second) if a["words"]]
        if any(sums):
            return True
        ends = [(w[-1]["start"], w[-1]["end"]) for w in (first["words"], second["words"]) if w]
        if len(ends) < 2:
            return True
        (_, a), (b, _) = sorted(ends)
        within = any(w["start"] <= s and e <= w["end"] for x, kind, _ in self.asks.values() if kind in ("relation", "robots", "forbidden")
                     for w in x["words"] for s, e in ends)
        return within or bool(re.search(r"\.(\s|$)|[!?\n。！？]", self.brief["prompt"][a:b]))

    def touching(self, ask):
        """Returns words that nobody read and that stand at those of a wish."""
        if not ask["words"]:
            return []
        own, prompt = dict(ask["words"][-1]), self.brief["prompt"]
        fact = next(iter(ask["fact"].values()))
        name = (fact.get("object") or (fact.get("room") if "count" in fact and "of" not in fact else None) or {}).get("name", "")
        if name and name in own["text"]:
            own["start"] += own["text"].index(name)
            own["end"] = own["start"] + len(name)
        def gap(w):
            a, b = sorted((own, w), key=lambda x: x["start"])
            return prompt[a["end"]:b["start"]]
        return [w["text"] for w in self.brief["not_understood"] if re.fullmatch(r"[ \-'’‑]*", gap(w))]


def judge_rooms(world, ask, fact, answer):
    ids = answer.get("ids", [])
    rooms = [world.rooms[i] for i in ids if i in world.rooms]
    if fact.get("among"):
        return
    level = fact.get("level")
    if answer["fate"] == "honored":
        if len(rooms) != len(ids) or not allows(fact["count"], len(rooms)):
            yield f"{len(rooms)} rooms"
        for room in rooms:
            known = bool(WORDS[room["room_type"]])
            if not world.named(room, fact["room"]):
                yield f"{room['id']} is no such room"
            elif known and not fits(room["room_type"], fact["room"], world.means) and not room["entrance"]:
                yield f"{room['id']} has only the name"
            elif not known and not any(p["mount"] == "floor" for p in world.in_room(room["id"])):
                yield f"{room['id']} is empty"
            if level is not None and room.get("level", 0) != level:
                yield f"{room['id']} is on level {room.get('level', 0)}"
        for other, kind, _ in world.asks.values():
            theirs = world.answers[other["id"]]
            shared = set(ids) & set(theirs.get("ids", []))
            if kind == "rooms" and other["id"] < ask["id"] and theirs["fate"] == "honored" and shared and not next(iter(other["fact"].values())).get("among") \
                    and not world.is_later(other, ask):
                yield f"{sorted(shared)} answer {other['id']} too"
    elif not ids or answer.get("unit") == "" and answer.get("measured", 0) < answer.get("asked", 0):
        taken = {i for a in world.answers.values() if a["kind"] == "rooms" for i in a.get("ids", [])}
        free = [r["id"] for r in world.rooms.values() if r["room_type"] == fact["room"].get("id") and level in (None, r.get("level", 0)) and r["id"] not in taken]
        joins = fact["room"].get("id") in ("elevator", "stairwell") and not world.graph.get("links")
        if free and not joins:
            yield f"{free} are there"


def judge_objects(world, ask, fact, answer):
    things = [world.things[i] for i in answer.get("ids", []) if i in world.things]
    rooms, asked = world.asked_rooms(fact["room"]) if fact.get("room") else (set(world.rooms), True)
    rooms = rooms if asked else {r["id"] for r in world.rooms_of(fact["room"])}
    if answer["fate"] == "honored":
        if not allows(fact["count"], len(things)) and not fact.get("each_room"):
            yield f"{len(things)} objects"
        for thing in things:
            if not fits(thing["object"], fact["object"]):
                yield f"{thing['placement_id']} is no such thing"
            if thing["room_id"] not in rooms:
                yield f"{thing['placement_id']} stands elsewhere"
        if fact.get("each_room") and fact.get("room") and {t["room_id"] for t in things} != rooms:
            yield "not each of the rooms has one"
    elif answer.get("measured", 0) < answer.get("asked", 0) and not fact.get("attributes") and not fact.get("each_room"):
        there = [t for t in world.things.values() if t["object"] == fact["object"].get("id") and t["room_id"] in rooms]
        if len(there) > answer["measured"] and len(there) >= fact["count"]["n"] and len(rooms) < 2:
            yield f"{len(there)} are there"


def judge_capacity(world, ask, fact, answer):
    kind, n = fact["of"] if "of" in fact else "seats", fact["count"]["n"]
    if kind not in ("seats", "desks", "beds") or not fact.get("room"):
        if kind == "desks" and answer["fate"] == "honored" and not allows(fact["count"], sum(i in world.things for i in answer["ids"])):
            yield f"{len(answer['ids'])} desks"
        return
    rooms, asked = world.asked_rooms(fact["room"])
    rooms = sorted(rooms if asked else {r["id"] for r in world.rooms_of(fact["room"])})

    def counts(rooms):
        if kind == "desks":
            return {world.desks(rooms)}
        if kind == "beds":
            return {world.beds(rooms)}
        lying = sum("couch" in p["object"] or "chair" in p["object"] or BED.search(p["object"]) is not None for r in rooms for p in world.in_room(r))
        return {world.desks(rooms), world.seats(rooms), world.seats(rooms, guests=True), lying} | world.commonest(rooms)

    def holds(rooms):
        over = max(n // 10, 2) if kind == "seats" and fact["count"].get("bound", "exactly") == "exactly" else 0
        return any(allows(fact["count"], c) or n <= c <= n + over for c in counts(rooms))

    if fact.get("each_room") or fact.get("of_rooms"):
        so = sum(holds([r]) for r in rooms)
        kept = so >= (fact.get("of_rooms") or len(rooms)) and so > 0
    else:
        kept = holds(rooms)
    if kept != (answer["fate"] == "honored") and not world.touching(ask):
        yield f"{'kept' if kept else 'not kept'} by a count in {rooms}: {sorted(counts(rooms))}"


def judge_people(world, ask, fact, answer):
    everywhere = list(world.rooms)
    most = max(world.beds(everywhere, sleepers=True), world.desks(everywhere), world.seats(everywhere, guests=True))
    if answer["fate"] == "honored" and (fact["count"]["n"] > most or answer.get("measured", 0) > max(most, 1)):
        yield f"the building has {most} places of a kind at most"


def judge_relation(world, ask, fact, answer):
    if answer["fate"] != "honored" or fact["relation"] not in ("door", "next_to", "only_from", "open_to"):
        return
    (a, known), (b, _) = world.asked_rooms(fact["a"]), world.asked_rooms(fact["b"])
    if not known or not b:
        return
    doors = [set(d["room_ids"]) for d in world.plan["doors"]]
    walls = [set(w["room_ids"]) for w in world.plan["walls"]] if fact["relation"] == "next_to" else []
    named = set(answer.get("ids", []))
    for room in a & named:
        if not any(room in pair and pair & (b - {room}) for pair in doors + walls):
            yield f"{room} is not so"


def judge_robots(world, ask, fact, answer):
    if answer["fate"] != "honored":
        return
    robots = [t for t in world.scenario["robots"] if t["robot"]["kind"] == fact["kind"] or fact["kind"] in ("", "service")]
    goals = {world.points[g] for t in robots for g in t["goals"] + [p for j in t.get("jobs", []) for p in [*j.get("to", []), *([j["from"]] if j.get("from") else [])]]}
    for subject in fact.get("keep_out", []):
        for room in world.rooms_of(subject, exact=True):
            if room["id"] in goals:
                yield f"it goes to {room['id']}"
    for task in fact.get("tasks", []):
        resting = task["verb"] in ("wait", "charge", "park")
        at = {world.points[t["dock"]] for t in robots if t.get("dock")} if resting else goals
        for subject in task.get("to", []) + ([task["from"]] if task.get("from") else []):
            rooms = {r["id"] for r in world.rooms_of(subject, exact=True)}
            if rooms and not rooms & at:
                yield f"{'it rests' if resting else 'it goes'} elsewhere than {subject['name']}"


def judge_whole(world, ask, fact, answer):
    kind = answer["kind"]
    if kind == "storeys":
        kept = allows(fact["count"], len({r.get("level", 0) for r in world.rooms.values()}))
        if kept < (answer["fate"] == "honored"):
            yield "other storeys"
    if kind == "area" and fact.get("bound", "exactly") in ("exactly", "about"):
        kept = abs(sum(world.areas.values()) - fact["area_m2"]) <= AREA_MISS * fact["area_m2"] + 0.01
        if kept != (answer["fate"] == "honored"):
            yield f"the floor is {sum(world.areas.values()):.1f} m2"
    if kind == "forbidden" and answer["fate"] == "honored" and fact.get("object", {}).get("id") in {t["object"] for t in world.things.values()} and not fact.get("within"):
        yield "it is there"


JUDGES = {"rooms": judge_rooms, "objects": judge_objects, "capacity": judge_capacity, "people": judge_people, "relation": judge_relation,
          "robots": judge_robots, "storeys": judge_whole, "area": judge_whole, "forbidden": judge_whole}


def judge(world):
    """Returns what is false in the answers of a world, a line each."""
    faults = []
    for ask_id, (ask, kind, fact) in world.asks.items():
        answer = world.answers.get(ask_id)
        if answer is None:
            faults.append(f"{ask_id}: no answer")
            continue
        found = list(JUDGES.get(kind, lambda *_: ())(world, ask, fact, answer))
        if answer["fate"] == "honored" and kind in ("rooms", "objects", "capacity", "robots") and world.touching(ask):
            found.append(f"{world.touching(ask)} was not read")
        if answer["fate"] == "honored" and answer.get("reason") or answer["fate"] != "honored" and not answer.get("reason"):
            found.append("a reason is said of what is not as asked, and of nothing else")
        faults += [f"{ask_id} `{answer['said']}` {answer['fate']}: {line}" for line in found]
    return faults


def load(folder):
    read = lambda name: json.loads((pathlib.Path(folder) / name).read_text(encoding="utf8"))
    return read("world.json"), read("report.json")


# What is made false in turn: a name, which answers it suits, and what is done to the documents.
def defects(world, report):
    for answer in report["asks"]:
        if answer["fate"] == "honored" and answer["kind"] in ("rooms", "objects") and answer.get("ids"):
            yield f"{answer['kind']} {answer['ask_id']} is not there", drop(world, answer["ids"][0])
        if answer["fate"] == "honored" and answer["kind"] == "objects" and answer.get("ids"):
            yield f"objects {answer['ask_id']} stand elsewhere", move(world, report, answer)


def drop(world, thing):
    world = copy.deepcopy(world)
    things = world["placements"]["placements"]
    things[:] = [p for p in things if p["placement_id"] != thing]
    world["scene_graph"]["rooms"][:] = [r for r in world["scene_graph"]["rooms"] if r["id"] != thing]
    return world


def move(world, report, answer):
    fact = next(a["fact"]["objects"] for a in world["brief"]["asks"] if a["id"] == answer["ask_id"])
    if not fact.get("room"):
        return None
    world = copy.deepcopy(world)
    own = {i for a in report["asks"] if a["kind"] == "rooms" for i in a.get("ids", [])}
    for thing in world["placements"]["placements"]:
        if thing["placement_id"] == answer["ids"][0]:
            other = [r["id"] for r in world["scene_graph"]["rooms"] if r["circulation"] and r["id"] not in own]
            if not other:
                return None
            thing["room_id"] = other[0]
    return world


def selftest(folders):
    tried = missed = 0
    for folder in folders:
        world, report = load(folder)
        for name, false in defects(world, report):
            if false is None:
                continue
            tried += 1
            if not judge(World(false, report)):
                missed += 1
                print(f"{folder}: not found: {name}")
    print(f"{tried} false answers, {tried - missed} found")
    return missed or tried < 10


def make(program, prompt, folder, seed):
    command = [program, "generate", prompt, "--seed", str(seed), "--no-png", "--format", "plan", "--out", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    return done.returncode, (done.stderr or done.stdout).strip().splitlines()[-1:]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("worlds", nargs="*")
    parser.add_argument("--prompts", type=pathlib.Path)
    parser.add_argument("--program", default="target/debug/d3dgen")
    parser.add_argument("--out", help="folder for the worlds that are made; else one that is thrown away")
    parser.add_argument("--selftest", action="store_true")
    args = parser.parse_args()
    folders, unmade = list(args.worlds), []
    home = args.out or (tempfile.TemporaryDirectory().__enter__() if args.prompts else None)
    if args.prompts:
        prompts = [line.strip() for line in args.prompts.read_text(encoding="utf8").splitlines() if line.strip() and not line.startswith("#")]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            jobs = [(pathlib.Path(home) / f"{i:02}", prompt, i) for i, prompt in enumerate(prompts, 1)]
            for (folder, prompt, _), (code, told) in zip(jobs, pool.map(lambda j: make(args.program, j[1], j[0], j[2]), jobs)):
                (folders if (folder / "world.json").exists() else unmade).append(str(folder) if code == 0 else f"{prompt[:60]}: {told}")
    if args.selftest:
        sys.exit(bool(selftest(folders)))
    answers, faults = 0, []
    for folder in folders:
        if not (pathlib.Path(folder) / "world.json").exists():
            continue
        world = World(*load(folder))
        answers += len(world.answers)
        faults += [f"{folder}: {line}" for line in judge(world)]
    print("\n".join([f"no world: {line}" for line in unmade] + faults))
    print(f"{len(folders)} worlds, {answers} answers, {len(faults)} false")
    sys.exit(bool(faults or not answers))


if __name__ == "__main__":
    main()
