//! Has the server built anew when the page is: the files of `web/dist` lie in the program.

fn main() {
    println!("cargo:rerun-if-changed=../../web/dist");
}
