//! A transformer as embedder, run by ONNX Runtime through `fastembed` from files that the user has.
//!
//! Nothing is downloaded, and neither environment nor working folder is looked at: the paths are given. It understands
//! sentences better than the static table and costs about a thousand times as much.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use fastembed::{InitOptionsUserDefined, Pooling, TextEmbedding, TokenizerFiles, UserDefinedEmbeddingModel};
use twox_hash::XxHash3_64;

use super::{Embedder, normalize};
use crate::error::{Error, Result};

/// Tokens of a text that are read; the models in question were trained on fewer.
const TOKENS_MOST: usize = 256;

/// Where the files of a transformer are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TransformerFiles {
    /// The library of ONNX Runtime: `libonnxruntime.so`, `.dylib` or `onnxruntime.dll`, version 1.24 or later.
    pub runtime: PathBuf,
    /// A folder with `model.onnx`, `tokenizer.json`, `config.json`, `special_tokens_map.json` and
    /// `tokenizer_config.json` of a model whose sentence vector is the mean of its last layer.
    pub model_dir: PathBuf,
}

/// A sentence transformer.
pub struct Transformer {
    model: Mutex<TextEmbedding>,
    id: String,
    dim: usize,
}

impl std::fmt::Debug for Transformer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Transformer {}", self.id)
    }
}

impl Transformer {
    /// Loads the library, once a process, and the model. The first library that was loaded serves all later models.
    ///
    /// # Errors
    /// [`Error::Io`] when a file is missing; [`Error::Embedder`] when the library is none or too old, or the model or
    /// its tokenizer cannot be used.
    pub fn load(files: &TransformerFiles) -> Result<Self> {
        // The library is looked for by a panicking function later, unless it is loaded by then.
        std::fs::File::open(&files.runtime).map_err(Error::io(&files.runtime))?;
        let runtime = std::path::absolute(&files.runtime).map_err(Error::io(&files.runtime))?;
        let read = |name: &str| {
            let path = files.model_dir.join(name);
            std::fs::read(&path).map_err(Error::io(&path))
        };
        let (onnx, tokenizer) = (read("model.onnx")?, read("tokenizer.json")?);
        let digest = XxHash3_64::oneshot(&onnx) ^ XxHash3_64::oneshot(&tokenizer).rotate_left(1);
        let name = model_name(&files.model_dir);
        let failed = |what: String| Error::Embedder { id: name.clone(), what };
        let load = ort::init_from(&runtime);
        drop(load.map_err(|e| failed(format!("{e}: name the library of ONNX Runtime 1.24 or later")))?);
        let tokenizer_files = TokenizerFiles {
            tokenizer_file: tokenizer,
            config_file: read("config.json")?,
            special_tokens_map_file: read("special_tokens_map.json")?,
            tokenizer_config_file: read("tokenizer_config.json")?,
        };
        let model = UserDefinedEmbeddingModel::new(onnx, tokenizer_files).with_pooling(Pooling::Mean);
        let options = InitOptionsUserDefined::new().with_max_length(TOKENS_MOST);
        let mut model = TextEmbedding::try_new_from_user_defined(model, options)
            .map_err(|e| failed(format!("the files in {} cannot be used: {e}", files.model_dir.display())))?;
        let probe = model.embed(["probe"], None).map_err(|e| failed(e.to_string()))?;
        let dim = probe.first().map_or(0, Vec::len);
        if dim == 0 {
            return Err(failed("it answers with empty vectors: use a model of sentences".to_owned()));
        }
        Ok(Self { model: Mutex::new(model), id: format!("{name}+{digest:016x}+{dim}"), dim })
    }
}

impl Embedder for Transformer {
    fn id(&self) -> &str {
        &self.id
    }

    fn dim(&self) -> usize {
        self.dim
    }

    fn embed(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>> {
        let mut model = self.model.lock().unwrap_or_else(|broken| broken.into_inner());
        let failed = |what: String| Error::Embedder { id: self.id.clone(), what };
        // One by one: a model quantized at run time gives a text another vector in other company, and an index must
        // not depend on how its documents were batched.
        let one = |text: &&str| {
            let mut vector = match text.trim() {
                "" => vec![0.0; self.dim],
                text => model.embed([text], None).map_err(|e| failed(e.to_string()))?.pop().unwrap_or_default(),
            };
            if vector.len() != self.dim {
                return Err(failed(format!("a vector of {} numbers, expected {}", vector.len(), self.dim)));
            }
            normalize(&mut vector);
            Ok(vector)
        };
        texts.iter().map(one).collect()
    }
}

fn model_name(model_dir: &Path) -> String {
    model_dir.file_name().map_or_else(|| "transformer".to_owned(), |name| name.to_string_lossy().into_owned())
}
