#!/usr/bin/env python3
"""Turns researched building-rule facts (one JSON object a line) into the knowledge.json of the shipped domains.

Usage: import_standards.py STANDARDS_DIR [DOMAINS_DIR]

STANDARDS_DIR holds residential.jsonl, office.jsonl, hospital.jsonl and robot.jsonl. Every line of the first three becomes
a constraint of its domain; every robot line joins the domains that it names. Domains made from data alone (school,
warehouse, general) get the lines of the office file that speak of any building (doors, corridors, exits, toilets,
accessible routes) from regulations and standards, and all robot lines of the office. Same input, same bytes.
"""
import json
import re
import sys
from pathlib import Path

DATE = "2026-11-21"
BUILT_IN = ["residential", "office", "hospital"]
DATA_ONLY = ["school", "warehouse", "general"]
# What the data-only domains take over: rules of these topics about these spaces hold in any building with public access.
GENERAL_TOPICS = {"fire_safety_evacuation", "convenience_accessibility"}
GENERAL_SPACES = {
    "accessible_route", "accessible_toilet", "corridor", "door", "doorway", "egress_door", "entrance", "escape_route",
    "exit", "exit_access", "means_of_egress", "ramp", "stair", "toilet", "turning_space", "workplace", "any", "building",
    "floor", "route", "storey", "washroom", "passage", "aisle",
}
NOTES = [
    "Facts and figures only: what a rule requires and who requires it. Lengths in m, areas in m^2; original_value keeps the printed figure.",
    "Cite the source (the standard itself); seen_at says where a figure was checked and is not a citation.",
    "Guides and practice rules are recommendations, not law.",
]


def slug(text, limit=48):
    text = re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")
    return text[:limit].rstrip("_")


def read(path):
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]


def reference_of(line, domain):
    source = line["source"]
    return f"{domain}_{slug(line['jurisdiction'], 8)}_{slug(source['title'])}_{slug(str(source['edition_or_year']), 12)}"


def constraint_of(line, constraint_id, source_id):
    conditions = line.get("conditions") or []
    out = {
        "constraint_id": constraint_id,
        "name": line["name"],
        "topic": line["topic"],
        "constraint_type": line["constraint_type"],
        "value": line["value"],
        "unit": line["unit"],
        "measurement_basis": line["measurement_basis"],
        "space_type": line["space_type"],
        "conditions": conditions if isinstance(conditions, list) else [conditions],
        "confidence": line["confidence"],
        "verified": line["verified"],
    }
    if line.get("original_value"):
        out["original_value"] = str(line["original_value"])
    if line.get("note"):
        out["note"] = line["note"]
    out["source_ids"] = [source_id]
    if line.get("seen_at"):
        out["seen_at"] = line["seen_at"]
    return out


def build(domain, lines):
    references, used = {}, {}
    for line in lines:
        ref_id = reference_of(line, domain)
        source = line["source"]
        reference = references.setdefault(ref_id, {
            "ref_id": ref_id,
            "building_type": domain,
            "jurisdiction": line["jurisdiction"],
            "retrieved_at": DATE,
            "sources": [{
                "source_id": "s1",
                "title": source["title"],
                "publisher": source["publisher"],
                "edition_or_year": str(source["edition_or_year"]),
                **({"url": source["url"]} if source.get("url") else {}),
                "type": source["type"],
            }],
            "constraints": [],
        })
        base = f"{domain}_{slug(line['jurisdiction'], 8)}_{slug(line['name'], 40)}_{slug(line['space_type'], 24)}"
        used[base] = used.get(base, 0) + 1
        constraint_id = base if used[base] == 1 else f"{base}_{used[base]}"
        reference["constraints"].append(constraint_of(line, constraint_id, "s1"))
    return {
        "metadata": {
            "version": 1,
            "domain": domain,
            "generated_by": "domains/tools/import_standards.py from researched facts, one constraint a line",
            "date": DATE,
            "notes": NOTES,
        },
        "references": [references[key] for key in sorted(references)],
    }


def general(line):
    return (
        line["topic"] in GENERAL_TOPICS
        and line["source"]["type"] in {"regulation", "standard", "law", "code"}
        and any(word in GENERAL_SPACES for word in [line["space_type"]] + line["space_type"].split("_"))
    )


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    standards = Path(sys.argv[1])
    domains = Path(sys.argv[2]) if len(sys.argv) == 3 else Path(__file__).resolve().parent.parent
    lines = {name: read(standards / f"{name}.jsonl") for name in BUILT_IN + ["robot"]}
    for domain in BUILT_IN + DATA_ONLY:
        like = domain if domain in BUILT_IN else "office"
        own = lines[domain] if domain in BUILT_IN else [line for line in lines["office"] if general(line)]
        robots = [line for line in lines["robot"] if like in line["applies_to_domains"]]
        folder = domains / domain
        folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps(build(domain, own + robots), ensure_ascii=False, indent=1) + "\n"
        (folder / "knowledge.json").write_text(text, encoding="utf-8")
        print(f"{domain}: {len(own)} + {len(robots)} robot constraints, {len(text) // 1024} KiB")


if __name__ == "__main__":
    main()
