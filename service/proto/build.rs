//! Generates messages, clients and servers from `proto/`, without protoc; keeps the descriptors for reflection.

use std::error::Error;
use std::path::PathBuf;

use prost::Message;

fn main() -> Result<(), Box<dyn Error>> {
    // asked when it runs: a script that was built elsewhere would read the contract of there
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?).join("../../proto");
    let mut files: Vec<PathBuf> = std::fs::read_dir(root.join("d3dgen/v1"))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<_, std::io::Error>>()?;
    files.retain(|file| file.extension().is_some_and(|e| e == "proto"));
    files.sort();
    println!("cargo::rerun-if-changed={}", root.join("d3dgen").display());
    let descriptors = protox::compile(&files, [&root])?;
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    std::fs::write(out.join("descriptors.bin"), descriptors.encode_to_vec())?;
    let mut messages = tonic_prost_build::Config::new();
    messages.enable_type_names().btree_map(["."]);
    let contract = tonic_prost_build::configure().codec_path("crate::codec::Bounded");
    contract.compile_fds_with_config(descriptors, messages)?;
    Ok(())
}
