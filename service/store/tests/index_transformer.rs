//! The transformer runs for real where a library and a model are found:
//! `ORT_DYLIB_PATH` and `D3DGEN_MODEL_DIR` as `embedder/model_folder.py` prints them.
#![cfg(feature = "fastembed")]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::path::{Path, PathBuf};
use std::sync::Arc;

use d3dgen_store::Error;
use d3dgen_store::embed::{Embedder, Transformer, TransformerFiles};
use d3dgen_store::index::{Document, Filter, Index, IndexSpec, Mode, Watch};

/// The files that the test runner names, or says that this is skipped.
fn files() -> Option<TransformerFiles> {
    let path = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let files = path("ORT_DYLIB_PATH").zip(path("D3DGEN_MODEL_DIR"));
    if files.is_none() {
        println!("skipped: ORT_DYLIB_PATH and D3DGEN_MODEL_DIR are not both set, see embedder/model_folder.py");
    }
    files.map(|(runtime, model_dir)| TransformerFiles { runtime, model_dir })
}

#[test]
fn equals_pythons_answers_and_searches() {
    let Some(files) = files() else { return };
    let transformer = Transformer::load(&files).unwrap();
    assert_eq!(transformer.dim(), 384);
    let expected = std::fs::read_to_string(files.model_dir.join("expected.json")).unwrap();
    let expected: Vec<serde_json::Value> = serde_json::from_str(&expected).unwrap();
    assert!(expected.len() >= 5);
    let texts: Vec<&str> = expected.iter().map(|e| e["text"].as_str().unwrap()).collect();
    let vectors = transformer.embed(&texts).unwrap();
    for ((text, vector), expected) in texts.iter().zip(&vectors).zip(&expected) {
        let numbers = expected["vector"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap() as f32);
        let cosine: f32 = vector.iter().zip(numbers).map(|(a, b)| a * b).sum();
        println!("cosine {cosine:.6} with Python for {text:?}");
        assert!(cosine > 0.999, "{text:?}: {cosine}");
    }
    // A text has the same vector in any company.
    assert_eq!(transformer.embed(&texts[..1]).unwrap()[0], vectors[0]);
    assert!(transformer.embed(&["", " "]).unwrap().iter().flatten().all(|x| *x == 0.0));

    let names = ["Gurney", "Refrigerator", "Washbasin", "Office Chair"];
    let documents =
        names.map(|name| Document { key: name.to_owned(), embed_text: name.to_owned(), ..Document::default() });
    let index = Index::in_memory(&IndexSpec::default(), Arc::new(transformer), 1, documents, Watch::nobody()).unwrap();
    let best = |text: &str| index.search(text, &Filter::Everything, 1, Mode::Hybrid).unwrap()[0].key.clone();
    assert_eq!(best("sink for washing hands"), "Washbasin");
    assert_eq!(best("fridge"), "Refrigerator");
}

#[test]
fn what_is_missing_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let load = |runtime: &Path, model_dir: &Path| {
        Transformer::load(&TransformerFiles { runtime: runtime.to_owned(), model_dir: model_dir.to_owned() })
            .unwrap_err()
    };
    let nowhere = dir.path().join("libnowhere.so");
    assert!(matches!(load(&nowhere, dir.path()), Error::Io { path, .. } if path == nowhere));
    let no_library = dir.path().join("libonnxruntime.so");
    std::fs::write(&no_library, "no library").unwrap();
    assert!(matches!(load(&no_library, dir.path()), Error::Io { path, .. } if path.ends_with("model.onnx")));
    for name in ["model.onnx", "tokenizer.json", "config.json", "special_tokens_map.json", "tokenizer_config.json"] {
        std::fs::write(dir.path().join(name), "{}").unwrap();
    }
    // Where another test has loaded the library already, it is the model that cannot be used.
    let error = load(&no_library, dir.path());
    assert!(matches!(error, Error::Embedder { .. }), "{error}");
    if let Some(files) = files() {
        let error = load(&files.runtime, dir.path());
        assert!(error.to_string().contains("cannot be used"), "{error}");
    }
}
