"""Writes what is in the program: an SPDX 2.3 bill of materials, and the licenses of all that it is made of.

    python3 deploy/sbom.py --out DIR [--features LIST]

Reads `cargo metadata` for the machine it runs on: the packages that the command is linked of, with those that build them left out.
The date is that of the commit ($SOURCE_DATE_EPOCH before it), so that one commit gives the same bytes.
"""
import argparse
import datetime
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess

WORKSPACE = pathlib.Path(__file__).resolve().parents[1]
COMMAND = "d3dgen-cli"
TEXTS = re.compile(r"^(licen[cs]e|copying|notice|unlicense|copyright)", re.I)


def run(*command):
    return subprocess.run(command, cwd=WORKSPACE, capture_output=True, text=True, check=True).stdout


def linked(features):
    """Returns the packages that the command is linked of, by id, and the names that each depends on."""
    machine = next(line.split()[1] for line in run("rustc", "-vV").splitlines() if line.startswith("host:"))
    chosen = ["--features", ",".join(f"{COMMAND}/{f}" for f in features.split(","))] if features else []
    metadata = json.loads(run("cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", machine, *chosen))
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    found, waiting = {}, [next(i for i, p in packages.items() if p["name"] == COMMAND)]
    while waiting:
        at = waiting.pop()
        if at in found:
            continue
        used = nodes[at]["deps"]
        found[at] = sorted(d["pkg"] for d in used if any(kind["kind"] is None for kind in d["dep_kinds"]))
        waiting += found[at]
    return {i: packages[i] for i in sorted(found, key=lambda i: (packages[i]["name"], packages[i]["version"]))}, found


def spdx_id(package):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", f"{package['name']}-{package['version']}")


def expression(package):
    """Returns the license as SPDX has it; the slash of old manifests is an OR."""
    return (package["license"] or "NOASSERTION").replace(" / ", " OR ").replace("/", " OR ")


def described(package, checksums):
    """Returns the entry of a package."""
    from_registry = (package["source"] or "").startswith("registry+")
    place = f"https://crates.io/crates/{package['name']}/{package['version']}" if from_registry else "NOASSERTION"
    entry = {
        "SPDXID": spdx_id(package),
        "name": package["name"],
        "versionInfo": package["version"],
        "downloadLocation": place,
        "filesAnalyzed": False,
        "licenseConcluded": "NOASSERTION",
        "licenseDeclared": expression(package),
        "copyrightText": "NOASSERTION",
    }
    if from_registry:
        entry["externalRefs"] = [
            {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": f"pkg:cargo/{package['name']}@{package['version']}"}
        ]
        if digest := checksums.get((package["name"], package["version"])):
            entry["checksums"] = [{"algorithm": "SHA256", "checksumValue": digest}]
    return entry


def locked_checksums():
    """Returns the checksums of Cargo.lock, by name and version."""
    block = re.compile(r'\[\[package\]\]\nname = "(.+)"\nversion = "(.+)"\nsource = ".+"\nchecksum = "(.+)"')
    return {(name, version): digest for name, version, digest in block.findall((WORKSPACE / "Cargo.lock").read_text())}


def commit_date():
    seconds = os.environ.get("SOURCE_DATE_EPOCH") or run("git", "log", "-1", "--format=%ct").strip()
    return datetime.datetime.fromtimestamp(int(seconds), datetime.UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def bill(packages, uses):
    """Returns the whole document."""
    root = next(p for p in packages.values() if p["name"] == COMMAND)
    checksums = locked_checksums()
    relations = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": spdx_id(root)}]
    relations += [
        {"spdxElementId": spdx_id(packages[i]), "relationshipType": "DEPENDS_ON", "relatedSpdxElement": spdx_id(packages[j])}
        for i in packages
        for j in uses[i]
    ]
    entries = [described(package, checksums) for package in packages.values()]
    digest = hashlib.sha256(json.dumps([entries, relations]).encode()).hexdigest()
    return {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"d3dgen-{root['version']}",
        "documentNamespace": f"https://d3dgen.org/spdx/d3dgen-{root['version']}-{digest[:16]}",
        "creationInfo": {"created": commit_date(), "creators": ["Tool: deploy/sbom.py"]},
        "packages": entries,
        "relationships": relations,
    }


def copy_licenses(packages, folder):
    """Copies the license texts of all packages of others; returns the names of those that ship none."""
    without = []
    for package in packages.values():
        if not package["source"]:
            continue
        home = pathlib.Path(package["manifest_path"]).parent
        texts = [path for path in sorted(home.iterdir()) if path.is_file() and TEXTS.match(path.name)]
        into = folder / f"{package['name']}-{package['version']}"
        into.mkdir(parents=True, exist_ok=True)
        for path in texts:
            shutil.copyfile(path, into / path.name)
        if not texts:
            without.append(package["name"])
            (into / "LICENSE.txt").write_text(f"{expression(package)}; the package ships no text of it. {package['repository'] or ''}\n")
    return without


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--features", default="")
    given = parser.parse_args()
    packages, uses = linked(given.features)
    given.out.mkdir(parents=True, exist_ok=True)
    (given.out / "sbom.spdx.json").write_text(json.dumps(bill(packages, uses), indent=1) + "\n")
    shutil.rmtree(given.out / "licenses", ignore_errors=True)
    without = copy_licenses(packages, given.out / "licenses")
    shutil.copyfile(WORKSPACE / "LICENSE", given.out / "LICENSE")
    print(f"{len(packages)} packages, {len(without)} of them ship no text of their license")


if __name__ == "__main__":
    main()
