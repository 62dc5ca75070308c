//! What `deploy/` has, as far as neither a container engine nor systemd is needed to judge it.

use std::os::unix::net::UnixDatagram;
use std::process::{Command, Stdio};
use std::time::Duration;

use d3dgen_tests::{program, workspace};

fn text(path: &str) -> String {
    std::fs::read_to_string(workspace().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// Returns the values of the lines that begin with a word.
fn lines<'a>(text: &'a str, word: &str) -> Vec<&'a str> {
    text.lines().filter_map(|l| l.strip_prefix(word)).map(str::trim).collect()
}

/// Returns the words of a list like `["a", "b"]`.
fn list(value: &str) -> Vec<String> {
    serde_json::from_str(value).expect("a list of words")
}

#[test]
fn the_unit_starts_a_server_that_says_when_it_is_ready() {
    let unit = text("deploy/d3dgen.service");
    let home = tempfile::tempdir().expect("a folder");
    let path = |name: &str| home.path().join(name).display().to_string();
    std::fs::write(path("server.toml"), "listen = \"127.0.0.1:0\"\n").expect("written");
    // what it runs, with its folders in another place
    let run = lines(&unit, "ExecStart=").concat();
    let run = run.replace("/etc/d3dgen/server.toml", &path("server.toml")).replace("/var/lib/d3dgen", &path("data"));
    let (named, words) = run.split_once(' ').expect("a program with arguments");
    assert_eq!(named, "/usr/local/bin/d3dgen");
    assert_eq!(lines(&unit, "Type="), ["notify"]);
    let place = path("notify");
    let told = UnixDatagram::bind(&place).expect("a place to be told");
    told.set_read_timeout(Some(Duration::from_secs(100))).expect("a limit");
    let mut command = Command::new(program());
    command.args(words.split(' ')).env("NOTIFY_SOCKET", &place).env("D3DGEN_STORE", "").stdout(Stdio::null());
    let mut server = command.stderr(Stdio::null()).spawn().expect("it starts");
    let mut said = [0; 256];
    let length = told.recv(&mut said);
    let _ = server.kill();
    server.wait().expect("it ended");
    let said = String::from_utf8_lossy(&said[..length.expect("it says when it is ready")]).into_owned();
    assert!(said.lines().any(|l| l == "READY=1"), "{said:?}");
    assert_eq!(lines(&unit, "UMask="), ["0077"]);
    assert!(unit.contains("LoadCredential=key.pem:") && unit.contains("%d/key.pem"), "the key is a credential");
}

#[test]
fn the_image_is_built_and_started_as_the_program_is() {
    let image = text("deploy/Containerfile");
    let toolchain = lines(&image, "ENV RUSTUP_TOOLCHAIN=");
    let [toolchain] = toolchain.as_slice() else { panic!("one toolchain: {toolchain:?}") };
    assert!(image.contains(&format!("FROM docker.io/library/rust:{toolchain}-")), "the image of that toolchain");
    let manifest: toml::Table = text("Cargo.toml").parse().expect("TOML");
    let least = manifest["workspace"]["package"]["rust-version"].as_str().expect("a version");
    assert!(toolchain.starts_with(least), "{toolchain} is not the release that the crates ask for, {least}");
    assert!(image.contains("ca-certificates"), "research fetches pages");
    let cooked = image.find("cargo chef cook").expect("a layer of what others wrote");
    assert!(cooked < image.rfind("COPY . .").expect("the sources"), "before the sources");

    // the program knows the flags that the image starts it with, and the command of its health
    let start = list(lines(&image, "ENTRYPOINT").first().expect("what it starts"));
    let then = list(lines(&image, "CMD").first().expect("with which settings"));
    let (name, words) = start.split_first().expect("a program");
    assert_eq!(name, "d3dgen");
    let check = Command::new(program()).args([words, &then].concat()).arg("--help").output().expect("it runs");
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stderr));
    let health = image.lines().find_map(|l| l.trim().strip_prefix("CMD [\"d3dgen\", \"serve\", \"health\"")).is_some();
    assert!(health, "HEALTHCHECK asks the server");
    let nobody = Command::new(program()).args(["serve", "health", "--server", "http://127.0.0.1:9"]).output();
    assert!(!nobody.expect("it runs").status.success(), "where no server is, none is well");
}

#[test]
fn nothing_that_an_image_is_built_of_is_left_out_of_it() {
    let left_out = text(".dockerignore");
    let folders: Vec<&str> = left_out.lines().filter(|l| !l.starts_with('#') && !l.contains('*')).collect();
    assert!(["target", ".venv", ".git"].iter().all(|f| folders.contains(f)), "{folders:?}");
    let mut included = Vec::new();
    for part in ["service", "plugins"] {
        for (path, content) in d3dgen_tests::files(&workspace().join(part)) {
            if path.ends_with(".rs") && path.contains("src/") {
                let text = String::from_utf8(content).expect("text");
                included.extend(text.lines().filter(|l| l.contains("include_")).map(str::to_owned));
            }
        }
    }
    assert!(included.len() > 20, "{included:?}");
    for folder in folders {
        let wanted = included.iter().find(|l| l.contains(&format!("../{folder}/")));
        assert_eq!(wanted, None, "`{folder}` is left out, and built in");
    }
}
