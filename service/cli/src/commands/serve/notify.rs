//! What a service manager hears of the process: that it answers, and that it stops (`sd_notify` of systemd).

/// Tells the service manager that started this process, if one did that listens: `READY=1`, `STOPPING=1`.
///
/// Nobody listening is no error, and what cannot be told is written to the log.
#[cfg(target_os = "linux")]
pub fn tell(state: &str) {
    use std::os::linux::net::SocketAddrExt;
    use std::os::unix::net::{SocketAddr, UnixDatagram};

    let Some(place) = std::env::var_os("NOTIFY_SOCKET") else { return };
    let sent = (|| {
        let address = match place.as_encoded_bytes() {
            [b'@', name @ ..] => SocketAddr::from_abstract_name(name)?,
            _ => SocketAddr::from_pathname(&place)?,
        };
        UnixDatagram::unbound()?.send_to_addr(state.as_bytes(), &address)
    })();
    if let Err(reason) = sent {
        tracing::warn!(%reason, state, "the service manager cannot be told");
    }
}

/// There is no such manager on this system.
#[cfg(not(target_os = "linux"))]
pub fn tell(_state: &str) {}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    #[test]
    fn the_service_manager_hears() {
        let dir = tempfile::tempdir().expect("a folder");
        let place = dir.path().join("notify");
        let socket = std::os::unix::net::UnixDatagram::bind(&place).expect("a socket");
        // in a process of its own: variables are of the whole process
        let told = std::process::Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "commands::serve::notify::tests::tells", "--ignored"])
            .env("NOTIFY_SOCKET", &place)
            .status();
        assert!(told.expect("it runs").success());
        let mut text = [0; 32];
        socket.set_read_timeout(Some(std::time::Duration::from_secs(10))).expect("a timeout");
        let length = socket.recv(&mut text).expect("it was told");
        assert_eq!(&text[..length], b"READY=1");
    }

    #[test]
    #[ignore = "a part of another test"]
    fn tells() {
        super::tell("READY=1");
    }
}
