#!/usr/bin/env python3
"""Measures our homes and those of other generators with the same code: see README.md beside it, and docs/comparison.md for what came out.

    benches/peers/compare.py --program target/release/d3dgen --procthor DIR --markdown out.md --plot out.svg
    benches/peers/compare.py --self-test
"""
import argparse
import dataclasses
import functools
import json
import pathlib
import statistics

import houses
import ours
import procthor

SIZES = (5, 8, 10)
ROWS = (
    ("CPU seconds a world", "cpu_s", "{:.2f}"),
    ("rooms asked for that are there", "rooms", "{:.1f}"),
    ("rooms added to connect them", "circulation", "{:.1f}"),
    ("net area, m2", "net_m2", "{:.0f}"),
    ("doors", "doors", "{:.1f}"),
    ("rooms reached only through a bedroom or bathroom", "behind_private", "{:.1%}"),
    ("objects", "objects", "{:.0f}"),
    ("objects a room", "objects_a_room", "{:.1f}"),
    ("door sides blocked", "door_sides_blocked", "{:.1%}"),
    ("objects that go into another's box", "overlapping", "{:.1%}"),
    ("objects not over the floor", "outside", "{:.1%}"),
    ("free floor in one piece for a robot of 0.2 m", "reachable", "{:.1%}"),
)
PLOTTED = ("behind_private", "door_sides_blocked", "overlapping", "reachable")
COLOURS = ("#2a6f97", "#c8553d", "#7a9e43", "#8d6a9f")
BAR_PX, BAR_GAP_PX, GROUP_GAP_PX, CHART_PX, LABEL_PX = 22, 2, 26, 110, 34


@dataclasses.dataclass
class Column:
    """What one generator's worlds of one size came to."""

    name: str
    asked: int
    count: int
    means: dict


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="the d3dgen to measure; without it ours are not measured")
    parser.add_argument("--procthor", metavar="DIR", help="a checkout of ProcTHOR with its environment in DIR/venv; without it not measured")
    parser.add_argument("--plans", type=int, default=30, metavar="N", help="seeds of each size for homes and plans (default 30)")
    parser.add_argument("--houses", type=int, default=7, metavar="N", help="seeds of each size for ProcTHOR's furnished houses, which take long (default 7)")
    parser.add_argument("--keep", type=pathlib.Path, metavar="DIR", help="keep all worlds that are measured there, and take them from there on the next run")
    parser.add_argument("--markdown", type=pathlib.Path, metavar="FILE", help="write the tables there; else they are printed")
    parser.add_argument("--plot", type=pathlib.Path, metavar="FILE", help="write the plot there, an SVG")
    parser.add_argument("--self-test", action="store_true", help="measure a house made by hand and stop")
    options = parser.parse_args()
    if options.self_test:
        houses.self_test()
        print("the measures of the house made by hand are right")
        return
    columns, missing = measure(options)
    tables = "\n\n".join([table([shown for shown in columns if shown.asked == size], size) for size in SIZES if columns] + missing) + "\n"
    if options.markdown:
        options.markdown.write_text(tables)
    else:
        print(tables, end="")
    if options.plot:
        options.plot.write_text(plot(columns))


def measure(options):
    """Returns the columns of all that was given, and a line for each that was not."""
    columns, missing = [], [f"{name}: not measured, no `{flag}` given." for name, flag, given in (
        (ours.NAME, "--program", options.program), (procthor.NAME, "--procthor", options.procthor),
    ) if not given]
    for size in SIZES:
        for name, stage, count, make in sources(options, size):
            columns.append(column(name, size, kept(options.keep, f"{stage}-{size}.jsonl", count, make)))
    return columns, missing


def sources(options, size):
    """Yields what was given: its name, the file its worlds are kept in, how many are wanted and what makes them."""
    if options.program:
        yield ours.NAME, "ours", options.plans, lambda: map(dataclasses.asdict, ours.make(options.program, size, range(1, options.plans + 1)))
    for stage, count in (("plans", options.plans), ("houses", options.houses)) if options.procthor else ():
        yield f"{procthor.NAME}, {stage}", stage, count, functools.partial(procthor.make, options.procthor, stage, size, count)


def kept(folder, name, count, make):
    """Returns the first worlds of a file, if it has as many; else makes them, and keeps them where a folder is given."""
    path = folder and folder / name
    lines = path.read_text().splitlines() if path and path.is_file() else []
    if len(lines) < count:
        lines = [json.dumps(world) for world in make()]
        if path:
            folder.mkdir(parents=True, exist_ok=True)
            path.write_text("".join(line + "\n" for line in lines))
    return [houses.from_json(json.loads(line)) for line in lines[:count]]


def column(name, asked, worlds):
    found = [houses.measure(world) for world in worlds]
    means = {key: statistics.mean(measures[key] for measures in found) if found[0][key] is not None else None for key in found[0]}
    return Column(name, asked, len(found), means)


def table(columns, size):
    """Returns the table of homes of one size."""
    lines = [f"| {size} rooms, mean of | " + " | ".join(f"{column.name} (n = {column.count})" for column in columns) + " |", "|---|" + "---|" * len(columns)]
    for label, key, form in ROWS:
        lines.append(f"| {label} | " + " | ".join("-" if column.means[key] is None else form.format(column.means[key]) for column in columns) + " |")
    return "\n".join(lines)


def plot(columns):
    """Returns an SVG: for each share a group of bars by size, one bar a generator; what has no objects has no bar there."""
    names = list(dict.fromkeys(column.name for column in columns))
    labels = {key: label for label, key, _ in ROWS}
    group_px = len(names) * (BAR_PX + BAR_GAP_PX) + GROUP_GAP_PX
    row_px = CHART_PX + 2 * LABEL_PX
    wide, high = max(520, 60 + group_px * len(SIZES)), row_px * len(PLOTTED) + 30
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {high}" font-family="sans-serif" font-size="11">', f'<rect width="{wide}" height="{high}" fill="#fff"/>']
    for i, name in enumerate(names):
        parts.append(f'<rect x="{20 + 165 * i}" y="8" width="10" height="10" fill="{COLOURS[i]}"/><text x="{35 + 165 * i}" y="17">{name}</text>')
    for row, key in enumerate(PLOTTED):
        floor = 30 + row * row_px + LABEL_PX + CHART_PX
        parts.append(f'<text x="20" y="{floor - CHART_PX - 14}" font-weight="bold">{labels[key]}</text><path d="M20 {floor}H{wide - 20}" stroke="#888"/>')
        for group, size in enumerate(SIZES):
            left = 40 + group * group_px
            parts.append(f'<text x="{left}" y="{floor + 14}">{size} rooms</text>')
            for shown in (shown for shown in columns if shown.asked == size and shown.means[key] is not None):
                value = shown.means[key]
                at = left + names.index(shown.name) * (BAR_PX + BAR_GAP_PX)
                parts.append(f'<rect x="{at}" y="{floor - value * CHART_PX:.1f}" width="{BAR_PX}" height="{value * CHART_PX:.1f}" fill="{COLOURS[names.index(shown.name)]}"/>')
                parts.append(f'<text x="{at + BAR_PX / 2}" y="{floor - value * CHART_PX - 2:.1f}" text-anchor="middle" font-size="8">{value:.0%}</text>')
    return "\n".join([*parts, "</svg>\n"])


if __name__ == "__main__":
    main()
