"""Reads this data set of indoor worlds: with Python alone, or into pyarrow, webdataset or datasets.

    import load
    for world in load.worlds("FOLDER", split="train"):
        world["key"], world["json"]["prompt"], world["world"]["floorplan"]["rooms"], world["report"]["summary"]

Run as a program it counts the worlds of each split, or writes one as a folder:

    python load.py FOLDER
    python load.py FOLDER --key world-000012 --out world/
"""
import argparse
import gzip
import json
import pathlib
import tarfile


def splits(root):
    """Names of the splits."""
    return sorted(path.stem for path in pathlib.Path(root, "index").glob("*.parquet"))


def shards(root, split="train"):
    """Paths of the shards of a split, in order."""
    return sorted(str(path) for path in pathlib.Path(root, "shards").glob(f"{split}-[0-9]*.tar"))


def _samples(path):
    """The files of each world of a shard, as {"__key__": key, extension: bytes}."""
    sample = {}
    with tarfile.open(path) as tar:
        for member in tar:
            key, _, ext = member.name.partition(".")
            if sample and sample["__key__"] != key:
                yield sample
                sample = {}
            sample["__key__"] = key
            sample[ext] = tar.extractfile(member).read()
    if sample:
        yield sample


def decode(sample):
    """Makes documents of the bytes of a world: `world.json.gz` becomes `world`, a dictionary; other files stay bytes."""
    world = {"key": sample["__key__"]}
    for ext, data in sample.items():
        if ext.startswith("__"):
            continue
        if ext.endswith(".gz"):
            ext, data = ext[:-3], gzip.decompress(data)
        if ext == "json":
            world["json"] = json.loads(data)
        elif ext.endswith(".json"):
            world[ext[:-5]] = json.loads(data)
        else:
            world[ext] = data
    return world


def worlds(root, split="train"):
    """The worlds of a split, one after the other."""
    for path in shards(root, split):
        for sample in _samples(path):
            yield decode(sample)


def index(root, split="train", columns=None):
    """The rows of a split as a pyarrow table; `.to_pandas()` makes a data frame of it."""
    import pyarrow.parquet

    return pyarrow.parquet.read_table(pathlib.Path(root, "index", f"{split}.parquet"), columns=columns)


def find(root, split="train", **wanted):
    """The worlds whose columns have these values: find(root, rooms=6, country="DE")."""
    import pyarrow.parquet

    filters = [(name, "=", value) for name, value in wanted.items()] or None
    path = pathlib.Path(root, "index", f"{split}.parquet")
    rows = pyarrow.parquet.read_table(path, columns=["key", "shard"], filters=filters).to_pylist()
    keys = {}
    for row in rows:
        keys.setdefault(row["shard"], set()).add(row["key"])
    for shard, some in sorted(keys.items()):
        for sample in _samples(pathlib.Path(root, shard)):
            if sample["__key__"] in some:
                yield decode(sample)


def as_webdataset(root, split="train", shuffle=0):
    """A webdataset pipeline over the split, shards dealt to the workers of a loader."""
    import webdataset

    return webdataset.WebDataset(shards(root, split), shardshuffle=shuffle or False).map(decode)


def as_torch(root, split="train"):
    """An iterable data set for torch.utils.data.DataLoader that deals the shards to its workers."""
    import torch.utils.data

    class Worlds(torch.utils.data.IterableDataset):
        def __iter__(self):
            worker = torch.utils.data.get_worker_info()
            first, step = (worker.id, worker.num_workers) if worker else (0, 1)
            for path in shards(root, split)[first::step]:
                yield from map(decode, _samples(path))

    return Worlds()


def as_datasets(root):
    """The index of every split as a datasets.DatasetDict."""
    import datasets

    files = {split: str(pathlib.Path(root, "index", f"{split}.parquet")) for split in splits(root)}
    return datasets.load_dataset("parquet", data_files=files)


def model(root, name):
    """The bytes of a shared model, by its name in the column `models`."""
    for path in sorted(pathlib.Path(root, "shards").glob("models-*.tar")):
        with tarfile.open(path) as tar:
            try:
                return tar.extractfile(name).read()
            except KeyError:
                continue
    raise KeyError(name)


def write_folder(root, key, out):
    """Writes a world with its shared models as the folder that `d3dgen generate` would have made."""
    for split in splits(root):
        for path in shards(root, split):
            for sample in _samples(path):
                if sample["__key__"] == key:
                    about = json.loads(sample["json"])
                    for ext, name in about["paths"].items():
                        data = sample[ext]
                        _write(out, name, gzip.decompress(data) if ext.endswith(".gz") else data)
                    for name, shared in about["models"].items():
                        _write(out, name, model(root, shared))
                    return
    raise KeyError(key)


def _write(out, name, data):
    path = pathlib.Path(out, name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("root")
    arguments.add_argument("--key")
    arguments.add_argument("--out", default="world")
    given = arguments.parse_args()
    if given.key:
        write_folder(given.root, given.key, given.out)
        return
    for split in splits(given.root):
        rooms = [len(w["world"]["floorplan"]["rooms"]) if "world" in w else w["json"]["rooms"] for w in worlds(given.root, split)]
        print(f"{split}: {len(rooms)} worlds, {sum(rooms)} rooms")


if __name__ == "__main__":
    main()
